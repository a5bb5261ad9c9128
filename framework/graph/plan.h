// The compiled form of a graph: what to make, what to run in which order, with barriers as data. Made by
// compile(), run by execute/executor.h, tested without GL.
#pragma once
#include "graph/graph.h"
#include "shader/compose.h"
#include <memory>

namespace kestrel {

// Memory barriers, named as in OpenGL; the executor maps them bit by bit to glMemoryBarrier.
enum class Barrier : std::uint32_t {
    None = 0,
    VertexAttrib = 1 << 0, // and element arrays
    Uniform = 1 << 1,
    TextureFetch = 1 << 2,
    ShaderImage = 1 << 3,
    Command = 1 << 4,
    BufferUpdate = 1 << 5, // and texture update, client mapped
    Framebuffer = 1 << 6,
    ShaderStorage = 1 << 7
};
constexpr Barrier operator|(Barrier a, Barrier b) { return Barrier(std::uint32_t(a) | std::uint32_t(b)); }
constexpr Barrier operator&(Barrier a, Barrier b) { return Barrier(std::uint32_t(a) & std::uint32_t(b)); }
constexpr Barrier& operator|=(Barrier& a, Barrier b) { return a = a | b; }

// A virtual resource: what one output or internal port holds.
struct PlanResource {
    PortRef port; // its producer
    Desc desc;
    std::optional<glm::vec4> clear, constant;
    bool transient = false; // made and read in every frame, so it may share an object with another lifetime
    bool history = false; // somebody reads last frame's content: two objects that swap when the producer runs
    int object = -1;      // index into Plan::objects (of a history: the first of two)
    std::uint64_t offset = 0; // of a buffer: its first byte in the object, a multiple of rangeAlignment
    int firstStep = 0, lastStep = 0; // lifetime within a frame; whole frame if not transient
};

// A physical texture or buffer. A buffer may be larger than what lies in it at any time.
struct PlanObject {
    Desc desc;
    std::string label; // ports that share it, for debuggers
};

// One resource bound to one GLSL name in a step.
struct PlanBinding {
    std::string name; // sampler, image or block name in the program, module path included
    std::string
        path; // of the module that it is inherited through, "tracer_near_"; empty: a use of the pass itself
    std::string port;  // of the pass that declares the use
    int resource = -1; // index into Plan::resources
    Access access = Access::Fetch;
    bool write = false, previous = false, linear = false;
    int mip = -1, layer = -1;
};

// A uniform block that receives the ViewData of an image (shared/view.h), if the program declares it.
struct PlanView {
    std::string name; // block name in the program, module path included: "DepthView", "tracer_DepthView"
    View view;
    Extent extent;     // of the image, guard band included
    int resource = -1; // that the image is; -1: only the view is known
    bool previous = false;
};

// Before a step, in this order: its barrier, its copies, the clears of its pass (first step only).
struct PlanStep {
    int pass = -1; // index into Plan::passes
    Step step;     // as declared
    std::vector<PlanBinding> bindings;
    int program = -1;                        // index into Plan::programs; -1: none
    Barrier barrier = Barrier::None;         // before the step
    std::vector<std::pair<int, int>> copies; // resources copied before the step (from, to): in-place updates
                                             // with another reader
    std::vector<PlanView> views;             // of every port of the pass and of its modules
    bool preview = false;                    // runs for previews alone
};

// An output that may turn out too small: the executor reads how many elements were wanted.
struct PlanCounter {
    std::string port;           // whose elements are counted
    int resource = -1;          // its first 32-bit word is the count
    std::uint64_t capacity = 0; // elements
};

struct PlanPass {
    std::string name, type;
    std::shared_ptr<Pass> instance;
    std::vector<PlanCounter> counters;
    bool repeatable = true; // running it twice in a frame gives what running it once gives: it keeps nothing
    Causes depends = Causes::None;
    bool always = false;
    bool everyFrame =
        false; // its steps surely run in every frame (Frame among the possible causes, or always)
    int firstStep = 0, stepCount = 0; // a pass that only provides modules has no steps
    std::vector<int> inputs;          // passes whose causes make the steps run (also through modules)
    std::map<std::string, int> ports; // port -> resource (inputs too, resolved to their producer)
    std::map<std::string, std::vector<int>>
        inputPasses;                   // input port -> producing passes (transitively for modules)
    std::map<std::string, Desc> descs; // port -> what stands behind it (modules too)
};

struct PlanOutput {
    PortRef port;         // as the graph asks
    int resource = -1;    // -1: a preview that is not made here (Plan::leftOut says why)
    bool preview = false; // asked for by CompileOptions::previews only
};

struct MemoryReport {
    std::uint64_t transient = 0; // with sharing
    std::uint64_t unshared = 0;  // the same resources without sharing
    std::uint64_t persistent = 0;
};

// What previews cost. The plan's other figures are those without them.
struct PreviewCost {
    std::uint64_t memory = 0;         // bytes more
    std::vector<std::string> altered; // "pass.step" whose program or bindings are others for a preview's sake
    std::vector<LeftOut> leftOut;     // with the previews
};

struct Plan {
    std::vector<PlanResource> resources;
    std::vector<PlanObject> objects;
    std::vector<PlanPass> passes; // in order of execution
    std::vector<PlanStep> steps;
    std::vector<ProgramRequest> programs; // without duplicates
    std::vector<PlanOutput> outputs;
    std::vector<LeftOut> leftOut;
    MemoryReport memory;
    PreviewCost previews;
    Extent size;
};

struct CompileOptions {
    // Nothing is left out: every pass of the graph runs with every demand it can bear, declares with facts
    // that promise nothing (masked, moving, textured: all of it may occur; counts stay true), and reads
    // constants as images.
    bool keepAll = false;
    bool shareMemory = true;
    std::vector<PortRef> previews;            // further ports that somebody wants to see
    std::map<std::string, Growth> grown = {}; // of each pass: what its outputs needed after an overflow
};

// Pass objects by name, with the graph's properties set. Reuse them over compilations to keep host-side
// state.
using PassSet = std::map<std::string, std::shared_ptr<Pass>>;
PassSet makePasses(const Graph& graph, const Registry& registry);

// Sets every property: to what the document gives, else to its default. The document must be valid.
void setProperties(Pass& pass, const PassType& type, const GraphPass& document);

// Compiles in named stages (see compile.cpp). The graph must be valid. Throws InputError with every problem
// that the declarations report, with the place of the pass in the graph file.
Plan compile(const Graph& graph, const Registry& registry, const PassSet& passes, const World& world,
             const CompileOptions& options = {});

} // namespace kestrel
