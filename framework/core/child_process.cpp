#include "core/child_process.h"
#include "core/error.h"
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace kestrel {
namespace {

constexpr std::size_t maxSaid = 4096;

struct Pipe {
    int read = -1, write = -1;
};

// Both ends are closed in programs that are started later, and numbered beyond those that the child gets.
Pipe makePipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
        throw MachineError(fmt::format("no pipe to another process: {}", std::strerror(errno)));
    Pipe made{fcntl(ends[0], F_DUPFD_CLOEXEC, 10), fcntl(ends[1], F_DUPFD_CLOEXEC, 10)};
    close(ends[0]);
    close(ends[1]);
    return made;
}

void closeEnd(int& end) {
    if (end >= 0) close(end);
    end = -1;
}

// In the child: only calls that are safe between fork and exec.
[[noreturn]] void becomeProgram(const std::vector<char*>& words, int readsFrom, int writesTo, int says) {
    prctl(PR_SET_PDEATHSIG, SIGKILL); // what hangs does not outlive whoever waits for it
    const int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, 0);
    dup2(says, 1);
    dup2(says, 2);
    dup2(readsFrom, ChildProcess::readsFrom);
    dup2(writesTo, ChildProcess::writesTo);
    execv(words.front(), words.data());
    _exit(127);
}

} // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments) {
    std::vector<std::string> kept = arguments;
    std::vector<char*> words;
    words.reserve(kept.size() + 1);
    for (std::string& word : kept) words.push_back(word.data());
    words.push_back(nullptr);
    // Writing to a child that is gone is told by its return value.
    static_cast<void>(std::signal(SIGPIPE, SIG_IGN));

    Pipe in = makePipe(), out = makePipe(), says = makePipe();
    pid_ = fork();
    if (pid_ == 0) becomeProgram(words, in.read, out.write, says.write);
    closeEnd(in.read);
    closeEnd(out.write);
    closeEnd(says.write);
    toChild_ = in.write;
    fromChild_ = out.read;
    saidPipe_ = says.read;
    if (pid_ < 0)
        throw MachineError(fmt::format("no further process can be started: {}", std::strerror(errno)));
    fcntl(saidPipe_, F_SETFL, O_NONBLOCK);
}

ChildProcess::~ChildProcess() {
    closeEnd(toChild_);
    if (pid_ > 0) {
        kill(pid_, SIGKILL);
        ending();
    }
    closeEnd(fromChild_);
    closeEnd(saidPipe_);
}

bool ChildProcess::send(const std::string& line) {
    const std::string text = line + "\n";
    std::size_t sent = 0;
    while (sent < text.size()) {
        const ssize_t wrote = write(toChild_, text.data() + sent, text.size() - sent);
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote <= 0) return false;
        sent += static_cast<std::size_t>(wrote);
    }
    return true;
}

void ChildProcess::readSaid() {
    if (saidPipe_ < 0) return;
    std::array<char, 1024> some{};
    while (true) {
        const ssize_t got = read(saidPipe_, some.data(), some.size());
        if (got <= 0) return;
        said_.append(some.data(), static_cast<std::size_t>(got));
        if (said_.size() > maxSaid) said_.erase(0, said_.size() - maxSaid);
    }
}

std::optional<std::string> ChildProcess::receive(double seconds) {
    using Clock = std::chrono::steady_clock;
    constexpr double slice = 0.5, slack = 2; // seconds; a wait that took longer than both was none
    const double end = waited_ + seconds;
    while (true) {
        if (const size_t at = lines_.find('\n'); at != std::string::npos) {
            std::string line = lines_.substr(0, at);
            lines_.erase(0, at + 1);
            return line;
        }
        if (fromChild_ < 0) return std::nullopt;
        if (waited_ >= end) {
            timedOut_ = true;
            kill(pid_, SIGKILL);
            ending();
            closeEnd(fromChild_);
            return std::nullopt;
        }
        std::array<pollfd, 2> waits{{{fromChild_, POLLIN, 0}, {saidPipe_, POLLIN, 0}}};
        const auto begin = Clock::now();
        poll(waits.data(), 2, static_cast<int>(1e3 * std::min(slice, end - waited_)) + 1);
        waited_ += std::min(std::chrono::duration<double>(Clock::now() - begin).count(), slice + slack);
        if ((waits[1].revents & POLLIN) != 0) readSaid();
        if ((waits[0].revents & (POLLIN | POLLHUP | POLLERR)) == 0) {
            if ((waits[1].revents & POLLHUP) != 0) closeEnd(saidPipe_); // it would be told again and again
            continue;
        }
        std::array<char, 65536> some{};
        const ssize_t got = read(fromChild_, some.data(), some.size());
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0)
            closeEnd(fromChild_);
        else
            lines_.append(some.data(), static_cast<std::size_t>(got));
    }
}

std::string ChildProcess::ending() {
    if (pid_ <= 0) return ending_;
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    readSaid();
    if (WIFEXITED(status)) {
        exitStatus_ = WEXITSTATUS(status);
        ending_ = fmt::format("exit status {}", exitStatus_);
    } else {
        ending_ = fmt::format("signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
    }
    return ending_;
}

std::string ownProgram() { return std::filesystem::read_symlink("/proc/self/exe").string(); }

} // namespace kestrel
