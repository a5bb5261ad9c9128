// Least and largest depth of a pixel's fragments and how many there are, all by one blended attachment: the larger of
// the negated depth, the larger of the depth, and the sum of ones. With COUNT their number alone.
#include "abuffer/fragment.glsl"

out vec4 OUTPUT;

void main() {
    float depth;
    if (!abufferFragment(depth)) discard;
#ifdef COUNT
    OUTPUT = vec4(1.0);
#else
    OUTPUT = vec4(-depth, depth, 0.0, 1.0);
#endif
}
