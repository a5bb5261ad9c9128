// The JSON schema of sweep files, for editors and for checks that need no Kestrel.
#pragma once
#include <string>

namespace kestrel {

// JSON Schema 2020-12 of what parseSweep takes ("kestrel_sweep": 1), with the same keys and bounds. What a
// schema cannot say (names used twice, axes that are not there, graphs) parseSweep and checkSweep do.
std::string sweepSchema();

} // namespace kestrel
