#include "gpu.h"
#include "bindings.h"
#include "core/error.h"
#include <chrono>
#include <exception>
#include <optional>
#include <unistd.h>

namespace kestrel::python {
namespace {

// Never destroyed: stop() ends it, and an interpreter that ends otherwise needs nothing of it. In the
// interpreter's lock.
Gpu* only = nullptr;
bool ended = false;

} // namespace

Gpu::Gpu()
    : process_(getpid())
    , thread_([this] { loop(); }) {}

Gpu& Gpu::get() {
    if (ended) throw MachineError("the interpreter is ending: nothing is rendered any more");
    if (only == nullptr) only = new Gpu;
    if (only->process_ != getpid())
        throw MachineError(
            "this process was forked off one that renders, and OpenGL does not come along: use "
            "multiprocessing's start method 'spawn'");
    return *only;
}

void Gpu::stop() {
    ended = true;
    if (only == nullptr || only->process_ != getpid()) return;
    const py::gil_scoped_release unlocked;
    {
        const std::lock_guard lock(only->mutex_);
        only->stopping_ = true;
    }
    only->come_.notify_one();
    only->thread_.join();
}

void Gpu::loop() {
    while (true) {
        Work work;
        {
            std::unique_lock lock(mutex_);
            come_.wait(lock, [&] { return stopping_ || !works_.empty(); });
            if (works_.empty()) break;
            work = std::move(works_.front());
            works_.pop_front();
        }
        work(*this);
    }
    for (Guest* guest : guests) guest->leave();
    context_.reset();
}

bool Gpu::post(Work work) {
    if (ended || only == nullptr || only->process_ != getpid()) return false;
    only->add(std::move(work));
    return true;
}

void Gpu::add(Work work) {
    {
        const std::lock_guard lock(mutex_);
        works_.push_back(std::move(work));
    }
    come_.notify_one();
}

void Gpu::run(const Work& work) {
    if (Callback::running())
        throw InputError("a progress function runs within a frame: it cannot ask the renderer for anything");
    std::exception_ptr failure;
    std::optional<py::error_already_set> interrupt;
    std::mutex mutex;
    std::condition_variable finished;
    bool done = false;
    {
        const py::gil_scoped_release unlocked;
        add([&](Gpu& gpu) {
            try {
                if (!gpu.context_) gpu.context_ = gl::Context::create();
                work(gpu);
            } catch (...) {
                failure = std::current_exception();
            }
            const std::lock_guard lock(mutex);
            done = true;
            finished.notify_one();
        });
        std::unique_lock lock(mutex);
        while (!finished.wait_for(lock, std::chrono::milliseconds(100), [&] { return done; })) {
            lock.unlock();
            {
                const py::gil_scoped_acquire locked;
                if (!interrupt && PyErr_CheckSignals() != 0) {
                    interrupt.emplace();
                    interrupted_ = true;
                }
            }
            lock.lock();
        }
    }
    if (interrupt) {
        interrupted_ = false;
        throw py::error_already_set(*interrupt);
    }
    if (failure) std::rethrow_exception(failure);
}

} // namespace kestrel::python
