#include "graph/barriers.h"
#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace kestrel {
namespace {

struct AccessRule {
    Access access;
    Barrier visibility; // makes shader writes visible to this access
    bool incoherent;    // writes of this kind need a barrier before they are seen
    bool shaderMemory;  // a later shader write has an execution dependency on it
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

// What one cell still owes: visibility of what was written to it, and an execution dependency of a later
// store on what accessed it.
struct Pending {
    bool written = false;                 // by an incoherent write …
    Barrier visibleTo = Barrier::None;    // … whose visibility these barriers have met, whatever is skipped
    Barrier visibleHere = Barrier::None;  // … and these within the present pass, whose steps run together
    bool touched = false;                 // accessed by shaders or fixed function …
    Barrier orderedAfter = Barrier::None; // … on which these barriers have met the execution dependency
    Barrier orderedAfterHere = Barrier::None;
};

struct Touch {
    size_t cell;
    Access access;
    bool write;
};

// The memory of all objects, cut into cells where a resource begins or ends: two resources meet where they
// have a cell in common. A texture is one cell, a buffer as many as the ranges in it make. Both objects of a
// history count as the first.
class Cells {
public:
    explicit Cells(const Plan& plan)
        : of_(plan.resources.size()) {
        std::map<std::pair<int, std::uint64_t>, size_t> cells; // object and first byte -> number
        for (const PlanResource& resource : plan.resources) {
            if (resource.object < 0) continue;
            cells[{resource.object, resource.offset}] = 0;
            cells[{resource.object, endOf(resource)}] = 0;
        }
        for (auto& [begin, number] : cells) number = count_++;
        for (size_t i = 0; i < of_.size(); ++i) {
            const PlanResource& resource = plan.resources[i];
            if (resource.object < 0) continue;
            const auto end = cells.find({resource.object, endOf(resource)});
            for (auto cell = cells.find({resource.object, resource.offset}); cell != end; ++cell)
                of_[i].push_back(cell->second);
        }
    }
    [[nodiscard]] const std::vector<size_t>& of(int resource) const {
        return of_[static_cast<size_t>(resource)];
    }
    [[nodiscard]] size_t count() const { return count_; }

private:
    static std::uint64_t endOf(const PlanResource& resource) {
        return resource.offset + std::max<std::uint64_t>(resource.desc.totalBytes(), 1);
    }
    std::vector<std::vector<size_t>> of_; // by resource
    size_t count_ = 0;
};

class Planner {
public:
    explicit Planner(Plan& plan)
        : plan_(plan)
        , cells_(plan)
        , pending_(cells_.count())
        , writers_(cells_.count()) {
        for (const PlanStep& step : plan.steps)
            for (const PlanBinding& binding : step.bindings)
                if (binding.write && isIncoherent(binding.access))
                    for (const size_t cell : cells_.of(binding.resource)) writers_[cell].insert(step.pass);
    }

    void run() {
        // Each round starts from the state in which the one before ends, and holds once it sets the same
        // barriers: a barrier that one round finds unneeded, as an earlier one does its work, may be what the
        // next frame counted on. Rounds that do not settle only add from then on, and so must end.
        constexpr int freeRounds = 4;
        for (int round = 0;; ++round) {
            const std::vector<Barrier> before = barriers();
            for (size_t i = 0; i < plan_.steps.size(); ++i) step(i, round >= freeRounds);
            if (round > 0 && barriers() == before) return;
        }
    }

private:
    // Everything that a step and the commands before it touch.
    [[nodiscard]] std::vector<Touch> touchesOf(size_t index) const {
        const PlanStep& step = plan_.steps[index];
        const PlanPass& pass = plan_.passes[static_cast<size_t>(step.pass)];
        std::vector<Touch> touches;
        const auto touch = [&](int resource, Access access, bool write) {
            for (const size_t cell : cells_.of(resource)) touches.push_back({cell, access, write});
        };
        for (const auto& [from, to] : step.copies) {
            touch(from, Access::Copy, false);
            touch(to, Access::Copy, true);
        }
        if (static_cast<int>(index) == pass.firstStep)
            for (size_t i = 0; i < plan_.resources.size(); ++i)
                if (plan_.resources[i].clear && plan_.resources[i].port.pass == pass.name)
                    touch(static_cast<int>(i), Access::Copy, true);
        for (const PlanBinding& binding : step.bindings)
            touch(binding.resource, binding.access, binding.write);
        return touches;
    }

    [[nodiscard]] std::vector<Barrier> barriers() const {
        std::vector<Barrier> all;
        for (const PlanStep& step : plan_.steps) all.push_back(step.barrier);
        return all;
    }

    void enterPass() {
        for (Pending& pending : pending_) pending.visibleHere = pending.orderedAfterHere = Barrier::None;
    }

    void step(size_t index, bool keepsBarrier) {
        PlanStep& step = plan_.steps[index];
        const PlanPass& pass = plan_.passes[static_cast<size_t>(step.pass)];
        if (static_cast<int>(index) == pass.firstStep) enterPass();
        const std::vector<Touch> touches = touchesOf(index);
        Barrier needed = keepsBarrier ? step.barrier : Barrier::None;
        for (const Touch& touch : touches) needed |= neededFor(touch);
        step.barrier = needed;
        stand(needed, step.pass, touches);
        for (const Touch& touch : touches) note(touch);
    }

    [[nodiscard]] Barrier neededFor(const Touch& touch) const {
        const Pending& pending = pending_[touch.cell];
        const Barrier visibility = ruleOf(touch.access).visibility;
        Barrier needed = Barrier::None;
        if (pending.written && ((pending.visibleTo | pending.visibleHere) & visibility) == Barrier::None)
            needed |= visibility;
        if (touch.write && isIncoherent(touch.access) && pending.touched &&
            ((pending.orderedAfter | pending.orderedAfterHere) & visibility) == Barrier::None)
            needed |= visibility;
        return needed;
    }

    // The barrier of a step that may be skipped counts for later passes only for what the step itself reads
    // of passes whose causes it inherits: then it runs whenever that was written.
    void stand(Barrier barrier, int pass, const std::vector<Touch>& touches) {
        const bool always = plan_.passes[static_cast<size_t>(pass)].everyFrame;
        for (Pending& pending : pending_) {
            pending.visibleHere |= barrier;
            pending.orderedAfterHere |= barrier;
            if (!always) continue;
            pending.visibleTo |= barrier;
            pending.orderedAfter |= barrier;
        }
        for (const Touch& touch : touches)
            if (!touch.write && followsWriters(pass, touch.cell)) pending_[touch.cell].visibleTo |= barrier;
    }

    [[nodiscard]] bool followsWriters(int pass, size_t cell) const {
        const std::vector<int>& inputs = plan_.passes[static_cast<size_t>(pass)].inputs;
        return std::all_of(writers_[cell].begin(), writers_[cell].end(), [&](int writer) {
            return writer == pass || std::find(inputs.begin(), inputs.end(), writer) != inputs.end();
        });
    }

    void note(const Touch& touch) {
        Pending& pending = pending_[touch.cell];
        if (touch.write && isIncoherent(touch.access)) {
            pending.written = true;
            pending.visibleTo = pending.visibleHere = Barrier::None;
        }
        if (ruleOf(touch.access).shaderMemory) {
            pending.touched = true;
            pending.orderedAfter = pending.orderedAfterHere = Barrier::None;
        }
    }

    Plan& plan_;
    Cells cells_;
    std::vector<Pending> pending_;
    std::vector<std::set<int>> writers_; // passes that write a cell incoherently
};

} // namespace

Barrier barrierFor(Access access) { return ruleOf(access).visibility; }

bool isIncoherent(Access access) { return ruleOf(access).incoherent; }

Barrier barrierBetween(Access first, bool firstWrites, Access second, bool secondWrites) {
    const bool visibility = firstWrites && isIncoherent(first);
    const bool executionDependency = secondWrites && isIncoherent(second) && ruleOf(first).shaderMemory;
    return visibility || executionDependency ? barrierFor(second) : Barrier::None;
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
