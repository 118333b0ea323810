// The channels of a sample's two segments in one float.

#ifndef LINEAR_LIGHT_CHANNELS_GLSL
#define LINEAR_LIGHT_CHANNELS_GLSL

// Of what is seen of a segment. Two channels are a whole number below 2^24, which a float holds.
const float STEPS = 2047.0;

// Where no skin was drawn.
const float CLEAR = 4095.0;

// Each from 0 to 1, 1 where no skin was drawn; they come back within half a step.
float packed(vec2 drawn)
{
    vec2 whole = mix(floor(drawn * STEPS + 0.5), vec2(CLEAR), equal(drawn, vec2(1.0)));
    return whole.x * (CLEAR + 1.0) + whole.y;
}

// What a skin says of either segment, 0 where there is none, and in z and w 1 where there is none.
vec4 unpacked(float both)
{
    float first = floor(both / (CLEAR + 1.0));
    vec2 whole = vec2(first, both - first * (CLEAR + 1.0));
    vec2 none = vec2(equal(whole, vec2(CLEAR)));
    return vec4(whole / STEPS * (1.0 - none), none);
}

#endif
