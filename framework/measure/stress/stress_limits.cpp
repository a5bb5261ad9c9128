#include "measure/stress/stress_limits.h"
#include "core/files.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {
namespace {

std::vector<StressLimit> readLimits(const std::filesystem::path& file) {
    const Json json = Json::parse(readText(file), file.string());
    std::vector<Problem> problems;
    std::vector<StressLimit> limits;
    JsonFields top(json, "the file of limits", problems);
    top.required("kestrel_stress_limits", Json::Kind::Int);
    if (const Json* list = top.required("limits", Json::Kind::Array); list != nullptr)
        for (const Json& item : list->items) {
            JsonFields fields(item, "a limit", problems);
            StressLimit limit;
            const auto text = [&](const char* key, std::string& into, bool required) {
                const Json* value = required ? fields.required(key, Json::Kind::String)
                                             : fields.optional(key, Json::Kind::String);
                if (value != nullptr) into = value->text;
            };
            text("pass", limit.pass, false);
            text("graph", limit.graph, false);
            text("cases", limit.cases, true);
            text("port", limit.port, false);
            text("reason", limit.reason, true);
            if (const Json* times = fields.required("times", Json::Kind::Float); times != nullptr)
                limit.times = times->number;
            fields.refuseOthers();
            if (limit.reason.empty() || !(limit.times > 1))
                problems.push_back({item.where, "a limit needs a reason, and times above 1"});
            limits.push_back(std::move(limit));
        }
    top.refuseOthers();
    if (!problems.empty()) throw InputError(std::move(problems));
    return limits;
}

bool holdsFor(const StressLimit& limit, const Graph& graph, const std::string& name,
              const std::string& port) {
    const bool hasPass = limit.pass.empty() || std::ranges::any_of(graph.passes, [&](const GraphPass& pass) {
                             return pass.type == limit.pass;
                         });
    const bool isGraph = limit.graph.empty() || graph.file.stem() == limit.graph;
    const bool isCase = name == limit.cases || name.starts_with(limit.cases + "/");
    return hasPass && isGraph && isCase && (limit.port.empty() || limit.port == port);
}

} // namespace

const std::vector<StressLimit>& stressLimits() {
    static const std::vector<StressLimit> limits =
        readLimits(shareFolder() / "graphs" / "stress" / "limits.json");
    return limits;
}

void applyStressLimits(StressResult& result, const Graph& graph) {
    for (StressCheck& check : result.checks) {
        if (check.held || check.expects == "finite") continue;
        for (const StressLimit& limit : stressLimits()) {
            if (check.expects == "energy" || !(check.missed <= limit.times)) continue;
            if (!holdsFor(limit, graph, result.name, check.port)) continue;
            check.held = true;
            check.limit = limit.reason;
            break;
        }
    }
}

std::string stressLimitsMarkdown() {
    std::string text =
        "| pass or graph | cases | at most, times what is allowed | because |\n|---|---|---|---|\n";
    for (const StressLimit& limit : stressLimits()) {
        const std::string who = !limit.pass.empty() ? "`" + limit.pass + "`" : "`" + limit.graph + "`";
        text += fmt::format("| {}{} | `{}` | {:g} | {} |\n", who,
                            limit.port.empty() ? "" : fmt::format(", `{}`", limit.port), limit.cases,
                            limit.times, limit.reason);
    }
    return text;
}

} // namespace kestrel
