// The interface of a pass, and what it declares. Declaring is pure and needs no GL; executing runs one step
// at a time.
#pragma once
#include "graph/types.h"
#include "scene/facts.h"
#include "shader/source.h"
#include <concepts>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace kestrel {

class Commands; // execute/commands.h: what a step may do on the GPU

// What compiling depends on besides the graph.
struct World {
    SceneFacts facts;
    Capabilities capabilities;
    Extent size{640, 360, 1}; // of the frame, in pixels
    // Extent of an image with this view: (size + 2 guard) / divisor, rounded up; `size` is the frame's, or
    // what sizeOf() says.
    [[nodiscard]] Extent extentOf(const View& view) const;
    // Of the whole image that a view's pixels are counted in: the frame's, or a square.
    [[nodiscard]] Extent sizeOf(const View& view) const { return kestrel::sizeOf(view, size); }
};

// What is connected to the input ports. An input that is not connected, or whose producer was left out, is
// absent.
class Inputs {
public:
    struct Input {
        Desc desc;
        std::optional<glm::vec4> constant; // the same value everywhere; the resource holds it too
        Causes causes = Causes::All;       // for which it can change over the timeline
        friend bool operator==(const Input&, const Input&) = default;
    };
    [[nodiscard]] bool connected(std::string_view port) const { return inputs_.find(port) != inputs_.end(); }
    [[nodiscard]] const Input& operator[](std::string_view port) const; // check: connected
    void set(std::string port, Input input) { inputs_.insert_or_assign(std::move(port), std::move(input)); }
    friend bool operator==(const Inputs&, const Inputs&) = default;

private:
    std::map<std::string, Input, std::less<>> inputs_;
};

// Output -> elements that it needed when it was too small.
using Growth = std::map<std::string, std::uint64_t, std::less<>>;

// Which outputs somebody reads, what consumers request of the modules, and how much room outputs needed
// before.
class Demand {
public:
    static Demand everything() { return Demand(true); }
    static Demand nothing() { return Demand(false); }
    [[nodiscard]] bool reads(std::string_view port) const {
        return all_ || ports_.find(port) != ports_.end();
    }
    // The union of what consumers take of a module port.
    [[nodiscard]] Bits requests(std::string_view port) const;
    void add(std::string port, Bits requests = 0);
    // Elements that an output of this pass must hold, since it overflowed in this scene, at this size and
    // with these properties; 0: it did not. Their meaning is the pass's own, that of Output::capacity and
    // Commands::overflow.
    [[nodiscard]] std::uint64_t grown(std::string_view port) const {
        const auto found = grown_.find(port);
        return found == grown_.end() ? 0 : found->second;
    }
    void setGrown(Growth grown) { grown_ = std::move(grown); }
    // Whether anything at all is asked for.
    [[nodiscard]] bool any() const { return all_ || !ports_.empty(); }
    friend bool operator==(const Demand&, const Demand&) = default;

private:
    explicit Demand(bool all)
        : all_(all) {}
    bool all_ = false;
    std::map<std::string, Bits, std::less<>> ports_;
    Growth grown_;
};

// One use of a port (input, output or internal) by a step or a module.
//
// GLSL names: a sampler or image is called as its port (`uniform sampler2D depth`), a block as its port with
// a capital letter and without underscores (`buffer RayBuffer` for port "ray_buffer"). In a module file both
// are wrapped in M(). With `previous` (last frame's content) the name gets "previous_" or "Previous" in
// front. Where a step reads a texture or texel buffer by one use and writes it by another (two mips, say),
// the image that is written is called port + "_out". A fragment output is called "out_" + port. A uniform
// block called <Block name>View, as `DepthView`, receives the port's ViewData (shared/view.h).
struct Use {
    std::string port;
    Access access = Access::Fetch;
    bool write = false;
    bool previous = false; // last frame's content: keeps a history of the resource
    bool linear = false;   // Fetch: linear filtering (and between mips); otherwise nearest
    int mip = -1; // Image, Attachment: that level only; Fetch: restricts the levels; -1: level 0 / all levels
    // Image, Attachment: that layer of an array, slice of a volume or face of a cube alone, which is a plain
    // image then; -1: all of them (a layered attachment)
    int layer = -1;
};

// Includes the module connected to input `port` (`#include <port:NAME>`) into the step's program.
struct ModuleUse {
    std::string port;
    Bits requests = 0;
};

class Pass;

// What a step runs when its turn comes: a member function of its pass with the arguments that its declaration
// gives it, or anything that is called with the commands alone.
class StepRun {
public:
    StepRun() = default;
    template<class T, class... Arguments>
    StepRun(void (T::*member)(Commands&, Arguments...),
            std::type_identity_t<std::decay_t<Arguments>>... arguments)
        : function_([=](Pass& pass, Commands& commands) {
            (static_cast<T&>(pass).*member)(commands, arguments...);
        }) {}
    template<class T, class... Arguments>
    StepRun(void (T::*member)(Commands&, Arguments...) const,
            std::type_identity_t<std::decay_t<Arguments>>... arguments)
        : function_([=](Pass& pass, Commands& commands) {
            (static_cast<const T&>(pass).*member)(commands, arguments...);
        }) {}
    template<class F>
    requires std::invocable<F&, Commands&> StepRun(F function)
        : function_([function](Pass&, Commands& commands) { function(commands); }) {}
    [[nodiscard]] explicit operator bool() const { return static_cast<bool>(function_); }
    void operator()(Pass& pass, Commands& commands) const { function_(pass, commands); }

private:
    std::function<void(Pass&, Commands&)> function_;
};

// One piece of work: at most one program. Barriers, clocks and debug groups stand between steps.
struct Step {
    std::string name = {}; // unique within the pass; for people: reports, debuggers, errors
    StepRun run = {};      // without it Pass::execute runs
    // Files by stage, "gbuffer/gbuffer.vert"…; empty: no program (uploads, copies, host).
    std::vector<std::string> shaders = {};
    Defines defines = {};
    std::vector<Use> uses = {}; // colour attachments are numbered in this order
    std::vector<ModuleUse> modules = {};
    // What the time counts as: "generation", "tracing", "filter"…; empty: the pass's name.
    std::string group = {};
};

// A module that this pass provides at output `port`. `uses` are ports of this pass (inputs too) that the file
// reads; consumers inherit them. `modules` are inputs of this pass that the file includes itself.
struct Module {
    std::string port;
    std::string shader;
    Defines defines = {};
    std::vector<Use> uses = {};
    std::vector<ModuleUse> modules = {};
};

struct Output {
    std::string port; // output or internal
    Desc desc;
    // Set before the pass's first step each time it runs; without it the pass writes every element.
    std::optional<glm::vec4> clear = {};
    // The same value everywhere: no step need write it; the compiler makes it once and tells the readers.
    std::optional<glm::vec4> constant = {};
    std::string same = {};    // equals this input: no resource of its own
    std::string updates = {}; // is this input changed in place (copied first where another reader follows)
    bool keeps = false; // the pass itself reads what it wrote in earlier frames: never shared, never lost
    // It may be too small: it holds `capacity` elements, and the first 32-bit word of this buffer of the pass
    // (cleared each time the pass runs) counts those that were wanted. The executor reads the counts of a
    // frame at once; where one is larger the plan is compiled anew with Demand::grown, and what used the
    // output runs again.
    std::string counter = {};
    std::uint64_t capacity = 0;
};

// What was left out, and why: one sentence without full stop.
struct LeftOut {
    std::string what, why;
};

// A mistake that only declaring can find: `port` may be empty.
struct DeclarationProblem {
    std::string port, message;
    bool machine = false; // nothing is wrong but that this machine is too small or lacks something
};

struct Declaration {
    std::vector<Output> outputs;
    std::vector<Module> modules;
    std::vector<Step> steps;
    std::vector<LeftOut> leftOut;
    std::vector<DeclarationProblem> problems;
    // For which causes the results change, besides those of the inputs that are read. Frame: runs every
    // frame.
    Causes depends = Causes::None;
    // Runs every frame though nothing changed (keeps a history). What it makes may be new in every frame, so
    // its readers run too.
    bool always = false;
};

// A technique. One object per pass of a graph; its properties are members, bound by the table of its type.
class Pass {
public:
    virtual ~Pass() = default;
    Pass() = default;
    Pass(const Pass&) = delete;
    Pass& operator=(const Pass&) = delete;

    // PassType::instance of the type that made it; set by makePasses().
    std::uint64_t typeInstance = 0;

    // Pure: no GL, no state. Called several times a compilation: first with every demand, then with the real
    // one until inputs and demand have settled. With less demand it may have fewer steps, defines and
    // outputs; what an output means never changes, and what is asked for must be declared.
    [[nodiscard]] virtual Declaration declare(const World& world, const Inputs& inputs,
                                              const Demand& demand) const = 0;

    // Runs one declared step; called for each step in order, in every frame in which the pass runs. A step
    // runs what it carries (Step::run); a pass whose steps all do the same overrides this instead, and one
    // without steps neither.
    virtual void execute(const Step& step, Commands& commands);
};

} // namespace kestrel
