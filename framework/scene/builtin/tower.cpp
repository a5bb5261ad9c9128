// `tower`: a spiral staircase with turned balusters, handrail, strings and landings, open on all sides, so
// that from above and from outside many layers lie behind one another.
#include "scene/builtin/scene_builder.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"
#include <glm/gtc/matrix_transform.hpp>

namespace kestrel::builtin {
namespace {

constexpr int turns = 3, stepsPerTurn = 20;
constexpr float stepAngle = 15 * pi / 180;
constexpr float landingAngle = 60 * pi / 180; // with the steps of a turn: one full circle
constexpr float rise = 0.17f;
constexpr float innerRadius = 0.25f, outerRadius = 2.0f, railRadius = 1.93f;
constexpr float treadThickness = 0.05f, railHeight = 0.95f;

glm::vec3 onCircle(float radius, float angle, float y) {
    return {radius * std::sin(angle), y, radius * std::cos(angle)};
}

// Height of the walking line at an angle from the start: rising over the steps, level over the landings.
float slopeHeight(float angle) {
    const float turn = std::floor(angle / (2 * pi));
    const float within = angle - turn * 2 * pi;
    const float risen = std::min(within / stepAngle, static_cast<float>(stepsPerTurn)) +
                        glm::smoothstep(0.0f, 1.0f, (within - stepsPerTurn * stepAngle) / landingAngle);
    return rise * (turn * (stepsPerTurn + 1) + risen);
}

// A slab of a ring, from angle 0 to `angle`, top at y = 0; six smooth sides with sharp edges.
void addSectorSlab(Primitive& to, float angle, float r0, float r1, float thickness, int cells) {
    const auto at = [=](float r, float a, float y) { return onCircle(glm::mix(r0, r1, r), a * angle, y); };
    addGrid(to, 2, cells, [=](float u, float v) { return at(u, v, 0); });
    addGrid(to, 2, cells, [=](float u, float v) { return at(1 - u, v, -thickness); });
    addGrid(to, cells, 1, [=](float u, float v) { return at(1, u, (v - 1) * thickness); });
    addGrid(to, cells, 1, [=](float u, float v) { return at(0, u, -v * thickness); });
    addGrid(to, 2, 1, [=](float u, float v) { return at(u, 0, (v - 1) * thickness); });
    addGrid(to, 2, 1, [=](float u, float v) { return at(u, 1, -v * thickness); });
}

Primitive makeTread(Detail detail) {
    Primitive tread;
    addSectorSlab(tread, stepAngle, innerRadius, outerRadius, treadThickness, detail.steps(6, 1));
    // The nosing: a rounded front edge, which overhangs the riser of the step.
    const float middle = -0.5f * treadThickness;
    addTube(tread, {onCircle(innerRadius, 0, middle), onCircle(outerRadius, 0, middle)},
            {0.5f * treadThickness, 0.5f * treadThickness}, detail.steps(12, 4));
    const float height = rise - treadThickness;
    const glm::vec3 inner = onCircle(innerRadius, 0.02f, -treadThickness - height);
    const glm::vec3 along = onCircle(outerRadius, 0.02f, -treadThickness - height) - inner;
    const glm::vec3 up(0, height, 0);
    addQuad(tread, inner, along, up);
    addQuad(tread, inner + glm::normalize(glm::cross(up, along)) * 0.015f, up, along);
    return tread;
}

Primitive makeLanding(Detail detail) {
    Primitive landing;
    addSectorSlab(landing, landingAngle, innerRadius, outerRadius, 1.6f * treadThickness,
                  detail.steps(18, 3));
    return landing;
}

// A turned baluster of height 1 with its foot at the origin.
Primitive makeBaluster(Detail detail) {
    Primitive baluster;
    const int rows = detail.steps(11, 4);
    std::vector<glm::vec2> profile{{0.024f, 0}, {0.024f, 0.06f}};
    for (int i = 0; i <= rows; ++i) {
        const float t = static_cast<float>(i) / static_cast<float>(rows);
        const float vase = 0.022f * std::exp(-30 * (t - 0.3f) * (t - 0.3f));
        const float ring = 0.010f * std::exp(-300 * (t - 0.62f) * (t - 0.62f));
        profile.emplace_back(0.011f + vase + ring + 0.006f * (1 - t), 0.06f + 0.88f * t);
    }
    profile.insert(profile.end(), {{0.022f, 0.94f}, {0.022f, 1}});
    addLathe(baluster, glm::mat4(1), profile, detail.steps(8, 4));
    return baluster;
}

// A newel post of height 1.1 with a ball on top, for the corners of landings.
Primitive makePost(Detail detail) {
    Primitive post;
    addBox(post, glm::translate(glm::mat4(1), {0, 0.53f, 0}), {0.035f, 0.53f, 0.035f});
    addLathe(post, glm::translate(glm::mat4(1), {0, 1.06f, 0}), {{0.05f, 0}, {0.05f, 0.03f}, {0.02f, 0.04f}},
             detail.steps(16, 5));
    addCubeSphere(post, detail.steps(6, 1),
                  [](const glm::vec3& d) { return glm::vec3(0, 1.15f, 0) + 0.06f * d; });
    return post;
}

constexpr float lastAngle = turns * 2 * pi;

// A rectangular band that follows the stairs: radii r0 to r1, from `low` to `high` above the walking line.
Primitive makeString(float r0, float r1, float low, float high, int cells) {
    Primitive band;
    const auto at = [=](float r, float u, float y) {
        const float angle = u * lastAngle;
        return onCircle(glm::mix(r0, r1, r), angle, slopeHeight(angle) + glm::mix(low, high, y));
    };
    addGrid(band, cells, 1, [=](float u, float v) { return at(1, u, v); });
    addGrid(band, cells, 1, [=](float u, float v) { return at(0, u, 1 - v); });
    addGrid(band, cells, 1, [=](float u, float v) { return at(1 - v, u, 1); });
    addGrid(band, cells, 1, [=](float u, float v) { return at(v, u, 0); });
    addGrid(band, 1, 1, [=](float u, float v) { return at(u, 0, v); });
    addGrid(band, 1, 1, [=](float u, float v) { return at(1 - u, 1, v); });
    return band;
}

Primitive makeHandrail(Detail detail) {
    const int cells = detail.steps(turns * 84, turns * 21);
    std::vector<glm::vec3> path;
    for (int i = 0; i <= cells; ++i) {
        const float angle = lastAngle * static_cast<float>(i) / static_cast<float>(cells);
        path.push_back(onCircle(railRadius, angle, slopeHeight(angle) + railHeight));
    }
    Primitive rail;
    addTube(rail, path, std::vector<float>(path.size(), 0.035f), detail.steps(12, 4));
    return rail;
}

// The central column with a rope moulding that winds around it.
Primitive makeNewel(Detail detail, float height) {
    const int sides = detail.steps(28, 6);
    Primitive newel;
    addLathe(newel, glm::mat4(1),
             {{0.34f, 0},
              {0.34f, 0.16f},
              {0.26f, 0.24f},
              {0.21f, 0.26f},
              {0.21f, height - 0.3f},
              {0.27f, height - 0.24f},
              {0.27f, height - 0.18f},
              {0.12f, height - 0.12f}},
             sides);
    addCubeSphere(newel, detail.steps(10, 2),
                  [=](const glm::vec3& d) { return glm::vec3(0, height + 0.04f, 0) + 0.2f * d; });
    const int cells = detail.steps(220, 40);
    std::vector<glm::vec3> rope;
    for (int i = 0; i <= cells; ++i) {
        const float t = static_cast<float>(i) / static_cast<float>(cells);
        rope.push_back(onCircle(0.215f, -t * 6 * 2 * pi, glm::mix(0.3f, height - 0.32f, t)));
    }
    addTube(newel, rope, std::vector<float>(rope.size(), 0.028f), detail.steps(8, 3));
    return newel;
}

class TowerBuilder : public SceneBuilder {
public:
    explicit TowerBuilder(Detail detail)
        : detail_(detail) {
        const int wood = add(matte("wood", {0.44f, 0.25f, 0.12f}, 0.5f));
        const int stone = add(matte("stone", {0.58f, 0.55f, 0.50f}));
        const int paint = add(matte("paint", {0.80f, 0.78f, 0.72f}, 0.6f));
        dark_ = add(matte("dark wood", {0.20f, 0.09f, 0.05f}, 0.35f));
        tread_ = addMesh("tread", makeTread(detail), wood);
        landing_ = addMesh("landing", makeLanding(detail), wood);
        baluster_ = addMesh("baluster", makeBaluster(detail), paint);
        post_ = addMesh("post", makePost(detail), dark_);
        const float top = slopeHeight(lastAngle);
        addInstance("newel", addMesh("newel", makeNewel(detail, top + 1.6f), stone));
        addInstance("handrail", addMesh("handrail", makeHandrail(detail), dark_));
        const int cells = detail.steps(turns * 84, turns * 21);
        addInstance("outer string",
                    addMesh("outer string",
                            makeString(outerRadius, outerRadius + 0.04f, -0.28f, 0.04f, cells), paint));
        addInstance("inner string",
                    addMesh("inner string",
                            makeString(innerRadius, innerRadius + 0.05f, -0.28f, -0.06f, cells), paint));
        Primitive base;
        addLathe(base, glm::mat4(1), {{3, -0.3f}, {3, -0.15f}, {2.7f, -0.15f}, {2.7f, 0}, {0, 0}},
                 detail.steps(72, 12));
        addInstance("base", addMesh("base", std::move(base), stone));
    }

    // The rail that closes the last landing, from the outer post to the newel.
    void addEndRail() {
        const float angle = lastAngle - 0.06f * landingAngle, y = rise * turns * (stepsPerTurn + 1);
        Primitive rail;
        addTube(rail,
                {onCircle(railRadius, angle, y + railHeight), onCircle(innerRadius, angle, y + railHeight)},
                {0.03f, 0.03f}, detail_.steps(12, 4));
        addInstance("end rail", addMesh("end rail", std::move(rail), dark_));
        const int each = detail_.factor() < 0.2 ? 3 : 9;
        for (int k = 1; k <= each; ++k) {
            const float radius =
                glm::mix(railRadius, innerRadius, static_cast<float>(k) / static_cast<float>(each + 1));
            addTurned("baluster", baluster_, angle, radius, y, railHeight);
        }
    }

    void addTurn(int turn) {
        const float start = static_cast<float>(turn) * 2 * pi;
        for (int i = 0; i < stepsPerTurn; ++i) {
            const float angle = start + static_cast<float>(i) * stepAngle;
            const float y = rise * static_cast<float>(turn * (stepsPerTurn + 1) + i + 1);
            addTurned("tread", tread_, angle, 0, y);
            const int each = detail_.factor() < 0.2 ? 1 : 3;
            for (int k = 0; k < each; ++k)
                addBaluster(angle + stepAngle * (static_cast<float>(k) + 0.5f) / static_cast<float>(each), y);
        }
        const float angle = start + stepsPerTurn * stepAngle;
        const float y = rise * static_cast<float>((turn + 1) * (stepsPerTurn + 1));
        addTurned("landing", landing_, angle, 0, y);
        for (const float at : {0.06f, 0.94f})
            addTurned("post", post_, angle + at * landingAngle, railRadius, y);
        const int each = detail_.factor() < 0.2 ? 3 : 9;
        for (int k = 0; k < each; ++k)
            addBaluster(angle + landingAngle * (static_cast<float>(k) + 1) / static_cast<float>(each + 1), y);
    }

private:
    void addTurned(const char* name, int mesh, float angle, float radius, float y, float height = 1) {
        addInstance(name, mesh, onCircle(radius, angle, y),
                    glm::angleAxis(double{angle}, glm::dvec3(0, 1, 0)), {1, height, 1});
    }
    // From a tread up to the handrail.
    void addBaluster(float angle, float y) {
        addTurned("baluster", baluster_, angle, railRadius, y, slopeHeight(angle) + railHeight - y);
    }

    Detail detail_;
    int dark_, tread_, landing_, baluster_, post_;
};

} // namespace

Scene makeTower(Detail detail) {
    TowerBuilder b(detail);
    for (int turn = 0; turn < turns; ++turn) b.addTurn(turn);
    b.addEndRail();
    Light sun;
    sun.name = "sun";
    sun.kind = LightKind::Directional;
    sun.colour = {1, 0.95f, 0.85f};
    sun.intensity = 3;
    b.addLight(sun, {8, 18, 6}, {0, 6, 0});
    b.addCamera("stairs", {2.3, 13.4, 2.7}, {0.25, 9.4, 0.1}, 58, 0.1f, 60);
    b.addCamera("outside", {4.6, 7.2, 5.4}, {0.4, 5.3, 0}, 60, 0.1f, 60);
    b.addCamera("above", {0.9, 15.5, -1.4}, {0.1, 8, -0.1}, 50, 0.1f, 60);
    return std::move(b.scene);
}

} // namespace kestrel::builtin
