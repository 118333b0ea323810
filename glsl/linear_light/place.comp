// Entry of the pass linear_light.place (src/techniques/linear_light/samples.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/mask.glsl"
#include "linear_light/line.glsl"

// Where a line's samples are (the paper's open problem, section 5): at its ends, and then where the most light is lost,
// until what is lost is no more than the error allowed, or there are as many samples as may be.

layout(local_size_x = 128) in;

layout(set = 0, binding = 0, std430) readonly buffer Masks { uint masks[]; };
layout(set = 0, binding = 1, std430) buffer Of { Samples of; };

layout(push_constant) uniform Push {
    float error; // allowed: a share of the line, in the mean over what is not wholly lit
    int most;    // samples
    int even;    // 1: as many as may be, evenly: the middle does not tell
} push;

const int EACH = RECEIVERS.x * RECEIVERS.y / 128;

shared int begins[33];  // at the first bit of each lost run, its length; behind the last, less so
shared int shadowed;    // receivers that do not see the whole line
shared int lost;        // bits
shared uint taken;      // where samples are
shared int done;

uint known(uint mask, uint samples)
{
    uint told = 0u;
    for (uint left = samples; left != 0u; left &= left - 1u) {
        told |= run_at(mask, findLSB(int(left)));
    }
    return told;
}

void main()
{
    int me = int(gl_LocalInvocationID.x);
    if (push.even != 0) {
        if (me < push.most) {
            of.at[me] = float(me) / float(push.most - 1);
            of.count = push.most;
        }
        return;
    }
    if (me == 0) {
        taken = 0x80000001u;
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
            uint left = mask & ~known(mask, taken);
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
            // The middle of the first places that tell most.
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
                taken |= 1u << ((first + last) / 2);
            }
        }
        barrier();
        if (done != 0) {
            break;
        }
    }
    if (me == 0) {
        int count = 0;
        for (uint left = taken; left != 0u; left &= left - 1u) {
            int bit = findLSB(int(left));
            of.at[count] = bit == 0 ? 0.0 : bit == 31 ? 1.0 : (float(bit) + 0.5) / 32.0;
            count += 1;
        }
        of.count = count;
    }
}
