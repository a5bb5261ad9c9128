// A picture from a file: a captured G-buffer, a reference of another renderer.
#pragma once
#include "core/file_state.h"
#include "graph/registry.h"
#include "image/image.h"
#include <memory>
#include <optional>
#include <string>

namespace kestrel {

class ImageFile final : public Pass {
public:
    enum class Values { Auto, AsTheyAre, FromSrgb };

    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    std::string file;
    Values values = Values::Auto;
    int guard = 0;

private:
    // The file as it was read last; read again where it is another file or was written since. A plan's step
    // holds the picture whose size it was compiled with, whatever is written meanwhile.
    struct Read {
        std::string name;
        Values values = Values::Auto;
        std::optional<FileState> state;
        Image image;
    };
    [[nodiscard]] std::shared_ptr<const Read> read() const; // throws InputError
    mutable std::shared_ptr<const Read> read_;
};

} // namespace kestrel
