#include "execute/property_files.h"
#include "image/io.h"
#include <algorithm>
#include <string>
#include <variant>

namespace kestrel {

std::filesystem::path propertyFile(const PropertyInfo& property, const Pass& pass) {
    if (property.unit != "file") return {};
    return imageName(std::get<std::string>(property.get(pass))).file;
}

PropertyFiles propertyFiles(const PassSet& passes, const Graph& graph, const Registry& registry) {
    PropertyFiles files;
    for (const GraphPass& pass : graph.passes)
        for (const PropertyInfo& property : registry.find(pass.type)->properties)
            if (std::filesystem::path file = propertyFile(property, *passes.at(pass.name)); !file.empty())
                files[file] = fileState(file);
    return files;
}

bool changed(const PropertyFiles& files) {
    return std::ranges::any_of(files, [](const auto& file) { return fileState(file.first) != file.second; });
}

} // namespace kestrel
