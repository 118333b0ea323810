// From what slices hide each to what they hide together.

#ifndef OCCLUSION_TEXTURES_COMBINE_GLSL
#define OCCLUSION_TEXTURES_COMBINE_GLSL

const int PRODUCT = 0;
const int SUM = 1;
const int MAXIMUM = 2;

// What is hidden of the light behind one more slice, that hides `more` of it for itself: as if slices knew
// nothing of each other (eq. 5), as if none were behind another, as if all were. Written so that no rounding makes
// it more than 1: from 0.5 on 1 - hidden is exact, and below it what is left of it rounds to 1 at most.
float hidden_with(int combine, float hidden, float more)
{
    return combine == PRODUCT ? hidden + (1.0 - hidden) * more
           : combine == SUM   ? min(hidden + more, 1.0)
                              : max(hidden, more);
}

const float FEW = 1.0e-3;

// The same where the slice's window says what its blocking texels (x) have in common with those of all
// slices above it (y): z are both. `before` is what the slice right above hides of its own window.
float hidden_with_correlated(float hidden, float before, vec3 window)
{
    float own = window.x;
    float covered = window.y;
    float independent = own * covered;
    float correlation = window.z - independent;
    // How far from independent they could be, towards nested and towards disjoint.
    float most = min(own, covered) - independent;
    float least = independent - max(own + covered - 1.0, 0.0);
    // Where the window does not tell: as much as may go on from the slice right above.
    float prior = own > 0.0 ? min(before, window.z) / own : 0.0;
    float towards = correlation >= 0.0 ? (correlation + FEW * prior) / (most + FEW)
                                       : correlation / (least + FEW);
    // The light's rays through the window are not the same as through the slices above: what is hidden
    // there takes the place of what the window has of it.
    float both = own * hidden;
    both += towards >= 0.0 ? towards * (min(own, hidden) - both)
                           : towards * (both - max(own + hidden - 1.0, 0.0));
    return clamp(hidden + own - both, 0.0, 1.0);
}

#endif
