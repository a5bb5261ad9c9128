// How a session's scene is looked at, and the command line that does the same.
#include "edit/camera.h"
#include "session.h"
#include <cmath>
#include <fmt/format.h>

namespace kestrel::edit {
namespace {

// A word of a command line, for a shell.
std::string quoted(const std::string& text) {
    if (!text.empty() &&
        text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                               "_-./:,=%+@") == std::string::npos)
        return text;
    std::string inside;
    for (const char letter : text) inside += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
    return "'" + inside + "'";
}

} // namespace

// ---- camera

void Session::setCamera(const std::string& name) {
    if (renderer_ == nullptr) return;
    if (name.empty())
        renderer_->setCamera(
            renderer_->scene().cameras.at(static_cast<size_t>(renderer_->scene().camera)).name);
    else
        renderer_->setCamera(name);
    cameraName_ = name;
    ownCamera_.reset();
    touch();
}

void Session::setOwnCamera(const AddedCamera& camera) {
    if (renderer_ == nullptr) return;
    renderer_->setFreeCamera(stateOf(camera, renderer_->scene()));
    ownCamera_ = camera;
    touch();
}

std::string Session::cameraName() const {
    return ownCamera_ ? "own" : renderer_ != nullptr ? renderer_->cameraName() : "";
}

std::optional<AddedCamera> Session::movableCamera() const {
    if (ownCamera_ || renderer_ == nullptr) return ownCamera_;
    const Scene& scene = renderer_->scene();
    return cameraFrom(cameraAt(scene, cameraIndex(scene, renderer_->cameraName()), time()), scene);
}

// ---- time

double Session::duration() const {
    if (renderer_ == nullptr) return 0;
    const SceneFacts& facts = renderer_->facts();
    return facts.geometryMoves || facts.cameraMoves || facts.lightsMove ? double(facts.duration) : 0;
}

double Session::time() const { return renderer_ != nullptr ? renderer_->time() : 0; }

double Session::timeStep() const { return renderer_ != nullptr ? renderer_->timeStep() : 0; }

void Session::setTimeRuns(bool runs) {
    timeRuns_ = runs;
    if (renderer_ != nullptr) renderer_->setPaused(!runs);
}

void Session::setTime(double seconds) {
    if (duration() <= 0) return;
    seconds = std::fmod(seconds, duration());
    if (seconds < 0) seconds += duration();
    renderer_->setTime(seconds);
    touch();
}

void Session::setTimeStep(std::optional<double> seconds) {
    if (renderer_ != nullptr) renderer_->setTimeStep(seconds);
}

// ---- the same without a window

std::string Session::commandLine(const PortRef& port, const std::filesystem::path& file, int sequence) const {
    std::string text = "kestrel render " + quoted(document.graph().file.string());
    if (!options_.scene.empty()) text += " --scene " + quoted(options_.scene);
    text += fmt::format(" --size {}x{}", options_.size.width, options_.size.height);
    if (ownCamera_)
        text += " --camera " + quoted(cameraOption(*ownCamera_));
    else if (!cameraName_.empty())
        text += " --camera " + quoted(cameraName_);
    if (duration() > 0)
        text += fmt::format(" --time {}", time()) +
                (sequence > 0 ? fmt::format(" --time-step {}", timeStep()) : " --still");
    text += fmt::format(" --frames {}", sequence > 0 ? static_cast<std::uint64_t>(sequence)
                                                     : std::max<std::uint64_t>(settled_, 1));
    return text + " --output " + quoted(port.text() + "=" + file.string());
}

} // namespace kestrel::edit
