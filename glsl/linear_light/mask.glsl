// Entered from mask.comp and place.comp.
//
// What a receiver sees of a line, a bit for every 32nd of it, the first end's the lowest.
//
// Samples see runs of it: a sample that the receiver is not hidden from tells, by its skins, how far the line goes on
// until the first occluder on either side. What lies beyond that is lost, unless another sample sees it.

#ifndef LINEAR_LIGHT_MASK_GLSL
#define LINEAR_LIGHT_MASK_GLSL

// Receivers along the rows of a line's middle map, where what is seen of the line changes most, and across.
const ivec2 RECEIVERS = ivec2(128, 32);

const uint ALL = 0xffffffffu;

// Bits from `low` to `high`, both included and both of 0 to 31; none where they are the wrong way round.
uint bits(int low, int high)
{
    return low > high ? 0u : ALL >> (31 - high) & ALL << low;
}

// The bits whose middles lie between two places, from 0 to 1 along the line; any numbers, in either order.
uint between(float a, float b)
{
    float low = clamp(32.0 * min(a, b) - 0.5, -1.0, 32.0);
    float high = clamp(32.0 * max(a, b) - 0.5, -1.0, 32.0);
    return bits(max(int(ceil(low)), 0), min(int(floor(high)), 31));
}

// The bits that a sample at `at` tells of: the run of ones around it.
uint run_at(uint mask, int at)
{
    if ((mask >> at & 1u) == 0u) {
        return 0u;
    }
    // How many more there are on either side; -1 is up to the end.
    int above = findLSB(int(~(mask >> at)));
    int below = findLSB(int(~(bitfieldReverse(mask) >> (31 - at))));
    return bits(below < 0 ? 0 : at - below + 1, above < 0 ? 31 : at + above - 1);
}

#endif
