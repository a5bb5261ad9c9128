// From a pixel that is wrong to the pass and port that made it so first.
#pragma once
#include "session.h"
#include <optional>
#include <string>
#include <vector>

namespace kestrel::edit {

enum class Fault { None, NotANumber, Infinite, Negative, Black };
[[nodiscard]] const char* faultName(Fault fault); // "not a number"…

// What is wrong with a pixel; the worst if several are. Black is 0 in every channel of a colour but alpha.
Fault faultAt(const Image& image, int x, int y);

struct Blame {
    Fault fault = Fault::None;
    PortRef port;                  // that holds it first; its pass made it
    int x = 0, y = 0;              // there
    std::vector<std::string> path; // ports from the one that was asked about to that one
    std::string why;               // in words: what of the pass's inputs was right
};

// Walks from `port` back through the passes that feed it, as long as an input has the same fault near the
// place (in proportion, if its size is another). Behind modules every texture of their providers counts,
// wherever it has the fault, since a ray may have fetched it anywhere. Renders the present frame once more
// with all ports on the way readable; what is seen does not change. Nothing if the pixel is right.
std::optional<Blame> blame(Session& session, const PortRef& port, int x, int y);

} // namespace kestrel::edit
