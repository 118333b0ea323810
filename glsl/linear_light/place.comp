// Entry of the pass linear_light.place (src/techniques/linear_light/samples.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/mask.glsl"
#include "linear_light/line.glsl"

// Places a line's samples (the paper's open problem, section 5): two at its ends, and then one after the other where
// the most light is lost, until the lost share is within the allowed error or the samples are used up.

layout(local_size_x = 128) in;

layout(set = 0, binding = 0, std430) readonly buffer Masks { uint masks[]; };
layout(set = 0, binding = 1, std430) buffer Placed { Samples samples; };

layout(push_constant) uniform Push {
    float error; // the allowed loss: a share of the line, in the mean over receivers that do not see all of it
    int most;    // the most samples
    int even;    // 1: `most` samples, evenly spaced: the middle's map is no guide
} push;

const int EACH = RECEIVERS.x * RECEIVERS.y / 128;

shared int begins[33];  // plus a lost run's length at its first bit, minus it behind its last
shared int shadowed;    // the number of receivers that do not see the whole line
shared int lost;        // the number of visible bits that no sample represents
shared uint placed;      // where samples are
shared int done;

uint seen_from(uint mask, uint places)
{
    uint seen = 0u;
    for (uint left = places; left != 0u; left &= left - 1u) {
        seen |= run_at(mask, findLSB(int(left)));
    }
    return seen;
}

void main()
{
    int me = int(gl_LocalInvocationID.x);
    if (push.even != 0) {
        if (me < push.most) {
            samples.at[me] = float(me) / float(push.most - 1);
            samples.count = push.most;
        }
        return;
    }
    if (me == 0) {
        placed = 0x80000001u;
        done = 0;
    }
    for (int count = 2;; ++count) {
        if (me < 33) {
            begins[me] = 0;
        }
        if (me == 0) {
            shadowed = 0;
            lost = 0;
        }
        barrier();
        int my_lost = 0;
        int my_shadowed = 0;
        for (int i = 0; i < EACH; ++i) {
            uint mask = masks[i * 128 + me];
            my_shadowed += mask == ALL ? 0 : 1;
            uint left = mask & ~seen_from(mask, placed);
            my_lost += bitCount(int(left));
            while (left != 0u) {
                int first = findLSB(int(left));
                uint run = run_at(left, first);
                int length = bitCount(int(run));
                atomicAdd(begins[first], length);
                atomicAdd(begins[first + length], -length);
                left &= ~run;
            }
        }
        atomicAdd(lost, my_lost);
        atomicAdd(shadowed, my_shadowed);
        barrier();
        if (me == 0) {
            // The next sample goes to the middle of the first run of bits with the largest gain.
            int first = 0;
            int last = 0;
            int most = 0;
            int sum = 0;
            for (int bit = 0; bit < 32; ++bit) {
                sum += begins[bit];
                first = sum > most ? bit : first;
                last = sum > most || (sum == most && last == bit - 1) ? bit : last;
                most = max(most, sum);
            }
            bool enough = float(lost) <= 32.0 * push.error * float(shadowed);
            if (enough || most == 0 || count >= push.most) {
                done = 1;
            } else {
                placed |= 1u << ((first + last) / 2);
            }
        }
        barrier();
        if (done != 0) {
            break;
        }
    }
    if (me == 0) {
        int count = 0;
        for (uint left = placed; left != 0u; left &= left - 1u) {
            int bit = findLSB(int(left));
            samples.at[count] = bit == 0 ? 0.0 : bit == 31 ? 1.0 : (float(bit) + 0.5) / 32.0;
            count += 1;
        }
        samples.count = count;
    }
}
