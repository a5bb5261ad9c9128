#include "measure/stress/stress_results.h"
#include "core/files.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace kestrel {
namespace {

using ResultJson = nlohmann::ordered_json;

constexpr std::array<std::string_view, 7> outcomeNames = {"held",    "missed",  "crashed", "hung",
                                                          "refused", "lacking", "unfit"};

ResultJson checkJson(const StressCheck& check) {
    ResultJson json = {{"port", check.port}, {"expects", check.expects}, {"held", check.held}};
    // JSON has no infinity.
    json["missed"] = std::isfinite(check.missed) ? ResultJson(check.missed) : ResultJson(nullptr);
    if (check.x >= 0) json["pixel"] = {check.x, check.y};
    if (!check.what.empty()) json["what"] = check.what;
    if (!check.picture.empty()) json["picture"] = check.picture;
    if (!check.limit.empty()) json["limit"] = check.limit;
    return json;
}

ResultJson resultJson(const StressResult& result) {
    ResultJson checks = ResultJson::array();
    for (const StressCheck& check : result.checks) checks.push_back(checkJson(check));
    ResultJson json = {{"name", result.name}};
    for (const StressCase& one : stressCases())
        if (one.name == result.name) {
            json["kind"] = stressKindName(one.kind);
            json["does"] = one.does;
        }
    json["outcome"] = stressOutcomeName(result.outcome);
    if (!result.why.empty()) json["why"] = result.why;
    if (!result.where.empty()) json["where"] = result.where;
    json["ms"] = result.ms;
    json["checks"] = checks;
    json["command"] = result.command;
    return json;
}

std::string dumped(const ResultJson& json, int indent) {
    return json.dump(indent, ' ', false, ResultJson::error_handler_t::replace);
}

std::string textOf(const Json& json, const char* key) {
    const Json* value = json.find(key);
    return value != nullptr && value->kind == Json::Kind::String ? value->text : std::string();
}

StressCheck checkOf(const Json& json) {
    StressCheck check;
    check.port = textOf(json, "port");
    check.expects = textOf(json, "expects");
    const Json* held = json.find("held");
    check.held = held != nullptr && held->boolean;
    const Json* missed = json.find("missed");
    check.missed =
        missed != nullptr && missed->isNumber() ? missed->number : std::numeric_limits<double>::infinity();
    if (const Json* pixel = json.find("pixel"); pixel != nullptr && pixel->items.size() == 2) {
        check.x = static_cast<int>(pixel->items[0].integer);
        check.y = static_cast<int>(pixel->items[1].integer);
    }
    check.what = textOf(json, "what");
    check.picture = textOf(json, "picture");
    check.limit = textOf(json, "limit");
    return check;
}

} // namespace

std::string_view stressOutcomeName(StressOutcome outcome) {
    return outcomeNames.at(static_cast<size_t>(outcome));
}

bool isBad(StressOutcome outcome) {
    return outcome != StressOutcome::Held && outcome != StressOutcome::Lacking &&
           outcome != StressOutcome::Unfit;
}

std::string stressResultText(const StressResult& result) { return dumped(resultJson(result), -1); }

StressResult stressResultOf(const Json& json) {
    StressResult result;
    result.name = textOf(json, "name");
    const auto outcome = std::ranges::find(outcomeNames, std::string_view(textOf(json, "outcome")));
    if (result.name.empty() || outcome == outcomeNames.end())
        throw InputError(json.where, "is no result of a stress case");
    result.outcome = static_cast<StressOutcome>(outcome - outcomeNames.begin());
    result.why = textOf(json, "why");
    result.where = textOf(json, "where");
    if (const Json* ms = json.find("ms"); ms != nullptr) result.ms = ms->number;
    if (const Json* checks = json.find("checks"); checks != nullptr)
        for (const Json& check : checks->items) result.checks.push_back(checkOf(check));
    result.command = textOf(json, "command");
    return result;
}

std::string stressJson(const StressRunInfo& info, const std::vector<StressResult>& results) {
    ResultJson cases = ResultJson::array();
    for (const StressResult& result : results) cases.push_back(resultJson(result));
    const ResultJson json = {{"kestrel_stress", 1}, {"graph", info.graph}, {"scene", info.scene},
                             {"size", info.size},   {"hash", info.hash},   {"renderer", info.renderer},
                             {"cases", cases}};
    return dumped(json, 1) + "\n";
}

std::vector<StressResult> readStressResults(const std::filesystem::path& file, const StressRunInfo& info) {
    const Json json = Json::parse(readText(file), file.string());
    const Json* cases = json.find("cases");
    if (json.find("kestrel_stress") == nullptr || cases == nullptr)
        throw InputError(Location{file.string()}, "holds no results of a stress run");
    if (textOf(json, "hash") != info.hash)
        throw InputError(
            Location{file.string()},
            fmt::format("holds results of another run ({} on {}, {}): graph, settings, scene, size or "
                        "Kestrel's version differ; name another file or remove this one",
                        textOf(json, "graph"), textOf(json, "scene"), textOf(json, "size")));
    std::vector<StressResult> results;
    for (const Json& one : cases->items) results.push_back(stressResultOf(one));
    return results;
}

std::string stressText(const StressResult& result) {
    const std::string begin = fmt::format("{}: {}", result.name, stressOutcomeName(result.outcome));
    std::string text;
    if (!result.why.empty())
        text += fmt::format("{}: {}{}\n", begin, result.why,
                            result.where.empty() ? "" : fmt::format(", in {}", result.where));
    for (const StressCheck& check : result.checks) {
        if (check.held) continue;
        text += fmt::format("{}: {}\n", begin, check.what);
    }
    if (!text.empty()) text += fmt::format("    {}\n", result.command);
    return text;
}

} // namespace kestrel
