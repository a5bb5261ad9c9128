// The keys of a setup's JSON objects, each told once: reader, writer, schema and help come from here.
#pragma once
#include "core/json.h"
#include "scene/setup.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>
#include <nlohmann/json.hpp>

namespace kestrel {

inline std::string jsonQuoted(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// The keys of one kind of object that is read into a T.
template<class T>
class SetupKeys {
public:
    using Schema = nlohmann::ordered_json;
    struct Key {
        std::string name, description;
        std::optional<Json::Kind> kind; // checked before `read`; none: `read` says what it must be
        Schema schema;
        std::function<void(std::vector<Problem>&, const Json&, T&)> read;
        std::function<std::string(const T&)> write;        // as JSON; empty: as if the key was not there
        std::function<void(T& under, const T& over)> join; // takes what `over` gives
    };

    SetupKeys& text(std::string name, std::string T::*member, std::string description) {
        return add({std::move(name),
                    std::move(description),
                    Json::Kind::String,
                    {{"type", "string"}},
                    [member](std::vector<Problem>&, const Json& json, T& into) { into.*member = json.text; },
                    [member](const T& from) {
                        return (from.*member).empty() ? std::string() : jsonQuoted(from.*member);
                    },
                    [member](T& under, const T& over) {
                        if (!(over.*member).empty()) under.*member = over.*member;
                    }});
    }
    // One of several texts, of which the first is meant where none is given.
    SetupKeys& choice(std::string name, std::string T::*member, std::vector<std::string> all,
                      std::string description) {
        text(name, member, std::move(description));
        Key& key = keys_.back();
        key.schema = {{"enum", all}, {"default", all.front()}};
        key.read = [member, all, name](std::vector<Problem>& problems, const Json& json, T& into) {
            into.*member = json.text;
            if (std::find(all.begin(), all.end(), json.text) == all.end())
                problems.push_back(
                    {json.where, fmt::format("'{}' must be one of {}, not '{}'{}", name, fmt::join(all, ", "),
                                             json.text, didYouMean(json.text, all))});
        };
        return *this;
    }
    // Within [minimum, maximum], or without the ends where `open`.
    SetupKeys& number(std::string name, std::optional<double> T::*member, double minimum, double maximum,
                      bool open, std::string description) {
        Schema schema = {{"type", "number"},
                         {open ? "exclusiveMinimum" : "minimum", minimum},
                         {open ? "exclusiveMaximum" : "maximum", maximum}};
        return add({name, std::move(description), Json::Kind::Float, std::move(schema),
                    [=](std::vector<Problem>& problems, const Json& json, T& into) {
                        const double n = json.number;
                        into.*member = n;
                        if (open ? n > minimum && n < maximum : n >= minimum && n <= maximum) return;
                        problems.push_back(
                            {json.where, fmt::format("'{}' must be {} {} {} {}, not {}", name,
                                                     open ? "more than" : "from", minimum,
                                                     open ? "and less than" : "to", maximum, n)});
                    },
                    [member](const T& from) {
                        return from.*member ? fmt::format("{}", *(from.*member)) : std::string();
                    },
                    [member](T& under, const T& over) {
                        if (over.*member) under.*member = over.*member;
                    }});
    }
    // Three numbers of at most `largest`; none below `least`.
    SetupKeys& vector(std::string name, std::optional<glm::dvec3> T::*member, std::string description,
                      double least = -1e9, double largest = 1e9) {
        const Schema schema = {{"type", "array"},
                               {"items", {{"type", "number"}, {"minimum", least}, {"maximum", largest}}},
                               {"minItems", 3},
                               {"maxItems", 3}};
        return add({name, std::move(description), Json::Kind::Array, schema,
                    [=](std::vector<Problem>& problems, const Json& json, T& into) {
                        const bool good =
                            json.items.size() == 3 && std::ranges::all_of(json.items, [&](const Json& item) {
                                return item.isNumber() && item.number >= least && item.number <= largest;
                            });
                        if (good)
                            into.*member =
                                glm::dvec3(json.items[0].number, json.items[1].number, json.items[2].number);
                        else
                            problems.push_back(
                                {json.where, fmt::format("'{}' must be three numbers from {} to {}", name,
                                                         least, largest)});
                    },
                    [member](const T& from) {
                        const auto& v = from.*member;
                        return v ? fmt::format("[{}, {}, {}]", v->x, v->y, v->z) : std::string();
                    },
                    [member](T& under, const T& over) {
                        if (over.*member) under.*member = over.*member;
                    }});
    }
    // Objects with keys of their own; `what` names one in messages.
    template<class Item>
    SetupKeys& list(std::string name, std::vector<Item> T::*member, const SetupKeys<Item>& (*keysOf)(),
                    std::string what, size_t most, std::string description) {
        const Schema schema = {{"type", "array"}, {"items", keysOf().schema()}, {"maxItems", most}};
        return add({name, std::move(description), Json::Kind::Array, schema,
                    [=](std::vector<Problem>& problems, const Json& json, T& into) {
                        if (json.items.size() > most)
                            problems.push_back({json.where, fmt::format("{} of '{}'; at most {} are read",
                                                                        json.items.size(), name, most)});
                        else
                            for (const Json& item : json.items)
                                keysOf().read(problems, item, what, (into.*member).emplace_back());
                    },
                    [=](const T& from) {
                        std::vector<std::string> items;
                        for (const Item& item : from.*member) items.push_back(keysOf().write(item));
                        return items.empty() ? std::string() : fmt::format("[{}]", fmt::join(items, ", "));
                    },
                    [member](T& under, const T& over) {
                        if (!(over.*member).empty()) under.*member = over.*member;
                    }});
    }
    SetupKeys& add(Key key) {
        key.schema["description"] = key.description;
        keys_.push_back(std::move(key));
        return *this;
    }
    // What is said once all keys of an object are read.
    SetupKeys& finally(std::function<void(std::vector<Problem>&, const Json&, T&)> check) {
        check_ = std::move(check);
        return *this;
    }

    // Every mistake is noted. `what` names the object in messages.
    void read(std::vector<Problem>& problems, const Json& json, const std::string& what, T& into) const {
        JsonFields fields(json, what, problems);
        if (json.kind != Json::Kind::Object) return;
        readFields(problems, fields, json, into);
        fields.refuseOthers();
    }
    // The same beside keys that somebody else reads.
    void readFields(std::vector<Problem>& problems, JsonFields& fields, const Json& json, T& into) const {
        const size_t before = problems.size();
        for (const Key& key : keys_) {
            const Json* value = key.kind ? fields.optional(key.name, *key.kind) : fields.optional(key.name);
            if (value != nullptr) key.read(problems, *value, into);
        }
        if (check_ && problems.size() == before) check_(problems, json, into);
    }
    // "key": value, of what is given.
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> members(const T& from) const {
        std::vector<std::pair<std::string, std::string>> members;
        for (const Key& key : keys_)
            if (std::string value = key.write(from); !value.empty())
                members.emplace_back(key.name, std::move(value));
        return members;
    }
    // As JSON in one line.
    [[nodiscard]] std::string write(const T& from) const {
        std::vector<std::string> texts;
        for (const auto& [name, value] : members(from)) texts.push_back(jsonQuoted(name) + ": " + value);
        return texts.empty() ? "{}" : fmt::format("{{ {} }}", fmt::join(texts, ", "));
    }
    void join(T& under, const T& over) const {
        for (const Key& key : keys_) key.join(under, over);
    }
    [[nodiscard]] Schema schema() const {
        Schema properties = Schema::object();
        for (const Key& key : keys_) properties[key.name] = key.schema;
        return {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
    }
    [[nodiscard]] const std::vector<Key>& keys() const { return keys_; }
    [[nodiscard]] const Key* find(const std::string& name) const {
        const auto found = std::ranges::find(keys_, name, &Key::name);
        return found == keys_.end() ? nullptr : &*found;
    }
    [[nodiscard]] std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const Key& key : keys_) names.push_back(key.name);
        return names;
    }

private:
    std::vector<Key> keys_;
    std::function<void(std::vector<Problem>&, const Json&, T&)> check_;
};

const SetupKeys<AddedCameraKey>& addedCameraKeyKeys();
const SetupKeys<AddedCamera>& addedCameraKeys();
const SetupKeys<AddedLight>& addedLightKeys();
const SetupKeys<SceneSetup>& sceneSetupKeys();

} // namespace kestrel
