// Small functions of numbers. Twin: src/numbers.rs.
#ifndef ANTUMBRA_COMMON_NUMBERS
#define ANTUMBRA_COMMON_NUMBERS

// x within [0, 1].
float clamp_unit(float x) {
    return min(max(x, 0.0), 1.0);
}

// The length that [a, b] shares with [0, 1]; negative where b < a. (Atty 2006 section 4.2)
float interval_overlap_unit(float a, float b) {
    return clamp_unit(b) - clamp_unit(a);
}

#endif
