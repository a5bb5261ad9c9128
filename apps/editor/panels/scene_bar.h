// What the picture is seen from and when: the scene's cameras, one's own, and the time line.
#pragma once
#include "session.h"
#include <functional>
#include <string>

namespace kestrel::edit {

class SceneBar {
public:
    // One line, and a second where the scene moves.
    void show(Session& session, const std::function<void(const std::string&)>& say);
    static void copyCamera(Session& session, const std::function<void(const std::string&)>& say);
    // One time step on, or back with -1; the time stands then.
    static void step(Session& session, int by);

private:
    static void showTime(Session& session);
};

} // namespace kestrel::edit
