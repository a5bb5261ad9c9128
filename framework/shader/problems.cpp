#include "shader/problems.h"
#include "shader/lines.h"
#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <optional>
#include <utility>

namespace kestrel {
namespace {

// Reads a log line from its begin; each function leaves the text alone if it does not match.
class LineReader {
public:
    explicit LineReader(std::string_view text)
        : rest_(trimmed(text)) {}
    [[nodiscard]] std::string_view rest() const { return rest_; }

    bool accept(std::string_view text) {
        if (!rest_.starts_with(text)) return false;
        rest_ = trimmed(rest_.substr(text.size()));
        return true;
    }
    std::optional<int> number() {
        int value = 0;
        const auto [end, failure] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
        if (failure != std::errc{}) return std::nullopt;
        rest_.remove_prefix(static_cast<size_t>(end - rest_.data()));
        return value;
    }

private:
    std::string_view rest_;
};

struct Place {
    int source = 0;
    int line = 0;
    int column = 0;
};

// "F:N(C):" of Mesa, "F:N:" of glslang, "F(N) :" of NVIDIA.
std::optional<Place> readPlace(LineReader& reader) {
    LineReader ahead = reader;
    Place place;
    const std::optional<int> source = ahead.number();
    if (!source) return std::nullopt;
    const bool nvidia = ahead.accept("(");
    if (!nvidia && !ahead.accept(":")) return std::nullopt;
    const std::optional<int> line = ahead.number();
    if (!line) return std::nullopt;
    if (nvidia && !ahead.accept(")")) return std::nullopt;
    if (!nvidia && ahead.accept("(")) {
        const std::optional<int> column = ahead.number();
        if (!column || !ahead.accept(")")) return std::nullopt;
        place.column = *column;
    }
    if (!ahead.accept(":")) return std::nullopt;
    place.source = *source;
    place.line = *line;
    reader = ahead;
    return place;
}

enum class Severity { None, Error, Warning };

Severity readSeverity(LineReader& reader) {
    if (reader.accept("ERROR:") || reader.accept("error:")) return Severity::Error;
    if (reader.accept("WARNING:") || reader.accept("warning:")) return Severity::Warning;
    return Severity::None;
}

// NVIDIA puts a code between the word and the colon ("error C1008: ..."); it stays in the message.
bool isSummary(std::string_view text) {
    return text.empty() || text.ends_with("No code generated.") || text.ends_with("compilation terminated") ||
           text.starts_with("Linked ");
}

std::string message(Severity severity, std::string_view text, std::string_view sourceLine) {
    while (!text.empty() && text.back() == '.') text.remove_suffix(1);
    std::string result = severity == Severity::Warning ? "warning: " : "";
    result += text;
    if (!sourceLine.empty()) result += " in: " + std::string(sourceLine);
    return result;
}

std::vector<std::string_view> linesOf(std::string_view text) {
    std::vector<std::string_view> lines;
    for (size_t begin = 0; begin < text.size();) {
        const size_t end = std::min(text.find('\n', begin), text.size());
        lines.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return lines;
}

// `#line N F`, or nothing.
std::optional<Place> lineDirective(std::string_view line) {
    const std::optional<Directive> directive = directiveOf(line);
    if (!directive || directive->name != "line") return std::nullopt;
    LineReader reader(directive->rest);
    const std::optional<int> number = reader.number();
    LineReader tail(reader.rest());
    const std::optional<int> source = tail.number();
    if (!number || !source) return std::nullopt;
    return Place{*source, *number, 0};
}

} // namespace

std::string driverText(const ComposedStage& stage) {
    std::string text;
    text.reserve(stage.text.size() + stage.text.size() / 16);
    for (const std::string_view line : linesOf(stage.text)) {
        if (const std::optional<Place> place = lineDirective(line)) {
            const int number = place->source * linesPerSource + place->line;
            text += fmt::format("#line {} {}\n", number, place->source);
        } else {
            text += line;
            text += '\n';
        }
    }
    return text;
}

std::string composedLine(const ComposedStage& stage, int source, int line) {
    // The last one that is not blank counts: what composition writes around an include is counted on from the
    // file's lines, which follow later, and a hoisted line leaves a blank one behind.
    std::string_view found;
    Place next{0, 1, 0};
    for (const std::string_view text : linesOf(stage.text)) {
        if (const std::optional<Place> place = lineDirective(text)) {
            next = *place;
            continue;
        }
        if (next.source == source && next.line == line && !trimmed(text).empty()) found = text;
        ++next.line;
    }
    return std::string(trimmed(found));
}

std::vector<Problem> mapShaderLog(const std::string& log, const ComposedStage& stage) {
    std::vector<Problem> problems;
    for (const std::string_view text : linesOf(log)) {
        LineReader reader(text);
        Severity severity = readSeverity(reader);
        std::optional<Place> place = readPlace(reader);
        if (place && severity == Severity::None) severity = readSeverity(reader);
        if (isSummary(reader.rest())) continue;
        if (place && place->line > linesPerSource) {
            place->source = place->line / linesPerSource;
            place->line %= linesPerSource;
        }
        const bool known =
            place && place->source >= 0 && place->source < static_cast<int>(stage.sources.size());
        const Location where =
            known ? Location{stage.sources[static_cast<size_t>(place->source)], place->line, place->column}
                  : Location{stage.file};
        const std::string line = known ? composedLine(stage, place->source, place->line) : std::string();
        problems.push_back({where, message(severity, reader.rest(), line)});
    }
    return problems;
}

std::vector<Problem> mapLinkLog(const std::string& log, const ComposedProgram& program) {
    std::vector<Problem> problems;
    for (const std::string_view text : linesOf(log)) {
        LineReader reader(text);
        const Severity severity = readSeverity(reader);
        if (!isSummary(reader.rest()))
            problems.push_back({{program.name}, message(severity, reader.rest(), {})});
    }
    return problems;
}

} // namespace kestrel
