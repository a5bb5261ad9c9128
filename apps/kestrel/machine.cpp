#include "machine.h"
#include "capabilities_file.h"
#include "core/error.h"
#include "core/files.h"
#include "core/version.h"
#include "gl/context.h"
#include "gl/timer.h"
#include "graph/graph.h"
#include "graph/plan.h"
#include "scene/facts.h"
#include "scene/scene.h"
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

namespace kestrel {
namespace {

// "method=interlock" for every value of every choice and flag, and "" for the graph as it stands.
std::vector<std::string> settingsOf(const PassType& type) {
    std::vector<std::string> settings = {""};
    for (const PropertyInfo& property : type.properties) {
        std::vector<std::string> values = property.choices;
        if (property.kind == PropertyKind::Bool) values = {"false", "true"};
        for (const std::string& value : values) settings.push_back(property.name + "=" + value);
    }
    return settings;
}

// What a plan leaves out, or why there is none.
std::set<std::string> said(const Graph& graph, const Registry& registry, const World& world) {
    std::set<std::string> sentences;
    try {
        for (const LeftOut& item : compile(graph, registry, makePasses(graph, registry), world).leftOut)
            sentences.insert(item.what + ": " + item.why);
    } catch (const Error& error) {
        for (const Problem& problem : error.problems()) sentences.insert(problem.message);
    }
    return sentences;
}

using Differences = std::map<std::string, std::map<std::string, std::set<std::string>>>;

class Comparison {
public:
    Comparison(const Registry& registry, const Capabilities& capabilities)
        : registry_(registry) {
        here_.facts = gatherFacts(loadScene("builtin:tower?detail=0.05"));
        here_.size = {640, 360, 1};
        unlimited_ = here_;
        here_.capabilities = capabilities;
        unlimited_.capabilities = Capabilities::unlimited();
    }

    void add(const Graph& graph) {
        if (!validate(graph, registry_).empty()) return; // a part that this build lacks
        for (const GraphPass& pass : graph.passes)
            for (const std::string& setting : settingsOf(*registry_.find(pass.type))) {
                if (!setting.empty() && !met_.insert(pass.type + "." + setting).second) continue;
                Graph changed = graph;
                if (!setting.empty()) applySetting(changed, registry_, pass.name + "." + setting);
                if (validate(changed, registry_).empty()) compare(changed, pass.type, setting);
            }
    }
    [[nodiscard]] const Differences& differences() const { return differences_; }

private:
    void compare(const Graph& graph, const std::string& type, const std::string& setting) {
        const std::set<std::string> anywhere = said(graph, registry_, unlimited_);
        for (const std::string& sentence : said(graph, registry_, here_))
            if (!anywhere.contains(sentence)) differences_[type][setting].insert(sentence);
    }

    const Registry& registry_;
    World here_, unlimited_;
    std::set<std::string> met_;
    Differences differences_;
};

} // namespace

std::string machineJson(const Registry& registry) {
    const auto context = gl::Context::create();
    const gl::StepClock clock(context->capabilities());
    Comparison comparison(registry, context->capabilities());
    for (const auto& entry : std::filesystem::directory_iterator(shareFolder() / "graphs"))
        if (entry.is_regular_file() && entry.path().filename() != "schema.json")
            comparison.add(loadGraph(entry.path()));
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(capabilitiesJson(context->capabilities()));
    json["kestrel"] = {{"version", version() + " " + configuration()},
                       {"parts", parts()},
                       {"driver", context->driver()},
                       {"clock", clock.name()},
                       {"differs", comparison.differences()}};
    return json.dump(2) + "\n";
}

} // namespace kestrel
