// What a command line names, for all programs: the graph, the size, the pass types that are there.
#pragma once
#include "graph/registry.h"
#include <filesystem>
#include <string>
#include <vector>

namespace kestrel {

// The file of a graph: as it is named, else among those that come with Kestrel; "-" is standard input. Throws
// InputError with the near name.
std::filesystem::path graphFile(const std::string& graph);

// "640x360". Throws InputError for anything else, for 0 and for sides above 16384.
Extent parseSize(const std::string& text);

// All pass types of the plugins that are there. A plugin that can't be used is told and skipped. Lives until
// the process ends; the editor puts types in it whose plugin was built anew.
Registry& loadedRegistry();

// The plugins, by name, whose shaders are there and which are not: those that a build left out
// (KESTREL_PASSES).
std::vector<std::string> absentPlugins();

} // namespace kestrel
