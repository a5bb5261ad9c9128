// The drivers' program binaries on disk.
#pragma once
#include "gl/objects.h"
#include "shader/compose.h"
#include <filesystem>
#include <string>
#include <vector>

namespace kestrel::gl {

class ProgramCache {
public:
    // For one program on the present driver; does nothing where the cache is off or the driver has no binary
    // format.
    ProgramCache(const ComposedProgram& composed, const std::vector<std::string>& attachments);

    // Loads the binary into `program`; false if there is none that the driver takes.
    [[nodiscard]] bool load(Name program) const;
    // Call before linking what is to be stored.
    void prepare(Name program) const;
    // A cache that cannot be written is a warning: the program is there all the same.
    void store(Name program) const;

private:
    std::string key_; // all that the binary depends on
    std::filesystem::path file_;
};

} // namespace kestrel::gl
