// A linked program whose resources are bound by name.
#pragma once
#include "gl/objects.h"
#include "shader/compose.h"
#include <map>
#include <optional>

namespace kestrel::gl {

void deleteProgram(Name name);

class Program {
public:
    // Compiles and links, or takes the driver's binary from the cache folder (key: composed text, driver). A
    // fragment output out_X is put at the place of X in `attachments`. Every sampler and image gets a unit of
    // its own, every uniform and storage block a binding of its own; more than the device has is an
    // InputError that names need and limit. Compile errors are an InputError with file:line and the source
    // line.
    Program(const ComposedProgram& composed, const std::vector<std::string>& attachments,
            const Capabilities& capabilities);

    [[nodiscard]] Name name() const { return handle_.get(); }
    [[nodiscard]] glm::uvec3 localSize() const { return localSize_; } // of a compute program
    void use() const;

    struct Slot {
        enum class Kind : std::uint8_t { Sampler, Image, UniformBlock, StorageBlock } kind = Kind::Sampler;
        unsigned int unit = 0;
        bool array3D = false;
    };
    // Where a name is bound; absent if the linked program does not use it.
    [[nodiscard]] std::optional<Slot> slot(std::string_view name) const;
    [[nodiscard]] std::vector<std::string> slotNames() const;
    // Location of a plain uniform, -1 if the linked program does not use it.
    [[nodiscard]] int uniform(std::string_view name) const;
    // Whether the composed text mentions the name at all: tells an optimised-out resource from a misspelt
    // one.
    [[nodiscard]] bool mentions(std::string_view name) const;

private:
    Handle<deleteProgram> handle_;
    glm::uvec3 localSize_{1};
    std::map<std::string, Slot, std::less<>> slots_;
    std::map<std::string, int, std::less<>> uniforms_;
    std::string text_;
};

// Folder of the binary cache; empty switches it off. Default: $KESTREL_CACHE, or kestrel/ in the user's cache
// folder.
void setProgramCache(const std::string& folder);

} // namespace kestrel::gl
