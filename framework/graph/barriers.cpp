#include "graph/barriers.h"
#include <algorithm>
#include <array>
#include <set>

namespace kestrel {
namespace {

struct AccessRule {
    Access access;
    Barrier visible;   // makes shader writes visible to this access
    bool incoherent;   // writes of this kind need a barrier before they are seen
    bool shaderMemory; // an access that a later shader write must not overtake
};

// OpenGL 4.6, 7.13.2. Only image stores and storage block writes are incoherent. The barriers for shader
// image access and shader storage also hold back later stores until all earlier memory accesses are done;
// copies, uploads and readbacks are commands of the driver and need no such care.
constexpr std::array<AccessRule, 9> rules = {{
    {Access::Fetch, Barrier::TextureFetch, false, true},
    {Access::Image, Barrier::ShaderImage, true, true},
    {Access::Storage, Barrier::ShaderStorage, true, true},
    {Access::Uniform, Barrier::Uniform, false, true},
    {Access::Attachment, Barrier::Framebuffer, false, true},
    {Access::Vertex, Barrier::VertexAttrib, false, true},
    {Access::Indirect, Barrier::Command, false, true},
    {Access::Copy, Barrier::BufferUpdate, false, false},
    {Access::Host, Barrier::BufferUpdate, false, false},
}};

const AccessRule& ruleOf(Access access) { return rules.at(static_cast<size_t>(access)); }

// What is pending on one object.
struct Pending {
    bool written = false;             // by an incoherent write
    Barrier seenBy = Barrier::None;   // barriers that have stood since, whatever is skipped
    Barrier seenHere = Barrier::None; // … within the present pass, whose steps run together
    bool touched = false;             // accessed by shaders or fixed function since …
    Barrier heldBack = Barrier::None; // … and these barriers have stood since
    Barrier heldBackHere = Barrier::None;
};

struct Touch {
    size_t object;
    Access access;
    bool write;
};

class Planner {
public:
    explicit Planner(Plan& plan)
        : plan_(plan)
        , pending_(plan.objects.size())
        , writers_(plan.objects.size()) {
        for (const PlanStep& step : plan.steps)
            for (const PlanBinding& binding : step.bindings)
                if (binding.write && isIncoherent(binding.access))
                    writers_[objectOf(binding.resource)].insert(step.pass);
    }

    void run() {
        // The second round starts from the state in which the first one ends.
        for (int round = 0; round < 2; ++round)
            for (size_t i = 0; i < plan_.steps.size(); ++i) step(i);
    }

private:
    [[nodiscard]] size_t objectOf(int resource) const {
        return static_cast<size_t>(plan_.resources[static_cast<size_t>(resource)].object);
    }

    // Everything that a step and the commands before it touch. Both objects of a history count as the first.
    [[nodiscard]] std::vector<Touch> touchesOf(size_t index) const {
        const PlanStep& step = plan_.steps[index];
        const PlanPass& pass = plan_.passes[static_cast<size_t>(step.pass)];
        std::vector<Touch> touches;
        for (const auto& [from, to] : step.copies) {
            touches.push_back({objectOf(from), Access::Copy, false});
            touches.push_back({objectOf(to), Access::Copy, true});
        }
        if (static_cast<int>(index) == pass.firstStep)
            for (const PlanResource& resource : plan_.resources)
                if (resource.clear && resource.port.pass == pass.name)
                    touches.push_back({static_cast<size_t>(resource.object), Access::Copy, true});
        for (const PlanBinding& binding : step.bindings)
            touches.push_back({objectOf(binding.resource), binding.access, binding.write});
        return touches;
    }

    void enterPass() {
        for (Pending& pending : pending_) pending.seenHere = pending.heldBackHere = Barrier::None;
    }

    void step(size_t index) {
        PlanStep& step = plan_.steps[index];
        const PlanPass& pass = plan_.passes[static_cast<size_t>(step.pass)];
        if (static_cast<int>(index) == pass.firstStep) enterPass();
        const std::vector<Touch> touches = touchesOf(index);
        Barrier needed = Barrier::None;
        for (const Touch& touch : touches) needed |= neededFor(touch);
        step.barrier = needed;
        stand(needed, step.pass, touches);
        for (const Touch& touch : touches) note(touch);
    }

    [[nodiscard]] Barrier neededFor(const Touch& touch) const {
        const Pending& pending = pending_[touch.object];
        const Barrier visible = ruleOf(touch.access).visible;
        Barrier needed = Barrier::None;
        if (pending.written && ((pending.seenBy | pending.seenHere) & visible) == Barrier::None)
            needed |= visible;
        if (touch.write && isIncoherent(touch.access) && pending.touched &&
            ((pending.heldBack | pending.heldBackHere) & visible) == Barrier::None)
            needed |= visible;
        return needed;
    }

    // The barrier of a step that may be skipped counts for later passes only for what the step itself reads
    // of passes whose causes it inherits: then it runs whenever that was written.
    void stand(Barrier barrier, int pass, const std::vector<Touch>& touches) {
        const bool always = plan_.passes[static_cast<size_t>(pass)].everyFrame;
        for (Pending& pending : pending_) {
            pending.seenHere |= barrier;
            pending.heldBackHere |= barrier;
            if (!always) continue;
            pending.seenBy |= barrier;
            pending.heldBack |= barrier;
        }
        for (const Touch& touch : touches)
            if (!touch.write && followsWriters(pass, touch.object)) pending_[touch.object].seenBy |= barrier;
    }

    [[nodiscard]] bool followsWriters(int pass, size_t object) const {
        const std::vector<int>& inputs = plan_.passes[static_cast<size_t>(pass)].inputs;
        return std::all_of(writers_[object].begin(), writers_[object].end(), [&](int writer) {
            return writer == pass || std::find(inputs.begin(), inputs.end(), writer) != inputs.end();
        });
    }

    void note(const Touch& touch) {
        Pending& pending = pending_[touch.object];
        if (touch.write && isIncoherent(touch.access)) {
            pending.written = true;
            pending.seenBy = pending.seenHere = Barrier::None;
        }
        if (ruleOf(touch.access).shaderMemory) {
            pending.touched = true;
            pending.heldBack = pending.heldBackHere = Barrier::None;
        }
    }

    Plan& plan_;
    std::vector<Pending> pending_;
    std::vector<std::set<int>> writers_; // passes that write an object incoherently
};

} // namespace

Barrier barrierFor(Access access) { return ruleOf(access).visible; }

bool isIncoherent(Access access) { return ruleOf(access).incoherent; }

Barrier barrierBetween(Access first, bool firstWrites, Access second, bool secondWrites) {
    const bool makesVisible = firstWrites && isIncoherent(first);
    const bool holdsBack = secondWrites && isIncoherent(second) && ruleOf(first).shaderMemory;
    return makesVisible || holdsBack ? barrierFor(second) : Barrier::None;
}

void planBarriers(Plan& plan) { Planner(plan).run(); }

std::string barrierText(Barrier barrier) {
    constexpr std::array names = {"VertexAttrib", "Uniform",      "TextureFetch", "ShaderImage",
                                  "Command",      "BufferUpdate", "Framebuffer",  "ShaderStorage"};
    std::string text;
    for (size_t bit = 0; bit < names.size(); ++bit) {
        if ((static_cast<std::uint32_t>(barrier) & (1U << bit)) == 0) continue;
        if (!text.empty()) text += '|';
        text += names[bit];
    }
    return text.empty() ? "none" : text;
}

} // namespace kestrel
