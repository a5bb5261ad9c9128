#include "edit/layout.h"
#include <algorithm>
#include <limits>

namespace kestrel::edit {
namespace {

const glm::dvec2 usualSize(180, 100);

glm::dvec2 sizeOf(const Sizes& sizes, const std::string& pass) {
    const auto found = sizes.find(pass);
    return found == sizes.end() ? usualSize : found->second;
}

// Boxes in columns; an edge over several columns is led through them by boxes without a pass, so that what
// lies between is not crossed.
class Layers {
public:
    Layers(const Graph& graph, const Names& which) {
        for (const GraphPass& pass : graph.passes)
            if (which.contains(pass.name)) add(pass.name);
        std::set<std::pair<int, int>> joined;
        for (const GraphEdge& edge : graph.edges) {
            const auto from = index_.find(edge.from.pass), to = index_.find(edge.to.pass);
            if (from != index_.end() && to != index_.end() && from->second != to->second &&
                joined.insert({from->second, to->second}).second)
                edges_.push_back({from->second, to->second});
        }
        findColumns();
        leadThrough();
        order();
    }

    // Names by columns, from top to bottom; empty names are what edges are led through.
    [[nodiscard]] std::vector<std::vector<std::string>> columns() const {
        std::vector<std::vector<std::string>> names;
        for (const std::vector<int>& column : columns_) {
            names.emplace_back();
            for (const int box : column) names.back().push_back(boxes_[static_cast<size_t>(box)].name);
        }
        return names;
    }

private:
    struct Box {
        std::string name;
        int column = 0;
        std::vector<int> left, right; // neighbours in the columns beside
    };

    void add(const std::string& name) {
        index_[name] = static_cast<int>(boxes_.size());
        boxes_.push_back({.name = name, .column = 0, .left = {}, .right = {}});
    }
    Box& at(int box) { return boxes_[static_cast<size_t>(box)]; }

    // Right of all that it reads; then as far right as its readers allow, so that edges are short. A graph
    // that is not valid may have cycles: as many rounds as there are boxes end them.
    void findColumns() {
        for (size_t round = 0; round < boxes_.size(); ++round) {
            bool moved = false;
            for (const auto& [from, to] : edges_)
                if (at(to).column <= at(from).column &&
                    at(from).column + 1 < static_cast<int>(boxes_.size())) {
                    at(to).column = at(from).column + 1;
                    moved = true;
                }
            if (!moved) break;
        }
        for (size_t round = 0; round < boxes_.size(); ++round) {
            bool moved = false;
            for (int box = 0; box < static_cast<int>(boxes_.size()); ++box) {
                int nearest = std::numeric_limits<int>::max();
                for (const auto& [from, to] : edges_)
                    if (from == box) nearest = std::min(nearest, at(to).column);
                if (nearest != std::numeric_limits<int>::max() && nearest - 1 > at(box).column) {
                    at(box).column = nearest - 1;
                    moved = true;
                }
            }
            if (!moved) break;
        }
    }

    void leadThrough() {
        const std::vector<std::pair<int, int>> edges = edges_;
        for (const auto& [from, to] : edges) {
            int last = from;
            for (int column = at(from).column + 1; column < at(to).column; ++column) {
                const int box = static_cast<int>(boxes_.size());
                boxes_.push_back({.name = {}, .column = column, .left = {}, .right = {}});
                join(last, box);
                last = box;
            }
            if (at(last).column < at(to).column) join(last, to);
        }
        int width = 0;
        for (const Box& box : boxes_) width = std::max(width, box.column + 1);
        columns_.resize(static_cast<size_t>(width));
        for (size_t i = 0; i < boxes_.size(); ++i)
            columns_[static_cast<size_t>(boxes_[i].column)].push_back(static_cast<int>(i));
    }
    void join(int left, int right) {
        at(left).right.push_back(right);
        at(right).left.push_back(left);
    }

    void order() {
        std::vector<std::vector<int>> best = columns_;
        size_t fewest = countCrossings();
        for (int sweep = 0; sweep < 12 && fewest > 0; ++sweep) {
            const bool rightward = sweep % 2 == 0;
            const int width = static_cast<int>(columns_.size());
            for (int i = 0; i < width; ++i)
                sortColumn(static_cast<size_t>(rightward ? i : width - 1 - i), rightward);
            if (const size_t now = countCrossings(); now < fewest) {
                fewest = now;
                best = columns_;
            }
        }
        columns_ = best;
    }

    [[nodiscard]] std::vector<double> places() const {
        std::vector<double> place(boxes_.size(), 0);
        for (const std::vector<int>& column : columns_)
            for (size_t i = 0; i < column.size(); ++i)
                place[static_cast<size_t>(column[i])] = static_cast<double>(i);
        return place;
    }

    // By the median of what it is joined with on that side; what is joined with nothing keeps its place.
    void sortColumn(size_t column, bool byLeft) {
        const std::vector<double> place = places();
        std::vector<std::pair<double, int>> keyed;
        for (size_t i = 0; i < columns_[column].size(); ++i) {
            const int box = columns_[column][i];
            std::vector<double> beside;
            for (const int other : byLeft ? at(box).left : at(box).right)
                beside.push_back(place[static_cast<size_t>(other)]);
            std::sort(beside.begin(), beside.end());
            const double median = beside.empty()
                                      ? static_cast<double>(i)
                                      : (beside[(beside.size() - 1) / 2] + beside[beside.size() / 2]) / 2;
            keyed.push_back({median, box});
        }
        std::stable_sort(keyed.begin(), keyed.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        for (size_t i = 0; i < keyed.size(); ++i) columns_[column][i] = keyed[i].second;
    }

    [[nodiscard]] size_t countCrossings() const {
        const std::vector<double> place = places();
        size_t count = 0;
        for (const std::vector<int>& column : columns_) {
            std::vector<std::pair<double, double>> lines;
            for (const int box : column)
                for (const int other : boxes_[static_cast<size_t>(box)].right)
                    lines.push_back({place[static_cast<size_t>(box)], place[static_cast<size_t>(other)]});
            for (size_t i = 0; i < lines.size(); ++i)
                for (size_t j = i + 1; j < lines.size(); ++j)
                    count +=
                        (lines[i].first - lines[j].first) * (lines[i].second - lines[j].second) < 0 ? 1 : 0;
        }
        return count;
    }

    std::vector<Box> boxes_;
    std::map<std::string, int> index_;
    std::vector<std::pair<int, int>> edges_;
    std::vector<std::vector<int>> columns_;
};

} // namespace

void arrange(Graph& graph, const Names& which, const Sizes& sizes, const LayoutGaps& gaps) {
    std::optional<glm::dvec2> corner;
    for (const GraphPass& pass : graph.passes)
        if (which.contains(pass.name) && pass.position)
            corner = corner ? glm::min(*corner, *pass.position) : *pass.position;
    const auto columns = Layers(graph, which).columns();
    double x = 0, top = std::numeric_limits<double>::max();
    std::map<std::string, glm::dvec2> places;
    for (const std::vector<std::string>& column : columns) {
        double width = 0, height = -gaps.beneath;
        for (const std::string& name : column) {
            width = std::max(width, name.empty() ? 0 : sizeOf(sizes, name).x);
            height += (name.empty() ? 0 : sizeOf(sizes, name).y) + gaps.beneath;
        }
        double y = -height / 2; // columns are centred on one line
        for (const std::string& name : column) {
            if (!name.empty()) {
                places[name] = {x, y};
                top = std::min(top, y);
            }
            y += (name.empty() ? 0 : sizeOf(sizes, name).y) + gaps.beneath;
        }
        x += width + gaps.between;
    }
    const glm::dvec2 moved = corner.value_or(glm::dvec2(0)) - glm::dvec2(0, places.empty() ? 0 : top);
    for (GraphPass& pass : graph.passes)
        if (const auto place = places.find(pass.name); place != places.end())
            pass.position = glm::round(place->second + moved);
    for (GraphEdge& edge : graph.edges)
        if (which.contains(edge.from.pass) && which.contains(edge.to.pass)) edge.bends.clear();
}

bool placeMissing(Graph& graph, const Sizes& sizes, const LayoutGaps& gaps) {
    Names missing;
    std::optional<glm::dvec2> lowerLeft;
    for (const GraphPass& pass : graph.passes) {
        if (!pass.position) {
            missing.insert(pass.name);
            continue;
        }
        const double bottom = pass.position->y + sizeOf(sizes, pass.name).y;
        lowerLeft = lowerLeft
                        ? glm::dvec2(std::min(lowerLeft->x, pass.position->x), std::max(lowerLeft->y, bottom))
                        : glm::dvec2(pass.position->x, bottom);
    }
    if (missing.empty()) return false;
    arrange(graph, missing, sizes, gaps);
    if (lowerLeft)
        for (GraphPass& pass : graph.passes)
            if (missing.contains(pass.name)) *pass.position += *lowerLeft + glm::dvec2(0, 2 * gaps.beneath);
    return true;
}

void keepPlaces(Graph& graph, const Places& drawn) {
    if (std::none_of(graph.passes.begin(), graph.passes.end(),
                     [](const GraphPass& pass) { return pass.position; }))
        return;
    for (GraphPass& pass : graph.passes)
        if (const auto place = drawn.find(pass.name); !pass.position && place != drawn.end())
            pass.position = place->second;
}

size_t crossings(const Graph& graph, const Names& which) {
    struct Line {
        glm::dvec2 from, to;
    };
    std::vector<Line> lines;
    for (const GraphEdge& edge : graph.edges) {
        const GraphPass* from = graph.find(edge.from.pass);
        const GraphPass* to = graph.find(edge.to.pass);
        if (from == nullptr || to == nullptr || !which.contains(from->name) || !which.contains(to->name))
            continue;
        if (from->position && to->position) lines.push_back({*from->position, *to->position});
    }
    const auto side = [](const Line& line, glm::dvec2 point) {
        const glm::dvec2 along = line.to - line.from, beside = point - line.from;
        return along.x * beside.y - along.y * beside.x;
    };
    size_t count = 0;
    for (size_t i = 0; i < lines.size(); ++i)
        for (size_t j = i + 1; j < lines.size(); ++j)
            count += side(lines[i], lines[j].from) * side(lines[i], lines[j].to) < 0 &&
                             side(lines[j], lines[i].from) * side(lines[j], lines[i].to) < 0
                         ? 1
                         : 0;
    return count;
}

} // namespace kestrel::edit
