// A fragment of the A-buffer's views in one colour.
#include "lib/fragment.glsl"
#include "abuffer/seen.glsl"

in SEEN seen;
out vec4 OUTPUT;

void main() {
#ifdef MATERIAL_MASKED
    if (!materialCovers(fragmentMaterial(), seen.texCoord, seen.texCoord1, seen.alpha)) discard;
#endif
    OUTPUT = vec4(seen.depth, 0.0, 0.0, 1.0);
}
