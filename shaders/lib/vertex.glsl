// Vertex inputs of drawScene: the scene's triangles. GpuScene gives the same locations to its buffers.
layout(location = 0) in vec3 in_position; // render space
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec4 in_tangent; // w: handedness; 0: none
layout(location = 3) in vec2 in_tex_coord;
layout(location = 4) in vec2 in_tex_coord1;
layout(location = 5) in vec4 in_colour; // linear
layout(location = 6) in vec3 in_previous_position; // of the last frame
