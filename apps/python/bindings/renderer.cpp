// A graph on a scene, frame after frame, on the thread of gpu.h.
#include "bindings.h"
#include "core/log.h"
#include "gpu.h"
#include "graph/report.h"
#include "measure/run_stats.h"
#include "named.h"
#include <fmt/format.h>
#include <map>
#include <memory>
#include <optional>
#include <pybind11/stl.h>

namespace kestrel::python {
namespace {

constexpr double maxTime = 1e6; // seconds, as for --time

void requireWithin(const char* name, const std::optional<double>& value, double least, double most) {
    if (value && !(*value >= least && *value <= most))
        throw InputError(fmt::format("{}: it must be {} to {}, not {}", name, least, most, *value));
}

std::vector<PortRef> portsOf(const py::handle& texts) {
    std::vector<PortRef> ports;
    for (const std::string& text : texts.cast<std::vector<std::string>>()) ports.push_back(portOf(text));
    return ports;
}

// What kestrel/renderer.py gives beside the document, already as texts where --camera and --light are.
struct Settings {
    std::string scene, camera, animation;
    std::vector<std::string> lights;
    std::optional<double> time, fps;
    bool allowOutside = false;
    RenderOptions options;
};

// Throws InputError with everything that is of the wrong kind or out of range.
Settings settingsOf(const py::dict& given) {
    Settings settings;
    std::vector<Problem> problems;
    const auto noting = [&](const char* key, auto&& what) {
        try {
            what();
        } catch (const py::cast_error&) {
            problems.push_back(
                {{}, fmt::format("{}: it can't be {}", key, std::string(py::repr(given[key])))});
        } catch (const InputError& error) {
            problems.insert(problems.end(), error.problems().begin(), error.problems().end());
        }
    };
    const auto take = [&](const char* key, auto& into) {
        noting(key, [&] { into = given[key].cast<std::remove_reference_t<decltype(into)>>(); });
    };
    const auto takeWithin = [&](const char* key, std::optional<double>& into, double least, double most) {
        take(key, into);
        noting(key, [&] { requireWithin(key, into, least, most); });
    };
    take("scene", settings.scene);
    take("camera", settings.camera);
    take("animation", settings.animation);
    take("lights", settings.lights);
    takeWithin("time", settings.time, 0, maxTime);
    takeWithin("fps", settings.fps, 1e-6, 1e6);
    take("allow_outside", settings.allowOutside);
    noting("size", [&] { settings.options.size = extentOf(given["size"].cast<std::vector<int>>()); });
    take("seed", settings.options.seed);
    takeWithin("time_step", settings.options.timeStep, 0, 1e9);
    take("timing", settings.options.timing);
    take("check_finite", settings.options.checkFinite);
    take("keep_all", settings.options.keepAll);
    noting("previews", [&] { settings.options.previews = portsOf(given["previews"]); });
    settings.options.finishFrames = true; // FrameRecord::ms is true
    if (!problems.empty()) throw InputError(std::move(problems));
    return settings;
}

// The graph's own setup of the scene and the caller's; with everything that is wrong with either, and with
// the graph.
Graph setUp(Graph graph, const Settings& settings) {
    std::vector<Problem> problems;
    const auto noting = [&](auto&& parse) {
        try {
            parse();
        } catch (const InputError& error) {
            problems.insert(problems.end(), error.problems().begin(), error.problems().end());
        }
    };
    SceneSetup setup;
    if (describesCamera(settings.camera))
        noting([&] { setup.camera = parseCamera(settings.camera, "camera"); });
    else
        setup.cameraName = settings.camera;
    for (const std::string& light : settings.lights)
        noting([&] { setup.lights.push_back(parseLight(light, "light " + light)); });
    setup.animation = settings.animation;
    setup.time = settings.time;
    setup.fps = settings.fps;
    noting([&] {
        graph.sceneSetup = joined(located(std::move(graph.sceneSetup), graph.file.parent_path()),
                                  located(std::move(setup), std::filesystem::current_path()));
    });
    for (Problem& problem : validate(graph, loadedRegistry())) problems.push_back(std::move(problem));
    if (settings.scene.empty() && graph.sceneSource.empty())
        problems.push_back({Location{graph.file.string()}, "the graph names no scene: give one"});
    if (!problems.empty()) throw InputError(std::move(problems));
    return graph;
}

// Lives on the thread of the context from its making to its end; its owner is PyRenderer.
struct Held : Gpu::Guest {
    std::unique_ptr<Renderer> renderer;
    Profile profile;
    void leave() override { renderer.reset(); }
};

class PyRenderer {
public:
    PyRenderer(const Document& document, const py::dict& given)
        : progress_(given["progress"])
        , held_(std::make_shared<Held>()) {
        Settings settings = settingsOf(given);
        if (!given["progress"].is_none())
            settings.options.progress = [this](const std::string& what, double fraction) {
                progress_(fraction, what);
            };
        Graph graph = document.graph;
        try {
            Gpu::get().run([&, held = held_](Gpu& gpu) { begin(gpu, *held, std::move(graph), settings); });
        } catch (...) {
            leave();
            throw;
        }
    }
    ~PyRenderer() { leave(); }
    PyRenderer(const PyRenderer&) = delete;
    PyRenderer& operator=(const PyRenderer&) = delete;

    void setGraph(const Document& document) {
        Graph graph = document.graph;
        with([&](Renderer& renderer) {
            graph.sceneSetup = renderer.graph().sceneSetup;
            renderer.setGraph(std::move(graph));
        });
    }

    py::dict frame() {
        FrameRecord record;
        with([&](Renderer& renderer) {
            record = renderer.frame();
            held_->profile.add(record);
        });
        progress_.rethrow();
        py::list steps;
        for (const StepSample& sample : record.samples) {
            py::dict step;
            step["pass"] = sample.pass;
            step["step"] = sample.step;
            step["group"] = sample.group;
            step["ms"] = sample.ms;
            steps.append(step);
        }
        py::dict result;
        result["index"] = record.index;
        result["ms"] = record.ms;
        result["steps"] = steps;
        result["values"] = py::cast(record.values);
        return result;
    }

    py::array read(const std::string& text, std::optional<int> layer, int mip) {
        const PortRef port = portOf(text);
        std::vector<Image> images;
        std::vector<std::byte> bytes;
        with([&](Renderer& renderer) {
            const Desc& desc = renderer.desc(port);
            if (desc.kind == ResourceKind::Buffer) {
                bytes = renderer.readBytes(port);
                return;
            }
            if (mip < 0 || mip >= desc.mips)
                throw InputError(fmt::format("{} has {} levels, and no level {}", text, desc.mips, mip));
            const int layers = desc.layers(mip);
            if (layer && (*layer < 0 || *layer >= layers))
                throw InputError(fmt::format("{} has {} layers, and no layer {}", text, layers, *layer));
            for (int i = layer.value_or(0); i < (layer ? *layer + 1 : layers); ++i)
                images.push_back(renderer.read(port, i, mip));
        });
        if (images.empty()) return toArray(std::move(bytes));
        if (images.size() == 1) return toArray(std::move(images.front()));
        py::list layers;
        for (Image& image : images) layers.append(toArray(std::move(image)));
        return py::module_::import("numpy").attr("stack")(layers);
    }

    void set(const std::function<void(Renderer&)>& change) { with(change); }

    std::string plan() {
        std::string text;
        with([&](Renderer& renderer) { text = planJson(renderer.plan()); });
        return text;
    }
    std::string stats() {
        std::string text;
        Gpu::get().run([&, held = held_](Gpu& gpu) {
            text = statsJson(gatherStats(*held->renderer, held->profile, gpu.context().driver()));
        });
        return text;
    }
    std::vector<std::string> outputs() {
        std::vector<std::string> ports;
        with([&](Renderer& renderer) {
            for (const PlanOutput& output : renderer.plan().outputs)
                if (output.resource >= 0) ports.push_back(output.port.text());
        });
        return ports;
    }

private:
    static void begin(Gpu& gpu, Held& held, Graph graph, const Settings& settings) {
        graph = setUp(std::move(graph), settings);
        const bool own = settings.scene.empty();
        Scene scene = loadScene(own ? graph.sceneSource : settings.scene,
                                own ? graph.file.parent_path() : std::filesystem::path(),
                                {.allowOutside = settings.allowOutside}, graph.sceneSetup);
        for (const std::string& warning : scene.warnings) logWarning("{}: {}", scene.name, warning);
        held.renderer = std::make_unique<Renderer>(std::move(graph), loadedRegistry(), std::move(scene),
                                                   gpu.context().capabilities(), settings.options);
        gpu.guests.insert(&held);
    }
    // The scene and its memory go when the thread comes to it; where it does not come any more, there is
    // nothing left, or it is another process's.
    void leave() {
        const bool done = Gpu::post([held = held_](Gpu& gpu) {
            gpu.guests.erase(held.get());
            held->renderer.reset();
        });
        if (!done) static_cast<void>(new std::shared_ptr<Held>(held_));
    }
    void with(const std::function<void(Renderer&)>& what) {
        Gpu::get().run([&, held = held_](Gpu&) { what(*held->renderer); });
    }

    Callback progress_;
    std::shared_ptr<Held> held_;
};

} // namespace

void bindRenderer(py::module_& module) {
    using R = PyRenderer;
    py::class_<R>(module, "Renderer")
        .def(py::init<const Document&, const py::dict&>())
        .def("set_graph", &R::setGraph)
        .def("frame", &R::frame)
        .def("read", &R::read)
        .def("plan", &R::plan)
        .def("stats", &R::stats)
        .def("outputs", &R::outputs)
        .def("restart", [](R& self) { self.set([](Renderer& renderer) { renderer.restart(); }); })
        .def("set_time",
             [](R& self, double time) {
                 requireWithin("time", time, 0, maxTime);
                 self.set([&](Renderer& renderer) { renderer.setTime(time); });
             })
        .def("set_size",
             [](R& self, const std::vector<int>& size) {
                 const Extent extent = extentOf(size);
                 self.set([&](Renderer& renderer) { renderer.setSize(extent); });
             })
        .def("set_previews", [](R& self, const py::list& ports) {
            const std::vector<PortRef> previews = portsOf(ports);
            self.set([&](Renderer& renderer) { renderer.setPreviews(previews); });
        });
}

} // namespace kestrel::python
