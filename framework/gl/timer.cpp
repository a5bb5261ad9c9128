#include "gl/timer.h"
#include "core/check.h"
#include "core/error.h"
#include "gl/loader.h"
#include <fmt/format.h>

namespace kestrel::gl {

void deleteQuery(Name name) { glDeleteQueries(1, &name); }

StepClock::Kind StepClock::kindFromName(const std::string& name) {
    if (name == "finish") return Kind::Finish;
    if (name == "timer_query") return Kind::TimerQuery;
    throw InputError(fmt::format("unknown clock '{}'{}; there are finish and timer_query", name,
                                 didYouMean(name, {"finish", "timer_query"})));
}

Handle<deleteQuery> StepClock::query() {
    if (!spare_.empty()) {
        Handle<deleteQuery> reused = std::move(spare_.back());
        spare_.pop_back();
        return reused;
    }
    Name name = 0;
    glCreateQueries(GL_TIMESTAMP, 1, &name);
    return Handle<deleteQuery>(name);
}

void StepClock::beginFrame(std::uint64_t frame) {
    KESTREL_CHECK(!isOpen_);
    frame_ = frame;
    collect(false);
}

void StepClock::begin(std::uint32_t step) {
    KESTREL_CHECK(!isOpen_);
    isOpen_ = true;
    open_ = {frame_, step, 0};
    if (kind_ == Kind::Finish) {
        glFinish();
        start_ = std::chrono::steady_clock::now();
    } else {
        startQuery_ = query();
        glQueryCounter(startQuery_.get(), GL_TIMESTAMP);
    }
}

void StepClock::end() {
    KESTREL_CHECK(isOpen_);
    isOpen_ = false;
    if (kind_ == Kind::Finish) {
        glFinish();
        open_.ms =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
        known_.push_back(open_);
    } else {
        Handle<deleteQuery> second = query();
        glQueryCounter(second.get(), GL_TIMESTAMP);
        pending_.push_back({open_, std::move(startQuery_), std::move(second)});
    }
}

void StepClock::collect(bool wait) {
    size_t done = 0;
    for (; done < pending_.size(); ++done) {
        Pending& pending = pending_[done];
        GLint available = 0;
        glGetQueryObjectiv(pending.second.get(), GL_QUERY_RESULT_AVAILABLE, &available);
        if (available == 0 && !wait) break;
        GLuint64 first = 0;
        GLuint64 second = 0;
        glGetQueryObjectui64v(pending.first.get(), GL_QUERY_RESULT, &first);
        glGetQueryObjectui64v(pending.second.get(), GL_QUERY_RESULT, &second);
        constexpr double nanosecondsPerMs = 1e6;
        pending.sample.ms = static_cast<double>(second - first) / nanosecondsPerMs;
        known_.push_back(pending.sample);
        spare_.push_back(std::move(pending.first));
        spare_.push_back(std::move(pending.second));
    }
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(done));
}

std::vector<StepClock::Sample> StepClock::take(bool wait) {
    if (wait) collect(true);
    return std::exchange(known_, {});
}

} // namespace kestrel::gl
