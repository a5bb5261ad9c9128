// Pictures, sequences and figures as files, and the command line that makes the same.
#include "core/files.h"
#include "editor.h"
#include "measure/run_stats.h"
#include <charconv>
#include <fmt/format.h>
#include <imgui.h>

namespace kestrel::edit {

void Editor::addCaptureActions() {
    const auto add = [&](const char* name, const char* chord, std::function<void()> run) {
        actions_.add({.menu = "Capture", .name = name, .key = chordOf(chord), .run = std::move(run)});
    };
    add("Screenshot...", "F12", [this] {
        if (viewport.a.pass.empty()) return say("no port is shown");
        ask("Picture of " + viewport.a.text() + " (.png, .exr, .hdr)", viewport.a.text() + ".png",
            [this](const std::string& typed) { screenshot(typed); });
    });
    add("Frame sequence...", "Shift+F12", [this] {
        if (viewport.a.pass.empty()) return say("no port is shown");
        ask("Files, with the number of the frame as %04d, and how many frames",
            viewport.a.text() + "_%04d.png 60", [this](const std::string& typed) { startSequence(typed); });
    });
    add("Copy the command line", "Ctrl+Shift+C", [this] { copyCommandLine(); });
    add("Write stats.json...", "Ctrl+Shift+E", [this] {
        ask("Times, memory and what was left out", "stats.json",
            [this](const std::string& typed) { writeStats(typed); });
    });
    add("Compare with a file...", "Ctrl+H", [this] {
        ask("Picture to compare with (.png, .exr, .hdr)", "", [this](const std::string& typed) {
            try {
                viewport.holdFile(typed);
            } catch (const Error& error) {
                say(error.problems().front().text());
            }
        });
    });
}

void Editor::screenshot(const std::string& file) {
    try {
        const OutputFile output = parseOutput(viewport.a.text() + "=" + file);
        if (output.sequence) return say("one picture has no number of a frame: that is a sequence's");
        if (!session_.renderAgain()) return say("nothing can be rendered");
        FileBytes made;
        addOutput(made, *session_.renderer(), session_.registry(), output);
        writeFiles(made);
        say("wrote " + file);
    } catch (const Error& error) {
        say(error.problems().front().text());
    }
}

void Editor::copyCommandLine() {
    if (viewport.a.pass.empty()) return say("no port is shown");
    if (session_.document.modified() || session_.document.graph().file.empty())
        return say("save the graph first: the command line reads its file");
    if (!session_.renderAgain()) return say("nothing can be rendered");
    const std::string line = session_.commandLine(viewport.a, viewport.a.text() + ".exr");
    ImGui::SetClipboardText(line.c_str());
    say("copied: " + line);
}

// "FILE_%04d.png 60"
void Editor::startSequence(const std::string& typed) {
    const size_t space = typed.find_last_of(' ');
    int frames = 0;
    if (space != std::string::npos)
        std::from_chars(typed.data() + space + 1, typed.data() + typed.size(), frames);
    if (frames < 1) return say("after the files' name comes how many frames");
    try {
        const OutputFile output = parseOutput(viewport.a.text() + "=" + typed.substr(0, space));
        if (!output.sequence) return say("the name of a sequence has the number of its frame, as %04d");
        if (session_.renderer() == nullptr) return say("nothing can be rendered");
        const std::string line = session_.commandLine(viewport.a, output.file, frames);
        session_.setTimeRuns(true);
        session_.playing = true;
        session_.beginAgain();
        recording_ = Recording{output, frames};
        say("the same without a window: " + line);
    } catch (const Error& error) {
        say(error.problems().front().text());
    }
}

// One frame of the sequence and its file.
void Editor::record() {
    try {
        if (session_.settled() != recording_->made || !session_.render())
            throw InputError("the sequence ends: the picture was changed");
        FileBytes made;
        addOutput(made, *session_.renderer(), session_.registry(), recording_->output);
        writeFiles(made);
        ++recording_->made;
        if (--recording_->left > 0) return;
        say(fmt::format("wrote {} frames", recording_->made));
    } catch (const Error& error) {
        say(error.problems().front().text());
    }
    recording_.reset();
    session_.setTimeRuns(false);
}

void Editor::writeStats(const std::string& file) {
    if (session_.renderer() == nullptr || session_.frames() == 0) return say("nothing is rendered yet");
    RunStats stats = gatherStats(*session_.renderer(), session_.profile(), session_.driver());
    stats.graphPath = session_.document.graph().file.string();
    stats.scenePath = session_.renderer()->scene().source;
    try {
        writeFile(file, statsJson(stats));
        say("wrote " + file);
    } catch (const Error& error) {
        say(error.problems().front().text());
    }
}

} // namespace kestrel::edit
