// The command line of Kestrel: one file a command; here are only what holds for all of them, and the exit
// status.
#include "commands.h"
#include "common.h"
#include "core/check.h"
#include "core/error.h"
#include "core/log.h"
#include "core/version.h"
#include "freed_memory.h"
#include "machine.h"
#include "named.h"
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <new>
#include <string>
#include <unistd.h>
#include <vector>

namespace {

using namespace kestrel;

std::string versionText() {
    return fmt::format("kestrel {} ({})\nparts: {}\nbackends: egl{}{}\n", version(), configuration(), parts(),
                       parts().find("osmesa") != std::string::npos ? " osmesa" : "",
                       parts().find("window") != std::string::npos ? " window" : "");
}

// The command as it can be pasted into a shell.
std::string quotedCommand(int argc, char** argv) {
    std::string command;
    for (int i = 0; i < argc; ++i) {
        const std::string argument = argv[i];
        const bool plain =
            !argument.empty() && argument.find_first_not_of("abcdefghijklmnopqrstuvwxyz"
                                                            "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                            "0123456789_-+=./:,@%") == std::string::npos;
        std::string quoted;
        for (const char c : argument) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
        command += (i > 0 ? " " : "") + (plain ? argument : "'" + quoted + "'");
    }
    return command;
}

int tell(ExitStatus status, const std::string& line) {
    fmt::print(stderr, "kestrel: {}\n", line);
    return static_cast<int>(status);
}

std::string oneLine(std::string text) {
    for (char& c : text)
        if (c == '\n' || c == '\r') c = ' ';
    while (text.ends_with(' ')) text.pop_back();
    return text;
}

// Why the first word is no command; empty if it is one.
std::string unknownCommand(const CLI::App& app, int argc, char** argv) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word.starts_with('-')) continue;
        if (std::ranges::find(names, word) != names.end()) return {};
        return fmt::format("there is no command '{}'{}", word, didYouMean(word, names));
    }
    return {};
}

// Nothing has to be tidied up, since no file has its name before it is whole. Ends as the signal would have
// it, so that the shell and its scripts see what happened.
void endBySignal(int signal) {
    constexpr std::string_view line = "\nkestrel: interrupted; what has been written is whole\n";
    const std::string_view shown = ::isatty(STDERR_FILENO) != 0 ? line : line.substr(1);
    if (::write(STDERR_FILENO, shown.data(), shown.size()) < 0) {
    } // there is nobody to tell
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

// An exception that nothing can catch: of a destructor of a plugin's pass, say.
[[noreturn]] void endByException() {
    try {
        std::rethrow_exception(std::current_exception());
    } catch (const std::exception& error) {
        tell(ExitStatus::BadInput,
             "an exception left a function that must not throw: " + oneLine(error.what()));
    } catch (...) {
        tell(ExitStatus::BadInput, "an exception of unknown kind left a function that must not throw");
    }
    std::_Exit(static_cast<int>(ExitStatus::BadInput));
}

// Where a pass type is unknown, it may be of a plugin that was not built.
void tellAbsentPlugins(const Error& error) {
    if (std::ranges::none_of(error.problems(), [](const Problem& problem) {
            return problem.message.find("unknown type") != std::string::npos ||
                   problem.message.find("no pass type") != std::string::npos;
        }))
        return;
    if (const std::vector<std::string> absent = absentPlugins(); !absent.empty())
        tell(error.status(),
             fmt::format("not built here: {}; apps/build.sh builds all", fmt::join(absent, ", ")));
}

int runGuarded(const Run& run) {
    try {
        const int status = run();
        if (std::fflush(stdout) != 0) return tell(ExitStatus::BadInput, "standard output cannot be written");
        return status;
    } catch (const Error& error) {
        for (const Problem& problem : error.problems()) tell(error.status(), oneLine(problem.text()));
        tellAbsentPlugins(error);
        return static_cast<int>(error.status());
    } catch (const std::bad_alloc&) {
        return tell(ExitStatus::MachineLacks, "there is not enough memory");
    } catch (const std::exception& error) {
        return tell(ExitStatus::BadInput, oneLine(error.what()));
    }
}

} // namespace

int main(int argc, char** argv) {
    keepFreedMemory();
    setReplayCommand(quotedCommand(argc, argv));
    std::set_terminate(endByException);
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, endBySignal);
    CLI::App app("Renders graphs of rendering techniques, and measures which gives which error at which run "
                 "time.",
                 "kestrel");
    app.footer("'kestrel COMMAND --help' tells a command's options.\n"
               "Exit status: 0 done; 1 a measured check failed; 2 bad input or usage; 3 the machine lacks "
               "something.");
    bool quiet = false, verbose = false, gl = false, asked = false;
    Run run;
    CLI::Option* withVersion =
        app.add_flag("--version,-V", asked, "Print the version and the parts and backends that are in");
    app.add_flag("--gl", gl,
                 "With --version, for reports of faults: print what this machine's OpenGL offers, and what "
                 "Kestrel does "
                 "otherwise for what it lacks, as JSON for 'kestrel check --capabilities'")
        ->needs(withVersion);
    app.add_flag("--quiet,-q", quiet, "Print nothing but errors, and what is asked for as data");
    app.add_flag("--verbose,-v", verbose, "Print what is done");
    app.require_subcommand(1);
    app.fallthrough();

    addRenderCommand(app, run);
    addCheckCommand(app, run);
    addPassesCommand(app, run);
    addDotCommand(app, run);
    addCompareCommand(app, run);
    addSceneCommand(app, run);
    addSweepCommand(app, run);
    addTuneCommand(app, run);
    addStressCommand(app, run);
    // Asked for, the version is told whatever else is said or lacks. Not by a callback of its option: CLI11
    // 2.1 (Debian 12) calls that before it misses a subcommand, 2.6 after.
    const auto tellVersion = [&] {
        return runGuarded([gl = app.count("--gl") > 0] {
            fmt::print("{}", gl ? machineJson(loadedRegistry()) : versionText());
            return static_cast<int>(ExitStatus::Done);
        });
    };
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& done) {
        return app.exit(done);
    } catch (const CLI::ParseError& error) {
        if (withVersion->count() > 0) return tellVersion();
        const std::string unknown = unknownCommand(app, argc, argv);
        return tell(ExitStatus::BadInput, (unknown.empty() ? oneLine(error.what()) : unknown) +
                                              " ('kestrel --help' tells the usage)");
    }
    if (withVersion->count() > 0) return tellVersion();
    if (quiet) reportStream() = nullptr;
    setLogLevel(quiet ? LogLevel::Error : verbose ? LogLevel::Debug : LogLevel::Warning);
    return runGuarded(run);
}
