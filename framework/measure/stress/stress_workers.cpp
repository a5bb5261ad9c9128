#include "measure/stress/stress_workers.h"
#include "measure/stress/curve.h"
#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <optional>
#include <unistd.h>

namespace kestrel {
namespace {

// Loading plugins, making a context and compiling come before the first case.
constexpr double startSeconds = 120;

void tell(const std::string& line) {
    const std::string text = line + "\n";
    size_t sent = 0;
    while (sent < text.size()) {
        const ssize_t wrote = write(ChildProcess::writesTo, text.data() + sent, text.size() - sent);
        if (wrote <= 0) return; // whoever asked is gone
        sent += static_cast<size_t>(wrote);
    }
}

std::optional<StressCase> caseOf(const std::string& name) {
    for (const StressCase& one : stressCases())
        if (one.name == name) return one;
    return curveCase(name);
}

std::string oneLine(std::string text) {
    while (text.ends_with('\n')) text.pop_back();
    const size_t last = text.rfind('\n');
    return last == std::string::npos ? text : text.substr(last + 1);
}

} // namespace

StressWorkers::StressWorkers(std::vector<std::string> command, double timeout)
    : command_(std::move(command))
    , timeout_(timeout) {}

std::string StressWorkers::lastWords() const {
    const std::string words = oneLine(child_->said());
    return words.empty() ? "" : fmt::format("; it said: {}", words);
}

void StressWorkers::start() {
    child_ = std::make_unique<ChildProcess>(command_);
    const std::optional<std::string> line = child_->receive(startSeconds);
    constexpr std::string_view ready = "ready ";
    if (line && line->starts_with(ready)) {
        renderer_ = line->substr(ready.size());
        return;
    }
    const std::string ending = child_->timedOut() ? "no answer" : child_->ending();
    const int status = child_->exitStatus();
    std::string words = oneLine(child_->said());
    if (words.starts_with("kestrel: ")) words.erase(0, 9);
    child_.reset();
    const bool known = status >= static_cast<int>(ExitStatus::MeasureFailed) &&
                       status <= static_cast<int>(ExitStatus::MachineLacks);
    if (known && !words.empty()) throw Error(static_cast<ExitStatus>(status), {Problem{{}, words}});
    throw MachineError(fmt::format("the process that runs the cases ended before the first one: {}{}", ending,
                                   words.empty() ? "" : "; it said: " + words));
}

const std::string& StressWorkers::renderer() {
    if (!child_) start();
    return renderer_;
}

StressResult StressWorkers::run(const StressCase& one) {
    if (!child_) start();
    const double begin = child_->waited();
    StressResult result;
    result.name = one.name;
    bool sent = child_->send(one.name);
    while (sent) {
        const std::optional<std::string> line =
            child_->receive(std::max(0.0, timeout_ - (child_->waited() - begin)));
        if (!line) break;
        if (line->starts_with("step ")) {
            result.where = line->substr(5);
        } else if (line->starts_with("result ")) {
            try {
                return stressResultOf(Json::parse(std::string_view(*line).substr(7), "the worker's answer"));
            } catch (const InputError& error) {
                result.why = error.what();
                break;
            }
        }
    }
    result.ms = 1e3 * (child_->waited() - begin);
    result.outcome = child_->timedOut() ? StressOutcome::Hung : StressOutcome::Crashed;
    if (child_->timedOut())
        result.why = fmt::format("it was not done after {:g} s", timeout_);
    else if (result.why.empty())
        result.why = fmt::format("the process ended with {}", child_->ending());
    result.why += lastWords();
    child_.reset();
    return result;
}

int serveStressCases(const std::string& renderer, const MakeStressRunner& makeRunner) {
    StressRunner runner = makeRunner([last = std::string()](const std::string& step) mutable {
        if (step != last) tell("step " + step);
        last = step;
    });
    tell("ready " + renderer);
    std::string name;
    for (char c = 0; read(ChildProcess::readsFrom, &c, 1) == 1;) {
        if (c != '\n') {
            name += c;
            continue;
        }
        const std::optional<StressCase> one = caseOf(name);
        name.clear();
        if (!one) return static_cast<int>(ExitStatus::BadInput);
        tell("result " + stressResultText(runner.run(*one)));
    }
    return static_cast<int>(ExitStatus::Done);
}

} // namespace kestrel
