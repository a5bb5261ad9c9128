#include "measure/run_stats.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace kestrel {

namespace {

using OutJson = nlohmann::ordered_json;

OutJson spreadJson(const Spread& spread) {
    return {{"median", spread.median}, {"min", spread.min}, {"max", spread.max}};
}

} // namespace

RunStats gatherStats(Renderer& renderer, const Profile& profile, const std::string& driver) {
    RunStats stats;
    stats.graph = renderer.graph().name;
    stats.scene = renderer.scene().name;
    stats.camera = renderer.cameraName();
    stats.size = renderer.options().size;
    stats.frames = profile.frameCount();
    stats.seed = renderer.options().seed;
    stats.renderer = renderer.capabilities().renderer;
    stats.driver = driver;
    stats.clock = renderer.executor().clockName();
    stats.spin = measureSpin();
    stats.passes = profile.passes();
    stats.groups = profile.groups();
    stats.frameMs = profile.frame();
    stats.leftOut = renderer.plan().leftOut;
    stats.memory = renderer.plan().memory;
    for (const PlanResource& resource : renderer.plan().resources)
        stats.resources.emplace_back(resource.port.text(), resource.desc.totalBytes());
    stats.previewsMs = profile.previews();
    stats.previews = renderer.plan().previews;
    stats.values = renderer.last().values;
    return stats;
}

std::string statsJson(const RunStats& stats) {
    OutJson passes = OutJson::array();
    for (const Profile::PassTime& pass : stats.passes)
        passes.push_back(
            {{"name", pass.name}, {"type", pass.type}, {"runs", pass.runs}, {"ms", spreadJson(pass.ms)}});
    OutJson groups = OutJson::object();
    for (const auto& [group, spread] : stats.groups) groups[group] = spreadJson(spread);
    OutJson leftOut = OutJson::array();
    for (const LeftOut& item : stats.leftOut) leftOut.push_back({{"what", item.what}, {"why", item.why}});
    OutJson resources = OutJson::array();
    for (const auto& [port, bytes] : stats.resources) resources.push_back({{"port", port}, {"bytes", bytes}});
    OutJson json = {
        {"graph", stats.graph},
        {"graph_path", stats.graphPath},
        {"scene", stats.scene},
        {"scene_path", stats.scenePath},
        {"camera", stats.camera},
        {"size", {stats.size.width, stats.size.height}},
        {"frames", stats.frames},
        {"seed", stats.seed},
        {"renderer", stats.renderer},
        {"driver", stats.driver},
        {"clock", stats.clock},
        {"spin", {{"one_thread_ms", stats.spin.oneThreadMs}, {"two_threads_ms", stats.spin.twoThreadsMs}}},
        {"passes", passes},
        {"groups", groups},
        {"frame_ms", spreadJson(stats.frameMs)},
        {"left_out", leftOut},
        {"memory",
         {{"transient", stats.memory.transient},
          {"unshared", stats.memory.unshared},
          {"persistent", stats.memory.persistent}}},
        {"resources", resources},
        {"previews",
         {{"ms", spreadJson(stats.previewsMs)},
          {"memory", stats.previews.memory},
          {"altered_steps", stats.previews.altered}}},
        {"values", stats.values},
    };
    return json.dump(2, ' ', false, OutJson::error_handler_t::replace) + "\n";
}

} // namespace kestrel
