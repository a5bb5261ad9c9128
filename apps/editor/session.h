// What the window works on: the document, and a renderer that follows it. Needs a current context, no window.
#pragma once
#include "edit/document.h"
#include "edit/layout.h"
#include "edit/problems.h"
#include "execute/renderer.h"
#include "measure/profile.h"
#include "scene/setup.h"
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace kestrel::edit {

struct SessionOptions {
    Extent size{640, 360, 1};
    std::string scene; // in place of the graph's; empty: the graph's
    SceneOptions sceneOptions = {};
    bool timing = true;
};

class Session {
public:
    Session(const Registry& registry, const Capabilities& capabilities, std::string driver, Graph graph,
            SessionOptions options);
    ~Session();

    Document document;
    // Ports that the viewports show; asked of the renderer as previews, so that they cost nothing when they
    // go.
    std::vector<PortRef> shown;
    Places places; // where the canvas draws passes without a position
    // A step of the document. What is refused is told: the sentence; empty if it was done.
    std::string apply(const std::string& name, const std::function<void(Graph&)>& change,
                      std::uint64_t gesture = 0);

    bool playing = true; // renders frame after frame; otherwise only what changed

    // Takes the document over if it changed: the scene where the graph names another one, then the graph.
    // What is wrong stands in problems() and the renderer stays at the last graph that was right.
    void follow();
    // The next frame, if there is a renderer and something to do: playing, or anything changed. True if it
    // rendered.
    bool render();
    // The picture that is seen, once more from the beginning: as many frames as were rendered since the last
    // change, since what is accumulated belongs to it, at the time where the scene stands, which no longer
    // runs. It is the one that commandLine() makes. Ends before where `enough` says so after a frame. False
    // where something is wrong.
    bool renderAgain(const std::function<bool()>& enough = {});
    // From the first frame: the scene's time goes on from where it stands, if it runs.
    void beginAgain();
    // Shaders and pictures that changed on the disk; true if something was compiled anew.
    bool reloadFiles();

    [[nodiscard]] const std::vector<Marked>& problems() const { return problems_; }
    [[nodiscard]] Renderer* renderer() const { return renderer_.get(); }
    [[nodiscard]] const Profile& profile() const { return profile_; } // since the last change
    [[nodiscard]] const std::string& driver() const { return driver_; }
    [[nodiscard]] const Registry& registry() const { return registry_; }
    [[nodiscard]] const Extent& size() const { return options_.size; }
    void setSize(Extent size);
    void setScene(const std::string& scene); // in place of the graph's; empty: the graph's
    void restart();                          // frame 0 again
    // Plugins came with other code: passes of their types are made anew.
    void takeTypes() { taken_ = 0; }

    // ---- how the scene is looked at; not the document's
    void setCamera(const std::string& name); // of the scene; empty: the graph's choice
    void setOwnCamera(const AddedCamera& camera);
    [[nodiscard]] const std::optional<AddedCamera>& ownCamera() const { return ownCamera_; }
    [[nodiscard]] std::string cameraName() const;
    // The own camera, else one that sees what is seen now; nothing without a renderer.
    [[nodiscard]] std::optional<AddedCamera> movableCamera() const;

    // ---- the scene's time, seconds
    [[nodiscard]] double duration() const; // 0: nothing moves
    [[nodiscard]] double time() const;
    [[nodiscard]] double timeStep() const;
    [[nodiscard]] bool timeRuns() const { return timeRuns_ && duration() > 0; }
    void setTimeRuns(bool runs);
    void setTime(double seconds);                    // jumps there; past an end it begins at the other
    void setTimeStep(std::optional<double> seconds); // absent: the scene's rate

    // ---- memory
    // Ports that share their memory with nobody, to see whether sharing is to blame.
    std::vector<PortRef> apart;
    // The content of a port in the frame that was rendered last; empty where it is not held, with the reason.
    [[nodiscard]] Image read(const PortRef& port, std::string& whyNot);
    // Why a pass, or a port of it, is not made; empty if it is.
    [[nodiscard]] std::string leftOut(const std::string& pass) const;
    // The command line that renders the same picture headless, to the bit after renderAgain(); of a document
    // that is saved. With `sequence` its first frames as files, the time running.
    [[nodiscard]] std::string commandLine(const PortRef& port, const std::filesystem::path& file,
                                          int sequence = 0) const;
    // Goes up with every frame rendered.
    [[nodiscard]] std::uint64_t frames() const { return frames_; }
    [[nodiscard]] bool due() const { return due_ && renderer_ != nullptr && !stuck_; } // something changed
    // Frames since the picture changed by anything but the next frame.
    [[nodiscard]] std::uint64_t settled() const { return settled_; }

private:
    void take();
    void touch(); // the picture is to be another
    bool frame();
    void fail(const std::vector<Problem>& problems);

    const Registry& registry_;
    Capabilities capabilities_;
    std::string driver_;
    SessionOptions options_;
    std::unique_ptr<Renderer> renderer_;
    std::string sceneKey_; // what the scene was loaded from
    Graph located_;
    std::vector<Marked> problems_;
    std::uint64_t taken_ = 0; // revision of the document that the renderer has, or that is wrong
    std::vector<PortRef> takenShown_, takenApart_;
    bool due_ = true, stuck_ = false, timeRuns_ = false;
    std::optional<AddedCamera> ownCamera_;
    std::string cameraName_; // that was chosen of the scene's
    Profile profile_;
    std::uint64_t frames_ = 0, settled_ = 0;
};

} // namespace kestrel::edit
