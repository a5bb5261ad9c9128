// The programs of a plan, kept over plans: one for each composed text and order of attachments.
#pragma once
#include "gl/program.h"
#include "graph/plan.h"
#include "shader/source.h"
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace kestrel {

class Programs {
public:
    // Programs that no step uses stay a while: who compares two settings goes back and forth. More are
    // forgotten, those first that were not used for longest.
    static constexpr size_t maxUnused = 64;

    struct Entry {
        std::unique_ptr<gl::Program> program;
        std::string name;      // its files, for messages
        std::uint64_t key = 0; // of the composed text
        bool countsIterations = false;
        bool readsLastMotion = false; // uses last frame's transforms
    };

    // Composes and makes what the plan's steps need that is not there yet; with `countIterations` such that
    // loops are counted (shader/iterations.h). Throws InputError with the problems of all programs; the
    // programs of the plan before stay then.
    void adopt(const Plan& plan, ShaderLibrary& library, const Capabilities& capabilities,
               bool countIterations);

    [[nodiscard]] size_t cached() const { return cache_.size(); }
    // Of a step by its index; null if it has none.
    [[nodiscard]] Entry* of(int step) const { return steps_.at(static_cast<size_t>(step)).get(); }

private:
    using Key = std::pair<std::uint64_t, std::vector<std::string>>;
    struct Cached {
        std::shared_ptr<Entry> entry;
        std::uint64_t lastUse = 0; // number of the plan
    };
    void forgetOld();

    std::map<Key, Cached> cache_;
    std::uint64_t plans_ = 0;
    std::vector<std::shared_ptr<Entry>> steps_;
};

// The ports of a step's colour attachments, in the order of their numbers.
std::vector<std::string> colourAttachments(const PlanStep& step, const Plan& plan);

} // namespace kestrel
