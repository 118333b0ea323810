#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/tree.glsl"

// Which of a round's open nodes are samples: those that cost most to leave out, until what is left out costs no more
// than the error asked for, or there are as many samples as may be. Beside a new sample two nodes are open.

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std430) buffer Tree {
    float left; // what has been left out costs
    Node nodes[NODES];
};

layout(push_constant) uniform Push {
    float error; // asked for
    int most;    // samples
    int round;
    int rounds;
} push;

void main()
{
    int first = first_node(push.round);
    int count = 0;
    for (int i = 0; i < NODES; ++i) {
        count += int(nodes[i].taken);
    }
    float total = left;
    for (int i = 0; i < first - 1; ++i) {
        total += nodes[first + i].open != 0u ? cost_of(nodes[first + i], push.round) : 0.0;
    }
    while (count < push.most && total > push.error) {
        int best = -1;
        float most = 0.0;
        for (int i = 0; i < first - 1; ++i) {
            Node node = nodes[first + i];
            float cost = cost_of(node, push.round);
            if (node.open != 0u && node.taken == 0u && cost > most) {
                best = i;
                most = cost;
            }
        }
        if (best < 0) {
            break;
        }
        nodes[first + best].taken = 1u;
        total -= most;
        count += 1;
        if (push.round < push.rounds) {
            int beside = first_node(push.round + 1) + 2 * best;
            nodes[beside].open = 1u;
            nodes[beside + 1].open = 1u;
        }
    }
    left = max(total, 0.0);
}
