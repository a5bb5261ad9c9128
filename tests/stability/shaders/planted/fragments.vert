#include "lib/vertex.glsl"
#include "shared/view.h"

layout(std140) uniform CountsView { ViewData countsView; };

void main() { gl_Position = countsView.viewProjection * vec4(in_position, 1.0); }
