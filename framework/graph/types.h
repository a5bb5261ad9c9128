// The small types that ports, declarations and plans are made of. Plain data, no GL.
#pragma once
#include "graph/format.h"
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace kestrel {

// What a port carries. The last four are shader modules (design: ports).
enum class PortKind : std::uint8_t { Texture, Buffer, Tracer, Hits, Layers, Radiance };
[[nodiscard]] std::string_view portKindName(PortKind kind); // "texture", "tracer", …
[[nodiscard]] constexpr bool isModule(PortKind kind) { return kind >= PortKind::Tracer; }

enum class PortDirection : std::uint8_t {
    Input,
    Output,
    Internal // a resource of the pass itself: made like an output, cannot be connected, can be previewed
};

// A property's value as it stands in JSON. Enumerations are strings.
using Value = std::variant<bool, std::int64_t, double, std::string, std::vector<double>>;

// How a step touches a port.
enum class Access : std::uint8_t {
    Fetch,      // sampler (texture) or samplerBuffer (buffer)
    Image,      // image (texture) or imageBuffer (buffer): the fastest random read on a CPU driver
    Storage,    // shader storage block
    Uniform,    // uniform block
    Attachment, // colour or depth attachment
    Vertex,     // vertex or index fetch
    Indirect,   // indirect command
    Copy,       // upload, copy, clear by the driver
    Host        // read back by the CPU
};

[[nodiscard]] std::string_view accessName(Access access); // "fetch", "image", …

// The causes for which something may change from one frame to the next.
enum class Causes : std::uint32_t {
    None = 0,
    Frame = 1 << 0,      // a new frame index: jitter, random numbers
    Camera = 1 << 1,     // the camera moved
    Cut = 1 << 2,        // another camera, a jump in time
    Geometry = 1 << 3,   // other triangles: another scene, a deformation
    Transforms = 1 << 4, // things moved
    Materials = 1 << 5,
    Lights = 1 << 6,
    Properties = 1 << 7,
    Size = 1 << 8,
    Cameras = 1 << 9, // a camera of the scene moved, be it the frame's or not: what a CameraView depends on
    All = (1 << 10) - 1
};
constexpr Causes operator|(Causes a, Causes b) { return Causes(std::uint32_t(a) | std::uint32_t(b)); }
constexpr Causes operator&(Causes a, Causes b) { return Causes(std::uint32_t(a) & std::uint32_t(b)); }
constexpr Causes operator~(Causes a) { return Causes(~std::uint32_t(a) & std::uint32_t(Causes::All)); }
constexpr Causes& operator|=(Causes& a, Causes b) { return a = a | b; }
constexpr bool any(Causes a) { return a != Causes::None; }

// ---- where a view looks from

struct FrameView { // the frame's camera
    friend bool operator==(const FrameView&, const FrameView&) = default;
};
struct CameraView { // a camera of the scene, whichever the frame has chosen
    int camera = 0;
    std::string name = {}; // counts in place of the number where it is not empty
    friend bool operator==(const CameraView&, const CameraView&) = default;
};
// One face of a cube whose axes are those of render space: square, 90 degrees. Faces 0 to 5 look along +x,
// -x, +y, -y, +z, -z; up is +y, for face 2 -z and for face 3 +z.
struct CubeView {
    int face = 0;
    std::optional<glm::vec3> point = {};     // where the rays meet, render space; absent: the frame's eye
    float nearPlane = 0.01f, farPlane = 100; // in scene units; far <= 0: infinite
    int side = 0;                            // of the whole image, pixels; 0: as high as the frame
    friend bool operator==(const CubeView&, const CubeView&) = default;
};
// What a light sees: a face of its shadow map (draw/light_faces.h). Square.
struct LightView {
    int light = 0; // index into the frame's lights
    int face = 0;
    int side = 0; // as CubeView::side
    friend bool operator==(const LightView&, const LightView&) = default;
};
using ViewSource = std::variant<FrameView, CameraView, CubeView, LightView>;

// The view that an image was made with. Whoever reads a depth reads it with this view. Pixels of square views
// are counted as if the frame had their side.
struct View {
    ViewSource source = {};
    int divisor = 1;     // the image has 1/divisor of the frame's resolution per axis
    int guard = 0;       // extra pixels on each side, in pixels of the frame
    bool jitter = false; // sub-pixel offset that changes with the frame
    friend bool operator==(const View&, const View&) = default;
};
// The causes for which what a view sees from changes. None for the frame's camera: its passes name theirs.
[[nodiscard]] Causes causesOf(const View& view);
// "camera 1", "camera 'top'", "cube face 2 about the eye"…, with all that tells two apart; empty for the
// frame's.
[[nodiscard]] std::string describe(const View& view);

struct Extent {
    std::uint32_t width = 1, height = 1;
    std::uint32_t depth = 1; // of a 3D texture; layers of an array
    friend bool operator==(const Extent&, const Extent&) = default;
};

// Of the whole image that a view's pixels are counted in: the frame's, or a square.
[[nodiscard]] Extent sizeOf(const View& view, const Extent& frame);

enum class ResourceKind : std::uint8_t { Texture2D, Texture2DArray, TextureCube, Texture3D, Buffer, Module };

// What a module provides, what a consumer requests of it, and what it requires of others (design: provides,
// requires, requests).
using Bits = std::uint32_t;
namespace provides {
// Normal and material at a hit, not the position alone; of layers the triangles of all samples, in order.
inline constexpr Bits Surface = 1 << 0;
inline constexpr Bits Snaps =
    1 << 1; // can trace along a nearby candidate direction when the consumer requests that
inline constexpr Bits AlwaysSnaps = 1 << 2; // cannot trace the exact direction
inline constexpr Bits Approximate =
    1 << 3; // hits are those of a proxy (voxels, distances), not of the triangles
} // namespace provides
namespace requests {
inline constexpr Bits AnyHit = 1 << 0;
inline constexpr Bits ClosestHit = 1 << 1;
inline constexpr Bits Surface = 1 << 2; // requires provides::Surface
inline constexpr Bits Snap = 1 << 3; // the direction may be replaced by a nearby one (defines REQUESTS_SNAP)
inline constexpr Bits AllHits = 1 << 4;
} // namespace requests
// What a radiance module requires of the hits that it is asked about, in Desc::required of its port.
namespace required {
inline constexpr Bits Surface =
    1 << 0; // normal and material: consumers request requests::Surface of their tracer
} // namespace required

// What a pass that draws the scene does with blended materials (alphaMode BLEND). Tested: they are there
// where their alpha is at least the material's cutoff, as masked ones are and as rays meet them. Kept:
// wherever it is above 0. Alone: the same, and nothing else is drawn. LeftOut: nowhere.
enum class Blended : std::uint8_t { Tested, Kept, Alone, LeftOut };

// What a `layers` module (shaders/lib/layers.glsl) tells its consumers at declaration; Desc::view says from
// where its samples were taken: divisor, guard band, jitter. With provides::Surface it tells triangles too.
struct DepthLayers {
    int count = 0;        // depth samples of a texel that can be asked for at most (K)
    bool linear = true;   // stored as distance along the view axis, else as the rasterizer's depth
    bool ordered = false; // nearest first; otherwise in any order
    Blended blended = Blended::Tested; // which surfaces they are samples of
    friend bool operator==(const DepthLayers&, const DepthLayers&) = default;
};

// What the buffers of an A-buffer tell whoever reads them, at declaration: how its lists are kept (Vardis,
// Vasilakis, Papaioannou 2016, section 4.3 and Table 2), and of which views.
struct FragmentLists {
    // SB: contiguous. LL, DLL: lists linked one way or both. LLB, DLLB: the same, one list for each of
    // `buckets` equal parts of a pixel's depth range.
    enum class Structure : std::uint8_t { SB, LL, DLL, LLB, DLLB };
    Structure structure = Structure::DLLB;
    int buckets = 1;
    bool decoupled = true; // which triangle a fragment is of lies in a buffer of its own, not in its node
    bool mainView = true;  // the frame's view comes first, then the six faces of the cube
    int side = 0;          // of a face, pixels; 0: there is no cube
    float nearPlane = 0;   // by which each face's eye stands behind the frame's, scene units
    Blended blended = Blended::Tested;
    bool counted = true;  // the bounds tell how many fragments each pixel has
    bool shifted = false; // buckets have equally many fragments, not equal parts of the depth range
    bool planes = false;  // a fragment keeps how its triangle's depth changes over its pixel
    friend bool operator==(const FragmentLists&, const FragmentLists&) = default;
};

// Describes what stands behind a port.
struct Desc {
    ResourceKind kind = ResourceKind::Texture2D;
    Format format = Format::None; // of a buffer: the texel format for Fetch and Image access
    Extent extent;
    int mips = 1;
    std::uint64_t bytes = 0; // of a buffer
    View view;
    Bits provides = 0;       // of a module
    Bits required = 0;       // of a radiance module: of the hits that it is asked about
    DepthLayers depthLayers; // of a layers module
    FragmentLists lists;     // of an A-buffer's buffers
    friend bool operator==(const Desc&, const Desc&) = default;

    static Desc texture2D(Format format, Extent extent, View view = {});
    static Desc texture3D(Format format, Extent extent, int mips = 1);
    static Desc array2D(Format format, Extent extent);
    static Desc buffer(std::uint64_t bytes, Format texel = Format::None);
    static Desc module(Bits provides, Bits required = 0);
    static Desc layersModule(const DepthLayers& layers, const View& view, Bits provides = 0);
    // Bytes of all mips and layers.
    [[nodiscard]] std::uint64_t totalBytes() const;
    // Layers of level `mip`: of an array, slices of a volume, 6 of a cube, else 1.
    [[nodiscard]] int layers(int mip = 0) const;
};

// "4 MiB", "1.5 KiB", "12 bytes": exact where the number is a whole multiple.
std::string bytesText(std::uint64_t bytes);

// "rgba16f 640x360", "buffer 4 MiB", "r32f 256x256 seen by camera 1"…: for messages and reports.
std::string describe(const Desc& desc);

// What the context can do, as plain data: from the context, or the minimum of OpenGL 4.6.
struct Capabilities {
    std::string renderer = "none", version = "4.6";
    std::set<std::string> extensions;
    int maxComputeImages = 8, maxStorageBlocks = 8, maxTextureUnits = 16, maxUniformBlocks = 12;
    int maxTextureSize = 16384, max3DTextureSize = 2048, maxArrayLayers = 2048;
    int maxComputeSharedBytes = 32768, maxComputeInvocations = 1024;
    std::int64_t maxTextureBufferTexels = 65536;
    std::int64_t maxStorageBlockBytes = std::int64_t{1} << 27;
    bool software = false; // a CPU renderer: timer queries do not measure the work
    bool everyExtension = false;
    [[nodiscard]] bool has(const std::string& extension) const {
        return everyExtension || extensions.contains(extension);
    }
    // No device has less: for drawing and judging a graph where no device limits it.
    static Capabilities unlimited();
};

} // namespace kestrel
