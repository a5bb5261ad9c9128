// What the parts of the filter read of a signal: of one channel its value, else its luminance.
#include "lib/edge_stopping.glsl"

#ifdef ONE_CHANNEL
float brightness(vec4 value) { return value.r; }
#else
float brightness(vec4 value) { return luminance(value.rgb); }
#endif
