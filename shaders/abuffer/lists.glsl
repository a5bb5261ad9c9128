// The lists of an A-buffer: where a pixel's words lie, and what a node holds. The structures' words are said in
// passes/abuffer/views.h. Addresses of nodes start at 1; 0 ends a list. All three buffers are r32ui.
#include "shared/abuffer.h"

// Macros, so that a module's own defines hold in them, whoever included this file first.
#define HEAD_WORD(bucket) (HEAD_FIRST + int(bucket))
#define TAIL_WORD(bucket) (TAIL_FIRST + int(bucket))

// A pixel's number among those of all views: the frame's view is view 0, a face 1 + face.
#define ABUFFER_PIXEL(view, pixel)                                                                                             \
    ((view) == 0u ? (pixel).y * MAIN_WIDTH + (pixel).x : MAIN_PIXELS + (int((view) - 1u) * SIDE + (pixel).y) * SIDE + (pixel).x)

#define NODE_AT(node, word) ((int(node) - 1) * NODE_WORDS + (word))
