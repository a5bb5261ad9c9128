// What the graph costs: times by pass with their history, resources over the passes, what was left out and
// why.
#pragma once
#include "session.h"
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace kestrel::edit {

class Numbers {
public:
    void showTimes(const Session& session);
    // A click on a resource asks for memory of its own for it, or takes it back.
    void showResources(const Session& session, const std::function<void(const PortRef&)>& apart);
    void showLeftOut(const Session& session, const std::function<void(const std::string&)>& goTo);
    // Takes the last frame in; once a frame.
    void add(const Session& session);

private:
    static constexpr size_t kept = 120;                 // frames of a history
    std::map<std::string, std::vector<float>> history_; // by pass; "" is the frame
    std::uint64_t frame_ = 0;
};

} // namespace kestrel::edit
