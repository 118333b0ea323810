// Entered from pcss/tiles.comp, soft_shadow_map/tiles.comp and occlusion_textures/tiles.comp.
//
// Sorts tiles of pixels: it writes 1 to the pixels of lit tiles and lists the others. One invocation handles one tile.
//
// The including shader declares `visibility` and
//     vec2 place_of(vec3 position, float w);
//     float nearest_w();           no occluder is nearer than 1/nearest_w
// bool may_be_shadowed(Tile tile);  whether any occluder may shadow any of its receivers

#ifndef VISIBILITY_CLASSIFY_GLSL
#define VISIBILITY_CLASSIFY_GLSL

#include "common/lists.glsl"

// The tile of an invocation; rows of workgroups alternate (`alternating`).
ivec2 tile_of_invocation()
{
    uint row = alternating(gl_WorkGroupID.y, gl_NumWorkGroups.y);
    return ivec2(gl_GlobalInvocationID.x, row * gl_WorkGroupSize.y + gl_LocalInvocationID.y);
}

void classify_tile(ivec2 tile)
{
    ivec2 first = tile * TILE;
    if (any(greaterThanEqual(first, gbuffer.extent))) {
        return;
    }
    Tile bounds = empty_tile();
    bool blocks = false; // whether some of its pixels' own surfaces may hide light from them
    uvec2 served = uvec2(0u); // a bit for each pixel that the view serves
    for (int i = 0; i < TILE * TILE; ++i) {
        Receiver r = receiver_without_normal(first + ivec2(i % TILE, i / TILE));
        if (!is_served(r.position)) {
            continue;
        }
        served[i / 32] |= 1u << (i % 32);
        if (r.receives && is_before_light(r.position)) {
            blocks = blocks || r.blocks;
            float w = w_of(r.position);
            // A receiver that is nearer to the light than every occluder is shadowed by none.
            if (w < nearest_w()) {
                bounds = with_receiver(bounds, place_of(r.position, w), w);
            }
        }
    }
    bool shadowable = !is_empty_tile(bounds) && may_be_shadowed(rounded_tile(bounds));
    if (shadowable || blocks) {
        uint at = atomicAdd(count, 1u);
        tiles[at] = tile_word(tile, shadowable);
        if (at % TILES_A_GROUP == 0u) {
            uvec2 reach = groups_with(at);
            atomicMax(groups[0], reach.x);
            atomicMax(groups[1], reach.y);
        }
        return;
    }
    for (int i = 0; i < TILE * TILE; ++i) {
        ivec2 p = first + ivec2(i % TILE, i / TILE);
        if ((served[i / 32] & 1u << (i % 32)) != 0u && all(lessThan(p, gbuffer.extent))) {
            imageStore(visibility, p, vec4(1.0));
        }
    }
}

#endif
