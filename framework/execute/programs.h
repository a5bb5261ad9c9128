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
    struct Entry {
        std::unique_ptr<gl::Program> program;
        std::string name;      // its files, for messages
        std::uint64_t key = 0; // of the composed text
        bool countsIterations = false;
        bool readsLastMotion = false; // uses last frame's transforms
    };

    // Composes and makes what the plan's steps need that is not there yet. Throws InputError with the
    // problems of all programs; the programs of the plan before stay then.
    void adopt(const Plan& plan, ShaderLibrary& library, const Capabilities& capabilities);

    // Of a step by its index; null if it has none.
    [[nodiscard]] Entry* of(int step) const { return steps_.at(static_cast<size_t>(step)).get(); }

private:
    using Key = std::pair<std::uint64_t, std::vector<std::string>>;
    std::map<Key, std::shared_ptr<Entry>> cache_;
    std::vector<std::shared_ptr<Entry>> steps_;
};

// The ports of a step's colour attachments, in the order of their numbers.
std::vector<std::string> colourAttachments(const PlanStep& step, const Plan& plan);

} // namespace kestrel
