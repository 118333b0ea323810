// Where the samples of a line are, in their order, 0 at its first end and 1 at its last.

#ifndef LINEAR_LIGHT_SAMPLES_GLSL
#define LINEAR_LIGHT_SAMPLES_GLSL

const int MOST_SAMPLES = 16;

struct Samples {
    int count;
    float at[MOST_SAMPLES];
};

#endif
