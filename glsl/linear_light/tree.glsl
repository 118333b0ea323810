// Where a line's samples are: at its ends, and then in the middle of what lies between two of them, of that again, and
// so on. Node 0 is the first end, node 1 the last; round r, from 1 on, has the 2^(r-1) nodes at the odd multiples of
// 2^-r. A node is open where its map is drawn, and taken where it is a sample.

#ifndef LINEAR_LIGHT_TREE_GLSL
#define LINEAR_LIGHT_TREE_GLSL

// Four rounds: the fewest that hold 16 samples.
const int NODES = 17;

struct Node {
    uint open;
    uint taken;
    uint shadowed; // texels whose receiver its map or a neighbour's has in shadow
    uint unseen;   // those that its map alone sees
};

// The first node of a round.
int first_node(int round)
{
    return (1 << (round - 1)) + 1;
}

// The node at a multiple of 2^-round.
int node_at(int multiple, int round)
{
    if (multiple == 0) {
        return 0;
    }
    while ((multiple & 1) == 0 && round > 0) {
        multiple >>= 1;
        round -= 1;
    }
    return round == 0 ? 1 : first_node(round) + (multiple >> 1);
}

// How far along the line a node is, 0 to 1.
float along_of(int node)
{
    if (node < 2) {
        return float(node);
    }
    int round = findMSB(node - 1) + 1;
    return float(2 * (node - first_node(round)) + 1) / float(1 << round);
}

// What leaving a node out costs, as a share of the light: of the part between its neighbours, the receivers that only
// it sees miss a half, as far as one knows.
float cost_of(Node node, int round)
{
    float part = 2.0 / float(1 << round);
    return 0.5 * part * float(node.unseen) / float(max(node.shadowed, 1u));
}

#endif
