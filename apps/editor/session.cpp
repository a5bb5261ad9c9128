#include "session.h"
#include "scene/setup.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel::edit {

Session::Session(const Registry& registry, const Capabilities& capabilities, std::string driver, Graph graph,
                 SessionOptions options)
    : document(std::move(graph))
    , registry_(registry)
    , capabilities_(capabilities)
    , driver_(std::move(driver))
    , options_(std::move(options)) {}

Session::~Session() = default;

void Session::fail(const std::vector<Problem>& problems) {
    problems_ = mark(located_, problems);
    stuck_ = true;
}

std::string Session::apply(const std::string& name, const std::function<void(Graph&)>& change,
                           std::uint64_t gesture) {
    try {
        document.apply(
            name,
            [&](Graph& graph) {
                change(graph);
                keepPlaces(graph, places);
            },
            gesture);
        return {};
    } catch (const Error& error) {
        return error.problems().front().message;
    }
}

void Session::follow() {
    if (taken_ == document.revision() && takenShown_ == shown && takenApart_ == apart) return;
    // Another port to look at changes no picture, but asks for a frame that makes it.
    const bool other = taken_ != document.revision();
    taken_ = document.revision();
    takenShown_ = shown;
    takenApart_ = apart;
    problems_.clear();
    stuck_ = false;
    try {
        located_ = locatedGraph(document.graph(), document.text());
        take();
        due_ = true;
        if (other) touch();
        profile_ = {};
    } catch (const Error& error) {
        fail(error.problems());
    }
}

void Session::take() {
    // Everything that is wrong at once, before a scene is loaded for nothing.
    if (std::vector<Problem> wrong = validate(located_, registry_); !wrong.empty())
        throw InputError(std::move(wrong));
    const std::string source = options_.scene.empty() ? located_.sceneSource : options_.scene;
    const std::filesystem::path folder = options_.scene.empty() ? located_.file.parent_path() : "";
    const std::string key = source + "\n" + folder.string() + "\n" + setupText(located_.sceneSetup);
    // What is looked at keeps its memory to itself: so does what is to share it with nobody.
    std::vector<PortRef> previews;
    for (const std::vector<PortRef>* ports : {&shown, &apart})
        for (const PortRef& port : *ports)
            if (const GraphPass* pass = located_.find(port.pass))
                if (const PassType* type = registry_.find(pass->type);
                    type != nullptr && type->port(port.port) != nullptr &&
                    !isModule(type->port(port.port)->kind) && // nothing to see: read() says so
                    std::find(previews.begin(), previews.end(), port) == previews.end())
                    previews.push_back(port);
    if (renderer_ == nullptr || key != sceneKey_) {
        if (source.empty()) throw InputError("the graph names no scene: open one, or choose a built-in one");
        Scene scene = loadScene(source, folder, options_.sceneOptions,
                                located(located_.sceneSetup, located_.file.parent_path()));
        if (renderer_ == nullptr) {
            RenderOptions render;
            render.size = options_.size;
            render.timing = options_.timing;
            render.finishFrames = true;
            render.previews = previews;
            renderer_ =
                std::make_unique<Renderer>(located_, registry_, std::move(scene), capabilities_, render);
        } else {
            renderer_->setScene(std::move(scene));
        }
        renderer_->setPaused(!timeRuns_);
        sceneKey_ = key;
        ownCamera_.reset(); // of the scene before
        cameraName_.clear();
    }
    // Ports of the graph before may be gone: they go first, and new ones come after it.
    std::vector<PortRef> both;
    for (const PortRef& port : renderer_->options().previews)
        if (std::find(previews.begin(), previews.end(), port) != previews.end()) both.push_back(port);
    renderer_->setPreviews(both);
    renderer_->setGraph(located_);
    renderer_->setPreviews(previews);
}

void Session::touch() {
    due_ = true;
    settled_ = 0;
}

bool Session::frame() {
    try {
        profile_.add(renderer_->frame());
    } catch (const Error& error) {
        fail(error.problems());
        return false;
    }
    due_ = false;
    ++frames_;
    ++settled_;
    return true;
}

bool Session::render() {
    if (renderer_ == nullptr || stuck_ || (!playing && !due_)) return false;
    return frame();
}

void Session::beginAgain() {
    if (renderer_ == nullptr) return;
    const double at = time();
    renderer_->restart();
    renderer_->setTime(at);
    touch();
}

bool Session::renderAgain(const std::function<bool()>& enough) {
    if (renderer_ == nullptr || stuck_) return false;
    const std::uint64_t count = std::max<std::uint64_t>(settled_, 1);
    setTimeRuns(false);
    beginAgain();
    for (std::uint64_t i = 0; i < count; ++i) {
        if (!frame()) return false;
        if (enough && enough()) break;
    }
    return true;
}

bool Session::reloadFiles() {
    if (renderer_ == nullptr) return false;
    try {
        if (!renderer_->reloadIfChanged()) return false;
        if (stuck_) taken_ = 0; // what was wrong may be right now, or be wrong still
        problems_.clear();
        stuck_ = false;
        touch();
        return true;
    } catch (const Error& error) {
        fail(error.problems());
        return true;
    }
}

void Session::setSize(Extent size) {
    if (options_.size == size) return;
    const Extent before = options_.size;
    options_.size = size;
    try {
        if (renderer_ != nullptr) renderer_->setSize(size);
        touch();
        profile_ = {};
    } catch (const Error& error) {
        options_.size = before;
        problems_ = mark(located_, error.problems());
    }
}

void Session::setScene(const std::string& scene) {
    if (options_.scene == scene) return;
    options_.scene = scene;
    taken_ = 0;
}

void Session::restart() {
    if (renderer_ != nullptr) renderer_->restart();
    touch();
    profile_ = {};
}

Image Session::read(const PortRef& port, std::string& whyNot) {
    whyNot.clear();
    if (renderer_ == nullptr || frames_ == 0) {
        whyNot = "nothing is rendered yet";
        return {};
    }
    try {
        return renderer_->read(port);
    } catch (const Error& error) {
        whyNot = error.problems().front().message;
        return {};
    }
}

std::string Session::leftOut(const std::string& pass) const {
    if (renderer_ == nullptr) return {};
    for (const LeftOut& item : renderer_->plan().leftOut)
        if (item.what == pass) return item.why;
    return {};
}

} // namespace kestrel::edit
