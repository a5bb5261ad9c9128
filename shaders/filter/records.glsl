// What is kept of each pixel besides images lies in buffers, in rows. On a CPU driver storing to a block costs a third to
// a fifth of storing to an image of four channels, and reading it back as texels what reading the image would.
#ifdef TEXELS
#define RECORDS(type, format, name, block) layout(format) uniform readonly imageBuffer name
#define RECORD(name, at) imageLoad(name, at)
#else
#define RECORDS(type, format, name, block) layout(std430) readonly buffer block { type name[]; }
#define RECORD(name, at) name[at]
#endif
#define WRITES_RECORDS(type, name, block) layout(std430) writeonly buffer block { type name[]; }

int recordIndex(ivec2 pixel, ivec2 size) { return pixel.y * size.x + pixel.x; }
