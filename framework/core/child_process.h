// A program that runs beside this one and is talked to in lines: what may crash or hang runs there.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

// Lines go to the child through one pipe and come back through another; its standard input is empty, its
// standard output and standard error are gathered.
class ChildProcess {
public:
    // The descriptors on which the child reads and writes its lines.
    static constexpr int readsFrom = 3, writesTo = 4;

    // Starts `arguments[0]` (a path) with the rest as its arguments. Throws MachineError if that cannot be
    // done.
    explicit ChildProcess(const std::vector<std::string>& arguments);
    ~ChildProcess(); // ends it, if it still runs
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    // False if the child is gone. `line` has no line break.
    bool send(const std::string& line);
    // The next line; nothing if the child ended first, or nothing came for that long: the child is ended
    // then, and timedOut() says so.
    std::optional<std::string> receive(double seconds);
    [[nodiscard]] bool timedOut() const { return timedOut_; }
    // Seconds spent in receive() so far. Time in which this process was stopped itself, with its child most
    // likely, does not count, there and in the limit.
    [[nodiscard]] double waited() const { return waited_; }

    // How it ended, in words: "exit status 3", "signal 11 (Segmentation fault)". Waits until it has.
    std::string ending();
    // Its exit status once it has ended by itself, else -1.
    [[nodiscard]] int exitStatus() const { return exitStatus_; }
    // The last that it said on standard output and standard error, at most 4096 bytes.
    [[nodiscard]] const std::string& said() const { return said_; }

private:
    void readSaid();

    int pid_ = -1, toChild_ = -1, fromChild_ = -1, saidPipe_ = -1;
    bool timedOut_ = false;
    double waited_ = 0;
    int exitStatus_ = -1;
    std::string ending_, lines_, said_;
};

// The file of the running program.
std::string ownProgram();

} // namespace kestrel
