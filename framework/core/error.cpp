#include "core/error.h"
#include <algorithm>
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

// Levenshtein distance with adjacent transpositions counted as one edit ("nromal" is one slip, not two).
size_t editDistance(std::string_view a, std::string_view b) {
    std::vector<size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    std::iota(last.begin(), last.end(), size_t{0});
    for (size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
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
    : std::runtime_error(joined(problems))
    , status_(status)
    , problems_(std::move(problems)) {}

std::string nearName(std::string_view name, const std::vector<std::string>& candidates) {
    std::string best;
    size_t bestDistance = SIZE_MAX;
    for (const std::string& candidate : candidates) {
        const size_t allowed = std::max<size_t>(1, std::max(name.size(), candidate.size()) / 3);
        const size_t distance = editDistance(name, candidate);
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
