// What a fragment knows of its triangle in a view of the A-buffer, on its way through the stages: `in SEEN seen;`. Only what is
// read: members of a block are interpolated whether they are or not.
#ifdef MATERIAL_MASKED
#define SEEN_MATERIAL vec2 texCoord; vec2 texCoord1; float alpha;
#else
#define SEEN_MATERIAL
#endif
// SEVERAL_VIEWS: one draw goes to all of the views FIRST_VIEW to LAST_VIEW; otherwise all of it to VIEW.
#ifdef SEVERAL_VIEWS
#define SEEN_VIEW flat uint view;
#define SEEN_BY seen.view
#else
#define SEEN_VIEW
#define SEEN_BY VIEW
#endif
#define SEEN Seen { float depth; SEEN_MATERIAL SEEN_VIEW }

// BY_NUMBER, beside it: the triangle's number, `flat in uint seen_triangle`, which stages before a geometry stage give on by another
// name, and with PLANES between which depths it lies, `flat in vec2 seen_range`.
#if defined(GEOMETRY_SHADER) || (defined(BY_RAYS) && !defined(CUBE))
#define TRIANGLE_HERE corner_triangle
#else
#define TRIANGLE_HERE seen_triangle
#endif
