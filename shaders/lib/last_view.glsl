// The view of the last frame. A shader that includes this file reads it, and its pass runs one frame longer than anything
// moves: the executor looks for the name below in the text of a program.
#define READS_LAST_VIEW
#include "lib/view.glsl"

// Where the position stood in the last frame's image of the same kind (no jitter); false behind the eye.
bool projectPrevious(ViewData view, vec3 previousPosition, out vec2 pixel) {
    vec4 clip = view.previousViewProjection * vec4(previousPosition, 1.0);
    pixel = (clip.xy / clip.w * 0.5 + 0.5) * vec2(view.size);
    return clip.w > 0.0;
}
