#include "blame.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace kestrel::edit {
namespace {

struct Place {
    int x = 0, y = 0;
};

// Within a pixel of the place, since filters and rounding move things.
std::optional<Place> near(const Image& image, Place place, Fault fault) {
    for (int reach = 0; reach <= 1; ++reach)
        for (int y = place.y - reach; y <= place.y + reach; ++y)
            for (int x = place.x - reach; x <= place.x + reach; ++x)
                if (x >= 0 && y >= 0 && x < image.width && y < image.height && faultAt(image, x, y) == fault)
                    return Place{x, y};
    return {};
}

std::optional<Place> anywhere(const Image& image, Fault fault) {
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (faultAt(image, x, y) == fault) return Place{x, y};
    return {};
}

class Search {
public:
    Search(Session& session, Fault fault)
        : session_(session)
        , plan_(session.renderer()->plan())
        , fault_(fault) {}

    Blame from(const PortRef& port, Place place) {
        Blame found;
        found.fault = fault_;
        PortRef at = port;
        while (true) {
            found.path.push_back(at.text());
            found.port = at;
            found.x = place.x;
            found.y = place.y;
            if (!seen_.insert(at).second) break; // a history leads back
            const std::optional<std::pair<PortRef, Place>> next = input(at, place);
            if (!next) break;
            at = next->first;
            place = next->second;
        }
        found.why = fmt::format("{} of '{}' is {} there, and nothing that it reads is", found.port.port,
                                found.port.pass, faultName(fault_));
        return found;
    }

private:
    // The pass whose steps make a port, after `same` and shared resources.
    [[nodiscard]] const PlanPass* maker(const PortRef& port) const {
        for (const PlanPass& pass : plan_.passes)
            if (pass.name == port.pass) return &pass;
        return nullptr;
    }
    [[nodiscard]] PortRef ownerOf(int resource) const {
        return plan_.resources[static_cast<size_t>(resource)].port;
    }

    std::optional<std::pair<PortRef, Place>> input(const PortRef& port, Place place) {
        const PlanPass* pass = maker(port);
        const PassType* type = pass != nullptr ? session_.registry().find(pass->type) : nullptr;
        if (type == nullptr) return {};
        std::string why;
        const Image here = session_.read(port, why);
        for (const PortInfo& info : type->ports) {
            if (info.direction != PortDirection::Input) continue;
            if (isModule(info.kind)) {
                if (auto found = behindModule(*pass, info.name)) return found;
                continue;
            }
            const auto held = pass->ports.find(info.name);
            if (held == pass->ports.end() || held->second < 0 || info.kind != PortKind::Texture) continue;
            const PortRef source = ownerOf(held->second);
            const Image image = session_.read(source, why);
            if (image.empty() || source == port) continue;
            const Place there{place.x * image.width / std::max(here.width, 1),
                              place.y * image.height / std::max(here.height, 1)};
            if (const auto found = near(image, there, fault_)) return std::pair(source, *found);
        }
        return {};
    }

    // Black is no fault of what a ray may fetch anywhere.
    std::optional<std::pair<PortRef, Place>> behindModule(const PlanPass& pass, const std::string& input) {
        const auto behind = pass.inputPasses.find(input);
        if (fault_ == Fault::Black || behind == pass.inputPasses.end()) return {};
        for (const int index : behind->second) {
            const PlanPass& provider = plan_.passes[static_cast<size_t>(index)];
            for (const auto& [name, resource] : provider.ports) {
                const PassType* type = session_.registry().find(provider.type);
                const PortInfo* info = type != nullptr ? type->port(name) : nullptr;
                if (info == nullptr || info->direction == PortDirection::Input ||
                    info->kind != PortKind::Texture)
                    continue;
                std::string why;
                const PortRef port{provider.name, name};
                const Image image = session_.read(port, why);
                if (const auto found = anywhere(image, fault_)) return std::pair(port, *found);
            }
        }
        return {};
    }

    Session& session_;
    const Plan& plan_;
    Fault fault_;
    std::set<PortRef> seen_;
};

} // namespace

const char* faultName(Fault fault) {
    switch (fault) {
    case Fault::NotANumber:
        return "not a number";
    case Fault::Infinite:
        return "infinite";
    case Fault::Negative:
        return "negative";
    case Fault::Black:
        return "black";
    case Fault::None:
        break;
    }
    return "right";
}

Fault faultAt(const Image& image, int x, int y) {
    bool infinite = false, negative = false, black = true;
    for (int c = 0; c < image.channels; ++c) {
        const float value = image.at(x, y, c);
        if (std::isnan(value)) return Fault::NotANumber;
        infinite = infinite || std::isinf(value);
        negative = negative || value < 0;
        black = black && (c == 3 || value == 0);
    }
    return infinite ? Fault::Infinite : negative ? Fault::Negative : black ? Fault::Black : Fault::None;
}

std::optional<Blame> blame(Session& session, const PortRef& port, int x, int y) {
    std::string why;
    const Image image = session.read(port, why);
    if (image.empty() || x < 0 || y < 0 || x >= image.width || y >= image.height) return {};
    const Fault fault = faultAt(image, x, y);
    if (fault == Fault::None) return {};
    // All that the plan makes becomes readable, for one frame that is the present one again.
    const std::vector<PortRef> before = session.shown;
    for (const PlanPass& pass : session.renderer()->plan().passes) {
        const PassType* type = session.registry().find(pass.type);
        for (const auto& [name, resource] : pass.ports) {
            const PortInfo* info = type != nullptr ? type->port(name) : nullptr;
            const PortRef each{pass.name, name};
            if (info != nullptr && info->direction != PortDirection::Input &&
                info->kind == PortKind::Texture && resource >= 0 &&
                std::find(session.shown.begin(), session.shown.end(), each) == session.shown.end())
                session.shown.push_back(each);
        }
    }
    session.follow();
    std::optional<Blame> found;
    if (session.renderAgain()) found = Search(session, fault).from(port, {x, y});
    session.shown = before;
    session.follow();
    return found;
}

} // namespace kestrel::edit
