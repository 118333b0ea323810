// Entered from hierarchy/boxes.comp, hierarchy/pyramid.comp and hierarchy/nodes.comp.
//
// Boxes of runs of leaves: level 0 has a box a leaf, each level above has one for eight of the level below, and the levels
// lie one behind the other. Any run of leaves is a few of these boxes. So the boxes of the tree's nodes need no order in
// which they are made, whatever the tree's shape.

#ifndef HIERARCHY_PYRAMID_GLSL
#define HIERARCHY_PYRAMID_GLSL

#include "hierarchy/topology.glsl"

// Boxes that one of the next level holds, and the most levels (src/stages/hierarchy/mod.rs).
const uint WIDE = 8u;
const uint LEVELS = 9u;

// The box of nothing.
const vec3 NO_LOW = vec3(3.0e38);
const vec3 NO_HIGH = vec3(-3.0e38);

#endif
