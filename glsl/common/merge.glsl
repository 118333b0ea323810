// The occlusion by both sides of an occluder, from that by either.

#ifndef COMMON_MERGE_GLSL
#define COMMON_MERGE_GLSL

// Where either side hides all of the light it is umbra: a depth step inside a silhouette leaves a gap in
// the sum of one side alone. From this occlusion on the larger takes over from the mean. (Mean error of
// the bunny's image without, from 0.97, from 0.9: 2.9, 2.8, 2.6 %; Suzanne's 1.5, 1.4, 1.4 %.)
const float ALMOST_ALL = 0.9;

// The gaps of one side are overlaps of the other, and cancel in the mean.
vec4 merged_sides(vec4 front, vec4 back)
{
    vec4 larger = max(front, back);
    vec4 umbra = clamp((larger - ALMOST_ALL) / (1.0 - ALMOST_ALL), 0.0, 1.0);
    return mix(0.5 * (front + back), larger, umbra);
}

#endif
