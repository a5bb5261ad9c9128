// Which channels of an EXR are the picture. A channel's name up to its last dot is its layer (OpenEXR,
// "Technical Introduction", on layers); a file of several parts names those too.
#pragma once
#include <string>
#include <vector>

namespace kestrel::detail {

// What a file says of its parts.
struct ExrPart {
    std::string name;
    std::vector<std::string> channels;
    bool deep = false;
    std::string view = {}; // the eye, say, that channels without a layer's name are seen with
};

// Channels of one part that make a picture together.
struct ExrLayer {
    std::size_t part = 0;
    std::string name;                  // as messages call it; may be empty
    std::vector<std::string> channels; // their full names, in the image's order
    bool chroma = false;               // channels are Y, RY, BY and perhaps A
    bool chosen = false;               // because it is the only one, not for lack of a name nor by request
};

// The layer, part or channel called `wanted`; if that is empty, the one that is there to be taken: colours
// without a layer's name before colours of a layer, and these before anything else. Throws InputError whose
// location is `name` if there is none, or several of one rank: then with the names to choose from.
ExrLayer chooseLayer(const std::vector<ExrPart>& parts, const std::string& wanted, const std::string& name);

} // namespace kestrel::detail
