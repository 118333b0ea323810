// The channels of a sample's two segments in one float.

#ifndef LINEAR_LIGHT_CHANNELS_GLSL
#define LINEAR_LIGHT_CHANNELS_GLSL

// Steps of a channel: two of them are a whole number below 2^24, which a float holds.
const float STEPS = 4095.0;

// Both from 0 to 1; they come back within half a step.
float packed(vec2 channels)
{
    vec2 whole = floor(channels * STEPS + 0.5);
    return whole.x * (STEPS + 1.0) + whole.y;
}

vec2 unpacked(float both)
{
    float first = floor(both / (STEPS + 1.0));
    return vec2(first, both - first * (STEPS + 1.0)) / STEPS;
}

#endif
