// The editor: panels, actions, files. One a window.
#pragma once
#include "canvas/canvas.h"
#include "edit/files.h"
#include "edit/plugins.h"
#include "output_files.h"
#include "panels/numbers.h"
#include "panels/properties.h"
#include "panels/viewport.h"
#include "session.h"
#include "ui/actions.h"
#include "ui/theme.h"
#include <deque>
#include <optional>
#include <string>

namespace kestrel::edit {

class Editor {
public:
    Editor(Session& session, Theme& theme, std::filesystem::path state = stateFolder());

    // One frame: what the keys ask, the session's frame, all panels.
    void show(const KeyEvents& keys);
    // Whether anything changes by itself: otherwise the window waits for events.
    [[nodiscard]] bool busy() const;
    // Between frames, where nobody did anything: looks at the disk. Whether there is nothing new to draw.
    [[nodiscard]] bool rests();
    [[nodiscard]] bool done() const { return done_; }
    void askToClose(); // the window's cross: with a question where work would be lost
    // A graph, a picture that becomes a pass, or a scene for the graph that is open.
    void open(const std::filesystem::path& file);
    [[nodiscard]] std::string title() const;

    int stopAfter = 64;         // frames after the last change; 0: never
    Plugins* plugins = nullptr; // that are loaded anew when they change; none: they are not watched

    // For tests.
    Canvas canvas;
    Viewport viewport;
    [[nodiscard]] Actions& actions() { return actions_; }
    [[nodiscard]] const std::deque<std::string>& messages() const { return messages_; }
    [[nodiscard]] const Palette& palette() const { return palette_; }
    [[nodiscard]] bool asks() const { return asked_ || !question_.empty(); }
    [[nodiscard]] const Properties& properties() const { return properties_; }
    void say(const std::string& message);

private:
    // editor_actions.cpp, editor_capture.cpp, editor_camera.cpp, editor_lists.cpp
    void addFileActions();
    void addEditActions();
    void addViewActions();
    void addPassActions();
    void addCaptureActions();
    void addCameraActions();
    void openPalette();
    void findPass();
    void addPassByName(std::optional<Canvas::Dropped> joined);
    void swap();
    void browse(const std::filesystem::path& folder);
    void showPort();
    void toggleOutput();
    void connectByName();
    void disconnectByName();
    void withPort(const std::string& prompt, const std::function<void(const PortRef&)>& then);
    void askPixel();
    void nudge(glm::dvec2 by);
    void rename();
    void paste();
    void copy(bool keepInputs);
    void chooseCamera();
    void screenshot(const std::string& file);
    void copyCommandLine();
    void startSequence(const std::string& typed);
    void record();
    void writeStats(const std::string& file);

    // editor.cpp, editor_popups.cpp, editor_files.cpp
    void follow();
    void lookAtDisk();
    void layOut();
    void showRight(float width, float height);
    void showTabs();
    void showProblems();
    void showStatus();
    void showPopups();
    void showAsked();
    void showContextMenu();
    void ask(std::string prompt, std::string typed, std::function<void(const std::string&)> then);
    void save(const std::filesystem::path& file);
    void guard(const std::string& question, std::function<void()> then); // asks where work is not saved
    void openNow(const std::filesystem::path& file);
    void takeFile(const std::filesystem::path& file);
    void addImage(const std::filesystem::path& file);
    [[nodiscard]] std::string selectedPass() const;

    Session& session_;
    Theme& theme_;
    Actions actions_;
    Palette palette_;
    Properties properties_;
    Numbers numbers_;
    Autosave autosave_;
    Watched watched_;
    Recent recent_;
    std::deque<std::string> messages_;
    float split_ = 0.55f, rows_ = 0.6f; // shares of the window: canvas, viewport
    bool done_ = false, shortcuts_ = false, themeChanged_ = false;
    std::string typed_; // in the popup that is open
    struct Asked {
        std::string prompt;
        std::function<void(const std::string&)> then;
    };
    std::optional<Asked> asked_;
    bool askFresh_ = false;
    struct Recording {
        OutputFile output;
        int left = 0;
        std::uint64_t made = 0;
    };
    std::optional<Recording> recording_;
    std::string question_;
    std::function<void()> afterQuestion_;
    std::optional<Graph> changedOnDisk_;
    std::uint64_t told_ = 0; // messages in all
    double lastAutosave_ = 0, lastLook_ = 0;

public:
    // The theme's scale or colours changed: fonts are baked anew between frames.
    [[nodiscard]] bool takeThemeChange() { return std::exchange(themeChanged_, false); }
};

} // namespace kestrel::edit
