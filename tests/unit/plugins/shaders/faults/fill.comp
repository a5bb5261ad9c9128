layout(local_size_x = 8, local_size_y = 8) in;
layout(r32f) uniform writeonly image2D result;
void main() { imageStore(result, ivec2(gl_GlobalInvocationID.xy), vec4(0.5)); }
