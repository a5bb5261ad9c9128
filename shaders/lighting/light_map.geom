// Chooses the layer where the vertex shader cannot.
#include "lib/light_map_block.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

#ifndef LIGHT_MAP_NO_VERTEX
in LightMapVertex LIGHT_MAP_VERTEX corner[];
out LightMapVertex LIGHT_MAP_VERTEX vertex;
#endif

void main() {
    for (int i = 0; i < 3; ++i) {
#ifndef LIGHT_MAP_NO_VERTEX
        vertex.position = corner[i].position;
        vertex.normal = corner[i].normal;
        vertex.texCoord = corner[i].texCoord;
        vertex.texCoord1 = corner[i].texCoord1;
#ifdef MATERIAL_NORMAL_MAPS
        vertex.tangent = corner[i].tangent;
#endif
#ifdef MATERIAL_COLOURS
        vertex.colour = corner[i].colour;
#endif
#endif
        gl_PrimitiveID = gl_PrimitiveIDIn;
        gl_Layer = map_layer;
        gl_Position = gl_in[i].gl_Position;
        EmitVertex();
    }
    EndPrimitive();
}
