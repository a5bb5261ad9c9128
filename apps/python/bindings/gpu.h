// The thread that OpenGL lives on. A context belongs to one thread, and notebooks call from whichever they
// like; so all that touches it is done by a thread of its own, one thing after the other.
#pragma once
#include "gl/context.h"
#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <thread>

namespace kestrel::python {

class Gpu {
public:
    using Work = std::function<void(Gpu&)>;

    // Of the process; made when it is first asked for. Throws MachineError in a process that was forked off
    // one that has it, since threads do not come along, and once the interpreter ends.
    static Gpu& get();
    // Ends what there is: renderers, the context, the thread.
    static void stop();

    // Does it there, and waits with the interpreter's lock released; what it throws comes out here. The
    // context is made before the first time (MachineError). On an interrupt of the interpreter (Ctrl-C)
    // interrupted() is true until the work is done, and KeyboardInterrupt is thrown then. Throws InputError
    // when called by a progress function (Callback).
    void run(const Work& work);
    // Does it there some time later; nothing is waited for. For destructors. False where nothing is done any
    // more: the interpreter ends, or this process was forked off.
    static bool post(Work work);
    [[nodiscard]] bool interrupted() const { return interrupted_; }
    // For run() alone.
    [[nodiscard]] gl::Context& context() { return *context_; }

    // What must be gone before the context is, emptied by stop(). For run() and post() alone.
    struct Guest {
        virtual ~Guest() = default;
        virtual void leave() = 0;
    };
    std::set<Guest*> guests;

private:
    Gpu();
    void add(Work work);
    void loop();

    int process_;
    std::mutex mutex_;
    std::condition_variable come_;
    std::deque<Work> works_;
    bool stopping_ = false;
    std::atomic<bool> interrupted_ = false;
    std::unique_ptr<gl::Context> context_;
    std::thread thread_;
};

} // namespace kestrel::python
