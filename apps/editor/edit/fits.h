// What goes with what: which types offer a port that fits, and what becomes of a pass's edges when another
// type takes its place.
#pragma once
#include "edit/commands.h"

namespace kestrel::edit {

// A port of a pass type that the end of a wire could go to.
struct Offer {
    std::string type, port;
    std::string description; // of the type
    friend bool operator==(const Offer&, const Offer&) = default;
};
// For a wire that was pulled out of `port`, an output or an input, into the empty: every type with a port
// that fits it, the first such port of each, sorted by name.
std::vector<Offer> offersFor(const Graph& graph, const Registry& registry, const PortRef& port);

// For a wire that was dropped on a pass: its one port that fits. Of several those that nothing feeds go
// first, then required ones; nothing if none fits or several are left.
std::optional<PortRef> fittingPort(const Graph& graph, const Registry& registry, const PortRef& port,
                                   const std::string& pass);

// Adds a pass of an offered type and joins it with `port`; its name.
std::string addJoined(Graph& graph, const Registry& registry, const PortRef& port, const Offer& offer,
                      glm::dvec2 position);

// Types that can stand in the place of a pass: those with every module output of it that somebody reads, or
// with none read, that have a module output in common; of a pass without modules those whose outputs that are
// read they have by name and kind. Without its own type, sorted.
std::vector<std::string> rivalTypes(const Graph& graph, const Registry& registry, const std::string& pass);
// Passes of the graph that provide what somebody reads of this one: "use that instead" moves the readers.
std::vector<std::string> rivalPasses(const Graph& graph, const Registry& registry, const std::string& pass);

struct Swapped {
    std::vector<std::string> kept; // edges, "a.x -> b.y"
    std::vector<std::string>
        dropped; // edges and properties that the new type cannot take, each with the reason
};
// The pass becomes one of another type under its name and place. Edges stay where a port of the same name, or
// the first free one of the kind, takes them; properties of the same name stay where their value is legal.
Swapped swapType(Graph& graph, const Registry& registry, const std::string& pass, const std::string& type);
// Who reads `pass` reads `rival` from now on.
Swapped useInstead(Graph& graph, const Registry& registry, const std::string& pass, const std::string& rival);

} // namespace kestrel::edit
