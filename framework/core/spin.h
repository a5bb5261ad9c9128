// A spin test of the machine, stated beside every measurement: shared machines change speed by the minute.
#pragma once

namespace kestrel {

// Milliseconds that the same fixed work takes on one thread, and on two threads at once (each doing all of
// it). On a machine that really has two free cores both are equal; about 20 ms each on a 2020s core.
struct SpinTest {
    double oneThreadMs = 0, twoThreadsMs = 0;
};

SpinTest measureSpin();

} // namespace kestrel
