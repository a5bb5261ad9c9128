// The editor: panels, actions, files. One a window.
#pragma once
#include "canvas/canvas.h"
#include "edit/files.h"
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
    [[nodiscard]] bool done() const { return done_; }
    void askToClose(); // the window's cross: with a question where work would be lost
    void open(const std::filesystem::path& file); // a graph, or a scene for the graph that is open
    [[nodiscard]] std::string title() const;

    int stopAfter = 64; // frames after the last change; 0: never

    // For tests.
    Canvas canvas;
    Viewport viewport;
    [[nodiscard]] Actions& actions() { return actions_; }
    [[nodiscard]] const std::deque<std::string>& messages() const { return messages_; }
    [[nodiscard]] const Palette& palette() const { return palette_; }
    void say(const std::string& message);

private:
    // actions.cpp
    void addFileActions();
    void addEditActions();
    void addViewActions();
    void addPassActions();
    void openPalette();
    void findPass();
    void addPassByName(std::optional<Canvas::Dropped> joined);
    void swap();
    void browse(const std::filesystem::path& folder);
    void showPort();
    void rename();
    void paste();
    void copy(bool keepInputs);

    // editor.cpp
    void follow();
    void layOut();
    void showRight(float width, float height);
    void showTabs();
    void showProblems();
    void showStatus();
    void showPopups();
    void showContextMenu();
    void save(const std::filesystem::path& file);
    void guard(const std::string& question, std::function<void()> then); // asks where work is not saved
    void openNow(const std::filesystem::path& file);
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
    std::string renaming_;
    enum class Ask { None, Rename, SaveAs, Note, Frame };
    Ask ask_ = Ask::None;
    bool askFresh_ = false;
    std::string question_;
    std::function<void()> afterQuestion_;
    std::optional<Graph> changedOnDisk_;
    std::uint64_t lastRevision_ = 0;
    std::uint64_t framesAtChange_ = 0;
    double lastAutosave_ = 0, lastLook_ = 0;

public:
    // The theme's scale or colours changed: fonts are baked anew between frames.
    [[nodiscard]] bool takeThemeChange() { return std::exchange(themeChanged_, false); }
};

} // namespace kestrel::edit
