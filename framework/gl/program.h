// A linked program whose resources are bound by name.
#pragma once
#include "gl/objects.h"
#include "shader/compose.h"
#include <map>
#include <optional>
#include <set>

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
        unsigned int unit = 0; // texture unit, image unit, or binding point of its kind of block
        bool array3D = false;  // an array, cube or 3D sampler or image: all layers are bound
        bool texels = false;   // samplerBuffer or imageBuffer: a buffer's texelView() is bound
        int count = 1;         // of an array `x[count]`: as many consecutive units
    };
    // Where a name is bound; absent if the linked program does not use it. An array of samplers or images is
    // named without brackets; of an array of blocks each element is a name of its own, "x[1]".
    [[nodiscard]] std::optional<Slot> slot(std::string_view name) const;
    [[nodiscard]] std::vector<std::string> slotNames() const;
    // Location of a plain uniform, -1 if the linked program does not use it.
    [[nodiscard]] int uniform(std::string_view name) const;
    // Whether the composed text mentions the name at all: tells an optimised-out resource from a misspelt
    // one.
    [[nodiscard]] bool mentions(std::string_view name) const;
    // Whether the driver's binary came from the cache.
    [[nodiscard]] bool fromCache() const { return fromCache_; }

private:
    void readResources(const ComposedProgram& composed, const Capabilities& capabilities);

    Handle<deleteProgram> handle_;
    glm::uvec3 localSize_{1};
    std::map<std::string, Slot, std::less<>> slots_;
    std::map<std::string, int, std::less<>> uniforms_;
    std::vector<std::string> texts_; // of the stages, until mentions() is asked
    mutable std::optional<std::set<std::string, std::less<>>> identifiers_;
    bool fromCache_ = false;
};

// Folder of the binary cache; empty switches it off. Default: $KESTREL_CACHE (empty: off), or kestrel/ in the
// user's cache folder ($XDG_CACHE_HOME, ~/.cache). Files that are damaged or of another driver are ignored
// and written anew.
void setProgramCache(const std::string& folder);

} // namespace kestrel::gl
