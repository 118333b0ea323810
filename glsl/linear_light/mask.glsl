// Entered from mask.comp and place.comp.
//
// Which parts of a line a receiver sees, as one bit for every 32nd of the line; the lowest bit is at its first end.
//
// A sample represents a run of bits: where it sees the receiver, its skins show how far the visible part reaches to
// the first occluder on either side. Visible parts beyond that are lost, unless another sample lies in them.

#ifndef LINEAR_LIGHT_MASK_GLSL
#define LINEAR_LIGHT_MASK_GLSL

// The grid of receivers in the map of the line's middle. It is finer along rows of texels, where visibility changes
// most.
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

// The bits that a sample at bit `at` represents: the run of ones around it, none where that bit is 0.
uint run_at(uint mask, int at)
{
    if ((mask >> at & 1u) == 0u) {
        return 0u;
    }
    // The distance to the first 0 on either side; -1 where all bits up to the end are 1.
    int above = findLSB(int(~(mask >> at)));
    int below = findLSB(int(~(bitfieldReverse(mask) >> (31 - at))));
    return bits(below < 0 ? 0 : at - below + 1, above < 0 ? 31 : at + above - 1);
}

#endif
