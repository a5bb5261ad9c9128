// The textures and buffers of a plan, and what moves over from one plan to the next.
#pragma once
#include "gl/objects.h"
#include "graph/plan.h"
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

class Resources {
public:
    // Makes what `plan` needs. An object in which the same ports stand with the same descriptor moves over
    // with its content; others of an equal descriptor are used again for their memory. What is new holds the
    // port's constant or clear value, else zero. Throws MachineError naming port, need and limit where a
    // resource is larger than the device can hold; nothing has changed then.
    void adopt(const Plan& plan, const Capabilities& capabilities);

    // Whether the content of the resource is what it was under the plan before.
    [[nodiscard]] bool kept(int resource) const { return entries_.at(size_t(resource)).kept; }

    [[nodiscard]] bool isBuffer(int resource) const;
    // `previous`: last frame's content of a history.
    [[nodiscard]] gl::Texture& texture(int resource, bool previous = false);
    [[nodiscard]] gl::Buffer& buffer(int resource, bool previous = false);
    [[nodiscard]] const PlanResource& info(int resource) const { return entries_.at(size_t(resource)).plan; }

    // What was current becomes last frame's; nothing if the resource has no history. Called before the
    // producer runs.
    void swapHistory(int resource);
    void fill(int resource, const glm::vec4& value);
    void copy(int from, int to);

private:
    struct Object {
        Desc desc;
        std::vector<std::string> content; // the ports that stand in it and where, sorted
        gl::Texture texture;
        gl::Buffer buffer;
        bool taken = false; // by the next plan
    };
    struct Entry {
        PlanResource plan;
        bool flipped = false; // of a history: the second object is the current one
        bool kept = false;
        gl::Buffer range; // of a buffer: its part of the object; none of a history
    };
    [[nodiscard]] Object& object(int resource, bool previous);
    [[nodiscard]] Object* takeOver(const Object& wanted, bool sameContent);
    static std::vector<Object> wantedObjects(const Plan& plan);
    void fill(int resource, bool previous, const glm::vec4& value);
    void fillNew(); // what has not moved over

    std::vector<Entry> entries_;
    std::vector<Object> objects_;
};

// The clear value of a buffer as its 32-bit word: bits of a float where its texels are floats, else a whole
// number.
std::uint32_t clearWord(const Desc& desc, const glm::vec4& value);

} // namespace kestrel
