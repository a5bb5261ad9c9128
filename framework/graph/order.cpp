// Compiler stage: the order of execution, and which in-place updates can do without a copy.
#include "core/check.h"
#include "graph/network.h"
#include <algorithm>

namespace kestrel::compiler {
namespace {

class Orderer {
public:
    explicit Orderer(const Network& network)
        : network_(network)
        , before_(network.nodes.size()) {
        for (int i = 0; i < static_cast<int>(network.nodes.size()); ++i) {
            const Node& node = network.at(i);
            if (!node.live) continue;
            for (const auto& [port, source] : node.feeds)
                if (network.at(source.node).live) before_[static_cast<size_t>(source.node)].insert(i);
            for (const Step& step : node.real.steps)
                for (const BoundUse& use : boundUses(network, i, step)) {
                    users_[use.source].insert(i);
                    if (use.use.previous) history_.insert(use.source);
                }
            for (const Output& output :
                 node.real.outputs) // an update reads the old content, or is a copy of it
                if (!output.updates.empty())
                    if (const auto old = originOfInput(network, i, output.updates)) users_[*old].insert(i);
        }
        for (const Source& source : network.wanted) wanted_.insert(origin(network, source));
    }

    Order run() {
        for (const int i : network_.order) {
            if (!network_.at(i).live) continue;
            for (const Output& output : network_.at(i).real.outputs)
                if (!output.updates.empty()) placeUpdate(i, output);
        }
        const std::vector<int> all = topologicalOrder(before_);
        KESTREL_CHECK_EQ(all.size(), network_.nodes.size());
        for (const int i : all)
            if (network_.at(i).live) order_.nodes.push_back(i);
        return std::move(order_);
    }

private:
    // In place if every other reader of the old content can run before, and nobody misses it afterwards: it
    // is made anew in every frame, not shown, not constant, not read in the next frame.
    void placeUpdate(int updater, const Output& output) {
        const auto old = originOfInput(network_, updater, output.updates);
        if (!old || output.keeps || history_.contains({updater, output.port})) return;
        const Node& producer = network_.at(old->node);
        const Output* before = findOutput(producer.real, old->port);
        if (before == nullptr || before->keeps || before->constant || !producer.everyFrame() ||
            wanted_.contains(*old) || history_.contains(*old) || readsOldTooLate(updater, output.port, *old))
            return;
        const std::set<int>& readers = users_[*old];
        for (const int reader : readers)
            if (reader != updater && reader != old->node && reaches(updater, reader)) return;
        for (const int reader : readers)
            if (reader != updater && reader != old->node)
                before_[static_cast<size_t>(reader)].insert(updater);
        order_.inPlace[{updater, output.port}] = *old;
    }

    // Whether the updater itself still reads the old content in the step that begins to change it, or later.
    [[nodiscard]] bool readsOldTooLate(int updater, const std::string& port, const Source& old) const {
        bool changed = false;
        for (const Step& step : network_.at(updater).real.steps) {
            const std::vector<BoundUse> uses = boundUses(network_, updater, step);
            const auto binds = [&](const Source& source) {
                return std::any_of(uses.begin(), uses.end(),
                                   [&](const BoundUse& use) { return use.source == source; });
            };
            changed = changed || binds({updater, port});
            if (changed && binds(old)) return true;
        }
        return false;
    }

    [[nodiscard]] bool reaches(int from, int to) const {
        std::vector<int> open = {from};
        std::set<int> seen = {from};
        while (!open.empty()) {
            const int node = open.back();
            open.pop_back();
            for (const int next : before_[static_cast<size_t>(node)]) {
                if (next == to) return true;
                if (seen.insert(next).second) open.push_back(next);
            }
        }
        return false;
    }

    const Network& network_;
    std::vector<std::set<int>> before_; // node -> those that come after it
    std::map<Source, std::set<int>> users_;
    std::set<Source> history_, wanted_;
    Order order_;
};

} // namespace

Order orderPasses(const Network& network) { return Orderer(network).run(); }

} // namespace kestrel::compiler
