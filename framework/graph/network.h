// Inside the compiler: the graph with its names resolved, and what each stage finds out about every pass.
// Each stage stands in its own file; compile.cpp calls them in order.
#pragma once
#include "graph/plan.h"
#include <functional>
#include <set>

namespace kestrel::compiler {

// An output or internal port of a node.
struct Source {
    int node = -1;
    std::string port;
    friend bool operator==(const Source&, const Source&) = default;
    friend auto operator<=>(const Source&, const Source&) = default;
};

// A use of a resource by a step, named as in its program; through a module too.
struct BoundUse {
    std::string name; // GLSL name, empty for accesses that no shader sees
    std::string path; // of the module that it is inherited through (graph/glsl_names.h)
    Source source;    // what is bound: an output or internal, `same` resolved
    Use use;
};

// A view block that a step's program may have.
struct BoundView {
    std::string name;
    bool previous = false;
    std::optional<Source> source;
    View view;
    Extent extent;
};

struct Node {
    const GraphPass* document = nullptr;
    const PassType* type = nullptr;
    std::shared_ptr<Pass> instance;
    std::map<std::string, Source, std::less<>> feeds; // connected input -> producer
    std::map<std::string, Location> feedWhere;

    std::string impossible; // why it cannot run in this world; empty if it can
    bool fallsBack = false; // cannot bear every demand (keepAll)
    Declaration full;       // with every demand
    Declaration real;       // with the real demand; empty unless live
    Inputs inputs;
    const Growth* grown = nullptr; // what its outputs needed before
    Demand demand = Demand::nothing();
    bool live = false;

    Causes possible = Causes::None;       // for which the steps can run over the timeline
    Causes modulePossible = Causes::None; // for which a consumer of its modules can run
    [[nodiscard]] bool everyFrame() const { return any(possible & Causes::Frame); }
    [[nodiscard]] const std::string& name() const { return document->name; }
};

struct Network {
    const Graph& graph;
    const CompileOptions& options;
    World world;                // with keepAll: of facts that promise nothing
    std::vector<Node> nodes;    // in the order of the document
    std::vector<int> order;     // topological
    std::vector<Source> wanted; // graph outputs and previews

    Node& at(int node) { return nodes[static_cast<size_t>(node)]; }
    [[nodiscard]] const Node& at(int node) const { return nodes[static_cast<size_t>(node)]; }
    [[nodiscard]] std::string text(const Source& source) const {
        return at(source.node).name() + "." + source.port;
    }
};

// ---- looking things up in declarations
const Output* findOutput(const Declaration& declaration, std::string_view port);
const Module* findModule(const Declaration& declaration, std::string_view port);
// The output as declared with the real demand, else with every demand; null if it is made with neither.
const Output* knownOutput(const Node& node, std::string_view port);
// What a producer's port really is: follows `same` to the output that has a resource (or module) of its own.
Source origin(const Network& network, Source source);
std::optional<Source> originOfInput(const Network& network, int node, std::string_view input);
// Whether `port` is an input of this pass.
bool isInput(const Node& node, std::string_view port);
// Where to point for a mistake that concerns this port or property.
Location placeOf(const Node& node, const std::string& port);

// ---- the stages
// resolve.cpp: names to nodes and ports, wanted ports, topological order.
Network resolve(const Graph& graph, const Registry& registry, const PassSet& passes, const World& world,
                const CompileOptions& options);
// Stable topological order: of the passes that could come next, the first in the document. `before[i]` holds
// the nodes that must come after node i. Empty if there is a cycle.
std::vector<int> topologicalOrder(const std::vector<std::set<int>>& before);

// demand.cpp: declares forward with every demand, then propagates the real demand backward and declares
// again, until neither changes. Throws InputError with all problems of live passes.
void settleDemand(Network& network);
// Its first part: every node that can run declares with every demand (Node::full).
void declareForwardWithEveryDemand(Network& network);
// What a node declares with its inputs, and what follows from them: what is the same as an input, or an input
// changed in place, has its descriptor; a module without an output entry provides nothing.
Declaration declare(const Network& network, const Node& node, Demand demand);
// The input ports that a declaration reads, with what it requests of modules.
void forEachRead(const Node& node, const Declaration& declaration, const Demand& demand,
                 const std::function<void(const std::string& port, Bits requests)>& visit);

// check_declaration.cpp: mistakes of a declaration against the pass's own tables and what is connected.
std::vector<DeclarationProblem> checkDeclaration(const Network& network, int node,
                                                 const Declaration& declaration, const Demand& demand);

// programs.cpp: uses inherited through modules, shader variants.
std::vector<BoundUse> boundUses(const Network& network, int node, const Step& step);
ProgramRequest programOf(const Network& network, int node, const Step& step);
std::vector<BoundView> viewsOf(const Network& network, int node, const Step& step);
// The nodes that stand behind an input: its producer; of a module also those whose resources it brings along.
std::set<int> producersBehind(const Network& network, int node, const std::string& input);

// order.cpp: the order of execution, and which in-place updates need a copy.
struct Order {
    std::vector<int> nodes;           // live ones, as executed
    std::map<Source, Source> inPlace; // an output that shares the resource of this source
};
Order orderPasses(const Network& network);

// resources.cpp: resources, bindings, steps and passes of the plan.
Plan allocateResources(const Network& network, const Order& order);

// left_out.cpp
std::vector<LeftOut> reportLeftOut(const Network& network);

} // namespace kestrel::compiler
