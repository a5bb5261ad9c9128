// Camera and time by key, menu and palette.
#include "edit/camera.h"
#include "edit/commands.h"
#include "editor.h"
#include <cstdlib>

namespace kestrel::edit {

void Editor::addCameraActions() {
    const auto add = [&](const char* name, const char* chord, std::function<void()> run) {
        actions_.add({.menu = "Camera", .name = name, .key = chordOf(chord), .run = std::move(run)});
    };
    const auto move = [&](const char* name, const char* chord, auto change) {
        add(name, chord, [this, change] {
            if (auto camera = session_.movableCamera()) {
                change(*camera);
                session_.setOwnCamera(*camera);
            }
        });
    };
    constexpr double turn = 0.05, way = 0.05; // radians, distances to the target
    move("Turn left about the middle", "Alt+Left", [](AddedCamera& camera) { orbit(camera, -turn, 0); });
    move("Turn right about the middle", "Alt+Right", [](AddedCamera& camera) { orbit(camera, turn, 0); });
    move("Turn up about the middle", "Alt+Up", [](AddedCamera& camera) { orbit(camera, 0, turn); });
    move("Turn down about the middle", "Alt+Down", [](AddedCamera& camera) { orbit(camera, 0, -turn); });
    move("Look left", "Ctrl+Left", [](AddedCamera& camera) { lookAround(camera, -turn, 0); });
    move("Look right", "Ctrl+Right", [](AddedCamera& camera) { lookAround(camera, turn, 0); });
    move("Look up", "Ctrl+Up", [](AddedCamera& camera) { lookAround(camera, 0, turn); });
    move("Look down", "Ctrl+Down", [](AddedCamera& camera) { lookAround(camera, 0, -turn); });
    move("Fly forward", "Alt+W", [](AddedCamera& camera) { fly(camera, {0, 0, way}); });
    move("Fly back", "Alt+S", [](AddedCamera& camera) { fly(camera, {0, 0, -way}); });
    move("Fly left", "Alt+A", [](AddedCamera& camera) { fly(camera, {-way, 0, 0}); });
    move("Fly right", "Alt+D", [](AddedCamera& camera) { fly(camera, {way, 0, 0}); });
    move("Fly up", "Alt+E", [](AddedCamera& camera) { fly(camera, {0, way, 0}); });
    move("Fly down", "Alt+Q", [](AddedCamera& camera) { fly(camera, {0, -way, 0}); });
    move("Nearer", "Alt+=", [](AddedCamera& camera) { dolly(camera, 0.9); });
    move("Farther", "Alt+-", [](AddedCamera& camera) { dolly(camera, 1 / 0.9); });
    add("Choose a camera...", "C", [this] { chooseCamera(); });
    add("Back to the graph's camera", "Shift+C", [this] { session_.setCamera(""); });
    add("Copy the camera as --camera", "Ctrl+Alt+V",
        [this] { SceneBar::copyCamera(session_, [this](const std::string& message) { say(message); }); });
    add("Write the camera into the graph", "", [this] {
        if (const auto camera = session_.movableCamera())
            say(session_.apply("Camera into the graph", [&](Graph& graph) {
                graph.sceneSetup.camera = *camera;
                graph.sceneSetup.cameraName.clear();
            }));
    });
    add("Play or pause", "Space", [this] {
        if (session_.duration() > 0)
            session_.setTimeRuns(!session_.timeRuns());
        else
            session_.playing = !session_.playing;
    });
    add("Next frame", ".", [this] {
        if (session_.duration() > 0) return SceneBar::step(session_, 1);
        session_.playing = false;
        session_.render();
    });
    add("Frame before", ",", [this] { SceneBar::step(session_, -1); });
    add("From the first frame", "Home", [this] { session_.restart(); });
    add("Time step...", "", [this] {
        ask("Seconds of the scene from frame to frame; empty: the scene's rate", "",
            [this](const std::string& typed) {
                char* end = nullptr;
                const double seconds = std::strtod(typed.c_str(), &end);
                if (typed.empty())
                    session_.setTimeStep({});
                else if (*end != 0 || !(seconds >= 0 && seconds <= 1e6))
                    say("a time step is a number of seconds from 0 to 1e6");
                else
                    session_.setTimeStep(seconds);
            });
    });
}

void Editor::chooseCamera() {
    if (session_.renderer() == nullptr) return;
    std::vector<Palette::Entry> entries;
    for (const Camera& camera : session_.renderer()->scene().cameras)
        entries.push_back({camera.name, camera.name == session_.cameraName() ? "is seen" : "",
                           [this, name = camera.name] { session_.setCamera(name); }});
    palette_.open("Camera of the scene", std::move(entries));
}

} // namespace kestrel::edit
