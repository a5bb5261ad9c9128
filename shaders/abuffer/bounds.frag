// Least and largest depth of a pixel's fragments and how many there are, all by one blended attachment: the larger of
// the negated depth, the larger of the depth, and the sum of ones.
#include "abuffer/fragment.glsl"

#ifdef CUBE
out vec4 out_cube_bounds;
#define BOUNDS out_cube_bounds
#else
out vec4 out_bounds;
#define BOUNDS out_bounds
#endif

void main() {
    float depth;
    if (!abufferFragment(fragmentTriangle(), depth)) discard;
    BOUNDS = vec4(-depth, depth, 0.0, 1.0);
}
