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

// How bad; of a cause and what comes of it the cause is no better: what is no number or infinite makes the
// same or a black pixel, but nothing black makes a number none.
int badness(Fault fault) {
    switch (fault) {
    case Fault::NotANumber:
    case Fault::Infinite:
        return 3;
    case Fault::Negative:
        return 2;
    case Fault::Black:
        return 1;
    case Fault::None:
        break;
    }
    return 0;
}

struct Bad {
    Fault fault = Fault::None;
    Place place;
};

// The worst within a pixel of the place, since filters and rounding move things; the place itself first.
Bad near(const Image& image, Place place) {
    Bad worst;
    for (int reach = 0; reach <= 1; ++reach)
        for (int y = place.y - reach; y <= place.y + reach; ++y)
            for (int x = place.x - reach; x <= place.x + reach; ++x) {
                if (x < 0 || y < 0 || x >= image.width || y >= image.height) continue;
                const Fault fault = faultAt(image, x, y);
                // Beside the place black is most often right.
                if (reach > 0 && fault == Fault::Black) continue;
                if (badness(fault) > badness(worst.fault)) worst = {fault, {x, y}};
            }
    return worst;
}

Bad anywhere(const Image& image) {
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (const Fault fault = faultAt(image, x, y); badness(fault) == badness(Fault::Infinite))
                return {fault, {x, y}};
    return {};
}

class Search {
public:
    explicit Search(Session& session)
        : session_(session)
        , plan_(session.renderer()->plan()) {}

    // Of a pixel that is right, or clamped so: the nearest port behind it that holds what is no number or
    // infinite there.
    std::optional<Blame> behind(const PortRef& port, Place place) {
        std::string why;
        const Image here = session_.read(port, why);
        std::vector<PortRef> next{port};
        std::set<PortRef> met{port};
        for (size_t i = 0; i < next.size(); ++i) {
            for (const auto& [source, image] : texturesOf(next[i])) {
                if (!met.insert(source).second) continue;
                const Bad bad = near(image, scaled(place, here, image));
                if (badness(bad.fault) == badness(Fault::Infinite)) return from(source, bad.place, bad.fault);
                next.push_back(source);
            }
        }
        return {};
    }

    Blame from(const PortRef& port, Place place, Fault fault) {
        Blame found{
            .fault = fault, .port = port, .x = place.x, .y = place.y, .path = {port.text()}, .why = {}};
        seen_.insert(port); // a history leads back
        while (const auto next = input(found.port, {found.fault, {found.x, found.y}})) {
            found.port = next->port;
            found.fault = next->bad.fault;
            found.x = next->bad.place.x;
            found.y = next->bad.place.y;
            found.path.push_back(next->port.text());
            seen_.insert(next->port);
        }
        found.why = fmt::format("{} of '{}' is {} there, and nothing that it reads is wrong", found.port.port,
                                found.port.pass, faultName(found.fault));
        return found;
    }

private:
    struct Cause {
        PortRef port;
        Bad bad;
    };

    // The pass whose steps make a port.
    [[nodiscard]] const PlanPass* maker(const PortRef& port) const {
        for (const PlanPass& pass : plan_.passes)
            if (pass.name == port.pass) return &pass;
        return nullptr;
    }
    [[nodiscard]] const PortInfo* info(const PortRef& port) const {
        const PlanPass* pass = maker(port);
        const PassType* type = pass != nullptr ? session_.registry().find(pass->type) : nullptr;
        return type != nullptr ? type->port(port.port) : nullptr;
    }
    // Whether a port holds light or the like, of which 0 and less is wrong; of directions, depths and motion
    // it is not.
    [[nodiscard]] bool holdsLight(const PortRef& port) const {
        const PortInfo* held = info(port);
        return held == nullptr || held->content.space == Space::Any || held->content.space == Space::Display;
    }

    static Place scaled(Place place, const Image& from, const Image& to) {
        return {place.x * to.width / std::max(from.width, 1), place.y * to.height / std::max(from.height, 1)};
    }
    // What the port's pass reads as textures, by who made it.
    [[nodiscard]] std::vector<std::pair<PortRef, Image>> texturesOf(const PortRef& port) const {
        const PlanPass* pass = maker(port);
        const PassType* type = pass != nullptr ? session_.registry().find(pass->type) : nullptr;
        std::vector<std::pair<PortRef, Image>> textures;
        if (type == nullptr) return textures;
        for (const PortInfo& input : type->ports) {
            const auto held = pass->ports.find(input.name);
            if (input.direction != PortDirection::Input || input.kind != PortKind::Texture ||
                held == pass->ports.end() || held->second < 0)
                continue;
            const PortRef source = plan_.resources[static_cast<size_t>(held->second)].port;
            std::string why;
            Image image = session_.read(source, why);
            if (!image.empty()) textures.emplace_back(source, std::move(image));
        }
        return textures;
    }

    // The worst of what a port's pass reads there, if it can be the cause of what came of it.
    std::optional<Cause> input(const PortRef& port, const Bad& bad) {
        const PlanPass* pass = maker(port);
        const PassType* type = pass != nullptr ? session_.registry().find(pass->type) : nullptr;
        if (type == nullptr) return {};
        std::string why;
        const Image here = session_.read(port, why);
        std::optional<Cause> worst;
        for (const auto& [source, image] : texturesOf(port)) {
            if (seen_.contains(source)) continue;
            const Bad there = near(image, scaled(bad.place, here, image));
            const bool counts = badness(there.fault) >= badness(bad.fault) && there.fault != Fault::None;
            if (counts && (badness(there.fault) == badness(Fault::Infinite) || holdsLight(source)) &&
                (!worst || badness(there.fault) > badness(worst->bad.fault)))
                worst = Cause{source, there};
        }
        for (const PortInfo& input : type->ports)
            if (!worst && input.direction == PortDirection::Input && isModule(input.kind))
                worst = behindModule(*pass, input.name);
        return worst;
    }

    // A ray may have fetched it anywhere. Only what is never right counts there.
    std::optional<Cause> behindModule(const PlanPass& pass, const std::string& input) {
        const auto behind = pass.inputPasses.find(input);
        if (behind == pass.inputPasses.end()) return {};
        for (const int index : behind->second) {
            const PlanPass& provider = plan_.passes[static_cast<size_t>(index)];
            for (const auto& [name, resource] : provider.ports) {
                const PortRef port{provider.name, name};
                const PortInfo* held = info(port);
                if (held == nullptr || held->direction == PortDirection::Input ||
                    held->kind != PortKind::Texture || seen_.contains(port))
                    continue;
                std::string why;
                if (const Bad bad = anywhere(session_.read(port, why)); bad.fault != Fault::None)
                    return Cause{port, bad};
            }
        }
        return {};
    }

    Session& session_;
    const Plan& plan_;
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
    // In the frame in which it came up: what accumulates keeps it when what made it is right again.
    Fault now = Fault::None;
    const auto isThere = [&] {
        now = faultAt(session.read(port, why), x, y);
        return fault != Fault::None && now == fault;
    };
    if (session.renderAgain(isThere) && now == fault)
        found = fault == Fault::None ? Search(session).behind(port, {x, y})
                                     : Search(session).from(port, {x, y}, fault);
    session.shown = before;
    session.follow();
    return found;
}

} // namespace kestrel::edit
