// What leaving out changes, and what it saves: a graph on a scene rendered with what the scene needs alone,
// and with everything kept.
#pragma once
#include "core/error.h"
#include "execute/renderer.h"
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace kestrel::test {

// Where programs are others (with everything kept the G-buffer's has more outputs) the driver may order its
// arithmetic otherwise, and a ray near an edge may fall to the other side: a pixel differs by a sample then,
// which in linear light is as much as the brightest pixel. So: few pixels (those that differ by more than a
// thousandth of the brightest), and little on the whole (root mean square, of the brightest).
inline constexpr double leavingOutPixels = 0.005, leavingOutRms = 0.002;

struct LeavingOut {
    std::vector<std::string>
        mistakes;               // with the first pass that is wrong; empty: nothing that is seen changes
    int equal = 0, close = 0;   // outputs that must be equal to the bit, and those within the tolerances
    double pixels = 0, rms = 0; // the largest that were seen
    std::uint64_t bytes = 0, bytesKept = 0; // held by the plans
    double ms = 0, msKept = 0;              // of the steps of all frames but the first
};

namespace leaving_out {

// A picture, or a buffer as numbers of 32 bits.
inline Image read(Renderer& renderer, const PortRef& port) {
    if (renderer.desc(port).kind == ResourceKind::Texture2D) return renderer.read(port);
    const std::vector<std::byte> bytes = renderer.readBytes(port);
    Image image(static_cast<int>(bytes.size() / 4), 1, 1);
    for (size_t i = 0; i < image.values.size(); ++i) {
        std::array<std::byte, 4> word{};
        std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(4 * i), 4, word.begin());
        image.values[i] = std::bit_cast<float>(word);
    }
    return image;
}

struct Apart {
    bool sameSize = true, equal = true;
    double pixels = 0, rms = 0;
};

// Values of the same bits, infinities of rays that meet nothing among them, do not differ; what is a number
// in one picture alone does by as much as can be.
inline Apart apart(const Image& a, const Image& b) {
    Apart result;
    result.sameSize = a.sameSize(b) && a.channels == b.channels;
    if (!result.sameSize) return result;
    double brightest = 1, squares = 0;
    for (const float value : a.values)
        if (std::isfinite(value)) brightest = std::max(brightest, std::abs(double{value}));
    std::set<size_t> off;
    for (size_t i = 0; i < a.values.size(); ++i) {
        if (std::bit_cast<std::uint32_t>(a.values[i]) == std::bit_cast<std::uint32_t>(b.values[i])) continue;
        const double d = std::abs(double{a.values[i]} - double{b.values[i]});
        const double seen = std::isfinite(d) ? d : brightest;
        result.equal = result.equal && seen == 0; // 0 and -0 are one value
        if (seen > 1e-3 * brightest) off.insert(i / static_cast<size_t>(a.channels));
        squares += seen * seen;
    }
    result.pixels =
        static_cast<double>(off.size()) / static_cast<double>(std::max<size_t>(1, a.pixelCount()));
    result.rms = std::sqrt(squares / static_cast<double>(std::max<size_t>(1, a.values.size()))) / brightest;
    return result;
}

inline bool isClose(const Apart& apart, const Image& image) {
    const double least =
        2 / static_cast<double>(std::max<size_t>(1, image.pixelCount())); // in a small picture
    return apart.sameSize && apart.pixels <= std::max(leavingOutPixels, least) && apart.rms <= leavingOutRms;
}

inline std::string partsOf(const ProgramRequest& request) {
    std::string text;
    for (const std::string& file : request.files) text += file + " ";
    for (const auto& [name, value] : request.defines) text += name + "=" + value + " ";
    const auto add = [&](const auto& self, const std::map<std::string, ModuleInstance>& modules) -> void {
        for (const auto& [port, module] : modules) {
            text += "{" + port + " " + module.file + " ";
            for (const auto& [name, value] : module.defines) text += name + "=" + value + " ";
            self(self, module.modules);
            text += "}";
        }
    };
    add(add, request.modules);
    return text;
}

// The programs of a pass and of all passes behind it, by "pass.step".
inline void programsBehind(const Plan& plan, int pass, std::map<std::string, std::string>& programs,
                           std::set<int>& seen) {
    if (!seen.insert(pass).second) return;
    const PlanPass& here = plan.passes[static_cast<size_t>(pass)];
    for (int i = here.firstStep; i < here.firstStep + here.stepCount; ++i) {
        const PlanStep& step = plan.steps[static_cast<size_t>(i)];
        programs[here.name + "." + step.step.name] =
            step.program < 0 ? "" : partsOf(plan.programs[static_cast<size_t>(step.program)]);
    }
    for (const int input : here.inputs) programsBehind(plan, input, programs, seen);
    for (const auto& [port, passes] : here.inputPasses)
        for (const int input : passes) programsBehind(plan, input, programs, seen);
}

inline std::map<std::string, std::string> programsBehind(const Plan& plan, const std::string& pass) {
    std::map<std::string, std::string> programs;
    std::set<int> seen;
    for (size_t i = 0; i < plan.passes.size(); ++i)
        if (plan.passes[i].name == pass) programsBehind(plan, static_cast<int>(i), programs, seen);
    return programs;
}

// Of the passes in the order in which they run the first that makes something else with everything kept.
// Every picture is asked for then, of both.
inline std::string culprit(const Graph& graph, const Registry& registry, const Scene& scene,
                           const Capabilities& capabilities, RenderOptions options, int frames) {
    for (const GraphPass& pass : graph.passes)
        if (const PassType* type = registry.find(pass.type); type != nullptr)
            for (const PortInfo& port : type->ports)
                if (port.direction == PortDirection::Output && port.kind == PortKind::Texture)
                    options.previews.push_back({pass.name, port.name});
    options.timing = false;
    Renderer lean(graph, registry, scene, capabilities, options);
    options.keepAll = true;
    Renderer kept(graph, registry, scene, capabilities, options);
    for (int i = 0; i < frames; ++i) {
        lean.frame();
        kept.frame();
    }
    for (const PlanPass& pass : kept.plan().passes)
        for (const PortRef& port : options.previews) {
            if (port.pass != pass.name) continue;
            try {
                const Image a = read(lean, port), b = read(kept, port);
                if (!isClose(apart(a, b), a))
                    return fmt::format("pass '{}' ({}), port '{}', is the first that is not the same",
                                       pass.name, pass.type, port.port);
            } catch (const InputError&) { // one of the two does not make it
            }
        }
    return "no pass before it is wrong by itself";
}

} // namespace leaving_out

inline LeavingOut leavingOut(const Graph& graph, const Registry& registry, const Scene& scene,
                             const Capabilities& capabilities, const Extent& size, int frames = 3) {
    RenderOptions options;
    options.size = size;
    options.timing = true;
    Renderer lean(graph, registry, scene, capabilities, options);
    RenderOptions keeping = options;
    keeping.keepAll = true;
    Renderer kept(graph, registry, scene, capabilities, keeping);
    LeavingOut result;
    const auto msOf = [](const FrameRecord& frame) {
        double ms = 0;
        for (const StepSample& sample : frame.samples) ms += sample.ms;
        return ms;
    };
    for (int i = 0; i < frames; ++i) {
        const double ms = msOf(lean.frame()), msKept = msOf(kept.frame());
        if (i == 0) continue; // in it the driver makes programs
        result.ms += ms;
        result.msKept += msKept;
    }
    const auto held = [](const MemoryReport& memory) { return memory.transient + memory.persistent; };
    result.bytes = held(lean.plan().memory);
    result.bytesKept = held(kept.plan().memory);
    for (const GraphOutput& output : graph.outputs) {
        const PortRef& port = output.port;
        const bool exact = leaving_out::programsBehind(lean.plan(), port.pass) ==
                           leaving_out::programsBehind(kept.plan(), port.pass);
        const Image a = leaving_out::read(lean, port), b = leaving_out::read(kept, port);
        const leaving_out::Apart found = leaving_out::apart(a, b);
        ++(exact ? result.equal : result.close);
        result.pixels = std::max(result.pixels, found.pixels);
        result.rms = std::max(result.rms, found.rms);
        if (exact ? found.sameSize && found.equal : leaving_out::isClose(found, a)) continue;
        result.mistakes.push_back(fmt::format(
            "leaving out changes '{}'{}: {:.3g} % of the pixels, root mean square {:.3g}; {}", port.text(),
            exact ? ", whose programs are the same" : "", 100 * found.pixels, found.rms,
            leaving_out::culprit(graph, registry, scene, capabilities, options, frames)));
    }
    return result;
}

} // namespace kestrel::test
