#include "core/error.h"
#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <numeric>

namespace kestrel {
namespace {

std::string joined(const std::vector<Problem>& problems) {
    std::string all;
    for (const Problem& problem : problems) {
        if (!all.empty()) all += '\n';
        all += problem.text();
    }
    return all;
}

// Names of files and texts out of them stand in messages: what a terminal would obey is shown as '?'.
void makePrintable(std::string& text) {
    for (char& letter : text) {
        if (letter == '\n' || letter == '\r' || letter == '\t') letter = ' ';
        if (std::iscntrl(static_cast<unsigned char>(letter)) != 0) letter = '?';
    }
}

std::vector<Problem> printable(std::vector<Problem> problems) {
    for (Problem& problem : problems) {
        makePrintable(problem.where.file);
        makePrintable(problem.message);
    }
    return problems;
}

// Levenshtein distance with adjacent transpositions counted as one edit ("nromal" is one slip, not two); any
// number above `most` where it is more.
size_t editDistance(std::string_view a, std::string_view b, size_t most) {
    std::vector<size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    std::iota(last.begin(), last.end(), size_t{0});
    for (size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        if (*std::min_element(row.begin(), row.end()) > most) return most + 1;
        before.swap(last);
        last.swap(row);
    }
    return last[b.size()];
}

} // namespace

std::string Location::text() const {
    if (line <= 0) return file;
    if (column <= 0) return fmt::format("{}:{}", file, line);
    return fmt::format("{}:{}:{}", file, line, column);
}

std::string Problem::text() const {
    const std::string place = where.text();
    return place.empty() ? message : place + ": " + message;
}

Error::Error(ExitStatus status, std::vector<Problem> problems)
    : std::runtime_error(joined(printable(problems)))
    , status_(status)
    , problems_(printable(std::move(problems))) {}

std::string nearName(std::string_view name, const std::vector<std::string>& candidates) {
    // Nobody mistypes a text of this length, or chooses among so many; comparing takes the product of the
    // lengths.
    constexpr size_t longest = 200, mostCandidates = 2'000;
    if (name.size() > longest || candidates.size() > mostCandidates) return {};
    std::string best;
    size_t bestDistance = SIZE_MAX;
    for (const std::string& candidate : candidates) {
        const size_t longer = std::max(name.size(), candidate.size());
        const size_t allowed = std::max<size_t>(1, longer / 3);
        if (longer - std::min(name.size(), candidate.size()) > allowed) continue;
        const size_t distance = editDistance(name, candidate, allowed);
        if (distance <= allowed && distance < bestDistance) {
            best = candidate;
            bestDistance = distance;
        }
    }
    return best;
}

std::string didYouMean(std::string_view name, const std::vector<std::string>& candidates) {
    const std::string near = nearName(name, candidates);
    return near.empty() ? std::string() : fmt::format(" (did you mean '{}'?)", near);
}

} // namespace kestrel
