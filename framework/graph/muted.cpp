#include "graph/muted.h"
#include <fmt/format.h>

namespace kestrel {
namespace {

class MutedPass final : public Pass {
public:
    explicit MutedPass(const PassType& type)
        : type_(type) {
        typeInstance = type.instance;
    }

    Declaration declare(const World&, const Inputs& inputs, const Demand& demand) const override {
        Declaration declaration;
        declaration.depends = Causes::None;
        declaration.leftOut.push_back({"its work", "it is muted"});
        for (const PortInfo& output : type_.ports) {
            if (output.direction != PortDirection::Output || !demand.reads(output.name)) continue;
            const PortInfo* input =
                standIn(type_, output, [&](const std::string& port) { return inputs.connected(port); });
            if (input == nullptr) {
                declaration.leftOut.push_back(
                    {output.name, fmt::format("the pass is muted, and no {} that feeds it can stand for '{}'",
                                              portKindName(output.kind), output.name)});
                continue;
            }
            declaration.outputs.push_back(
                {.port = output.name, .desc = inputs[input->name].desc, .same = input->name});
        }
        return declaration;
    }

private:
    const PassType& type_; // of the registry, which outlives what is compiled from it
};

} // namespace

const PortInfo* standIn(const PassType& type, const PortInfo& output,
                        const std::function<bool(const std::string&)>& connected) {
    const PortInfo* found = nullptr;
    for (const PortInfo& input : type.ports) {
        if (input.direction != PortDirection::Input || input.kind != output.kind || !connected(input.name))
            continue;
        if (input.content == output.content) return &input;
        // What reads the output must be able to read the input.
        if (found == nullptr && contentMistake(input.content, output.content).empty()) found = &input;
    }
    return found;
}

std::shared_ptr<Pass> mutedPass(const PassType& type) { return std::make_shared<MutedPass>(type); }

} // namespace kestrel
