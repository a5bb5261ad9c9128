#include "image/exr_layers.h"
#include "core/error.h"
#include "image/formats.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <optional>
#include <string_view>

namespace kestrel::detail {
namespace {

// All channels of one part and one layer's name.
struct Group {
    std::size_t part = 0;
    std::string prefix;                // without the last dot
    std::vector<std::string> channels; // full names
    std::vector<std::string> picture;  // those that make a picture, in the image's order; empty: none do
    bool colour = false;
    bool chroma = false;
};

std::string_view lastName(std::string_view channel) {
    const std::size_t dot = channel.rfind('.');
    return dot == std::string_view::npos ? channel : channel.substr(dot + 1);
}

// The group's channel of this upper-case name, else of the same name in lower case.
std::optional<std::string> find(const Group& group, std::string_view letters) {
    std::string lower;
    for (const char letter : letters) lower += static_cast<char>(letter - 'A' + 'a');
    for (const std::string_view wanted : {letters, std::string_view(lower)})
        for (const std::string& channel : group.channels)
            if (lastName(channel) == wanted) return channel;
    return std::nullopt;
}

void findPicture(Group& group) {
    struct Kind {
        std::vector<std::string_view> channels;
        bool colour = false;
        bool chroma = false;
    };
    static const std::vector<Kind> kinds{{{"R", "G", "B", "A"}, true},
                                         {{"R", "G", "B"}, true},
                                         {{"Y", "RY", "BY", "A"}, true, true},
                                         {{"Y", "RY", "BY"}, true, true},
                                         {{"R", "G"}},
                                         {{"X", "Y", "Z"}},
                                         {{"X", "Y"}},
                                         {{"Y"}}};
    for (const Kind& kind : kinds) {
        std::vector<std::string> found;
        for (const std::string_view letters : kind.channels)
            if (const auto channel = find(group, letters)) found.push_back(*channel);
        if (found.size() != kind.channels.size()) continue;
        group.picture = found;
        group.colour = kind.colour;
        group.chroma = kind.chroma;
        return;
    }
    if (group.channels.size() == 1) group.picture = group.channels;
}

std::string quoted(const std::vector<std::string>& names) {
    std::vector<std::string> result;
    constexpr std::size_t most = 24; // a line that can be read
    for (std::size_t i = 0; i < std::min(names.size(), most); ++i) result.push_back("'" + names[i] + "'");
    if (names.size() > most) result.push_back(fmt::format("and {} more", names.size() - most));
    return fmt::format("{}", fmt::join(result, ", "));
}

class Chooser {
public:
    Chooser(const std::vector<ExrPart>& parts, const std::string& name)
        : parts_(parts)
        , name_(name) {
        for (std::size_t part = 0; part < parts.size(); ++part) {
            if (parts[part].deep) continue;
            std::map<std::string, Group> groups;
            for (const std::string& channel : parts[part].channels) {
                const std::size_t dot = channel.rfind('.');
                const std::string prefix = dot == std::string::npos ? "" : channel.substr(0, dot);
                groups[prefix].channels.push_back(channel);
            }
            for (auto& [prefix, group] : groups) {
                group.part = part;
                group.prefix = prefix;
                findPicture(group);
                groups_.push_back(std::move(group));
            }
        }
    }

    ExrLayer choose(const std::string& wanted) const {
        if (groups_.empty()) failImage(name_, "is an EXR of deep data alone, which is not read");
        if (wanted.empty()) return chooseAmong(all());
        if (const Groups named = groupsNamed(wanted); !named.empty()) {
            if (named.size() > 1) failSeveral(named, fmt::format(" called '{}'", wanted));
            if (named[0]->picture.empty())
                failImage(name_, fmt::format("has in the layer '{}' the channels {}: neither RGB nor XYZ nor "
                                             "a single one",
                                             wanted, quoted(named[0]->channels)));
            return layerOf(*named[0]);
        }
        if (const Groups part = groupsOfPart(wanted); !part.empty()) return chooseAmong(part);
        if (const auto channel = channelNamed(wanted)) return *channel;
        failUnknown(wanted);
    }

private:
    using Groups = std::vector<const Group*>;

    [[nodiscard]] Groups all() const {
        Groups result;
        for (const Group& group : groups_) result.push_back(&group);
        return result;
    }

    // A layer's name where several parts may have one of the same name.
    [[nodiscard]] std::string fullName(const Group& group) const {
        if (parts_.size() == 1) return group.prefix.empty() ? parts_[0].view : group.prefix;
        const std::string& part = parts_[group.part].name;
        if (group.prefix.empty() || group.prefix == part) return part;
        return part + "." + group.prefix;
    }

    [[nodiscard]] ExrLayer layerOf(const Group& group, bool chosen = false) const {
        return {group.part, fullName(group), group.picture, group.chroma, chosen};
    }

    [[nodiscard]] ExrLayer chooseAmong(const Groups& groups) const {
        for (const bool colour : {true, false})
            for (const bool named : {false, true}) {
                Groups rank;
                for (const Group* group : groups)
                    if (group->colour == colour && !group->picture.empty() && group->prefix.empty() != named)
                        rank.push_back(group);
                if (rank.size() == 1) return layerOf(*rank[0], named || groups.size() > 1);
                if (rank.size() > 1) failSeveral(rank, "");
            }
        std::vector<std::string> channels;
        for (const Group* group : groups)
            channels.insert(channels.end(), group->channels.begin(), group->channels.end());
        failImage(name_,
                  fmt::format("has the channels {}: neither RGB nor XYZ nor a single one", quoted(channels)));
    }

    [[nodiscard]] Groups groupsNamed(const std::string& wanted) const {
        Groups exact, bySomeName;
        for (const Group& group : groups_) {
            if (fullName(group) == wanted) exact.push_back(&group);
            if (group.prefix == wanted) bySomeName.push_back(&group);
        }
        return exact.empty() ? bySomeName : exact;
    }

    [[nodiscard]] Groups groupsOfPart(const std::string& wanted) const {
        Groups result;
        for (const Group& group : groups_)
            if (parts_[group.part].name == wanted) result.push_back(&group);
        return result;
    }

    [[nodiscard]] std::optional<ExrLayer> channelNamed(const std::string& wanted) const {
        std::vector<ExrLayer> found;
        for (const Group& group : groups_)
            for (const std::string& channel : group.channels) {
                const std::string full = parts_[group.part].name + "." + channel;
                if (channel == wanted || (parts_.size() > 1 && full == wanted))
                    found.push_back({group.part, full, {channel}});
            }
        if (found.empty()) return std::nullopt;
        std::vector<std::string> names;
        names.reserve(found.size());
        for (const ExrLayer& layer : found) names.push_back(layer.name);
        if (found.size() > 1)
            failImage(name_, fmt::format("has the channel '{}' in several parts: {}", wanted, quoted(names)));
        found[0].name = wanted;
        return found[0];
    }

    // The names by which pictures of this file can be asked for.
    [[nodiscard]] std::vector<std::string> namesOf(const Groups& groups) const {
        std::vector<std::string> names;
        for (const Group* group : groups)
            if (!group->picture.empty() && !fullName(*group).empty()) names.push_back(fullName(*group));
        return names;
    }

    [[noreturn]] void failSeveral(const Groups& groups, const std::string& what) const {
        const std::vector<std::string> names = namesOf(groups);
        failImage(name_, fmt::format("has several layers{}: {}; name one as in '{}:{}'", what, quoted(names),
                                     name_, names.empty() ? "" : names[0]));
    }

    [[noreturn]] void failUnknown(const std::string& wanted) const {
        for (const ExrPart& part : parts_)
            if (part.deep && part.name == wanted)
                failImage(name_, fmt::format("holds deep data in the part '{}', which is not read", wanted));
        std::vector<std::string> names = namesOf(all());
        const std::string has = names.empty()
                                    ? fmt::format("it has the channels {}", quoted(groups_[0].channels))
                                    : fmt::format("it has {}", quoted(names));
        failImage(name_, fmt::format("has no layer '{}'{}; {}", wanted, didYouMean(wanted, names), has));
    }

    const std::vector<ExrPart>& parts_;
    const std::string& name_;
    std::vector<Group> groups_;
};

} // namespace

ExrLayer chooseLayer(const std::vector<ExrPart>& parts, const std::string& wanted, const std::string& name) {
    return Chooser(parts, name).choose(wanted);
}

} // namespace kestrel::detail
