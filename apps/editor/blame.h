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
    Fault fault = Fault::None;     // there
    PortRef port;                  // that holds it first; its pass made it
    int x = 0, y = 0;              // there
    std::vector<std::string> path; // ports from the one that was asked about to that one
    std::string why;               // in words: what of the pass's inputs was right
};

// Walks from `port` back through the passes that feed it, as long as an input is as wrong or worse near the
// place (in proportion, if its size is another): a black pixel may come of one that is no number. Of
// directions, depths and motion only what is no number or infinite is wrong. Behind modules such texels count
// wherever they are, since a ray may have fetched them anywhere; but what a pass reads there goes first.
// Renders from the first frame on, with all ports readable, up to the frame in which the pixel became so;
// what is seen does not change. Of a pixel that is right, since it was clamped so perhaps, what lies behind
// it is looked at for what is no number or infinite. Nothing if there is none, or the pixel is right when
// rendered again.
std::optional<Blame> blame(Session& session, const PortRef& port, int x, int y);

} // namespace kestrel::edit
