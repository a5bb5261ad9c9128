// Reading a sweep file.
#include "measure/sweep_file.h"
#include "core/files.h"
#include "core/json.h"
#include "graph/value_text.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kestrel {
namespace {

using Kind = Json::Kind;

class SweepReader {
public:
    explicit SweepReader(std::vector<Problem>& problems)
        : problems_(problems) {}

    Sweep read(const Json& root, const std::string& file) {
        Sweep sweep;
        sweep.file = file;
        sweep.name = sweep.file.stem().string();
        JsonFields fields(root, "the sweep", problems_);
        if (root.kind != Kind::Object) return sweep;
        if (const Json* version = fields.required("kestrel_sweep", Kind::Int);
            version && version->integer != 1)
            note(version->where, fmt::format("'kestrel_sweep' (the version of the format) must be 1, not {}",
                                             version->integer));
        sweep.title = text(fields.optional("title", Kind::String), sweep.name);
        sweep.comment = text(fields.optional("comment", Kind::String));
        if (const Json* size = fields.optional("size")) readSize(*size, sweep);
        sweep.frames = whole(fields.optional("frames"), "frames", 1, maxSweepFrames, sweep.frames);
        sweep.warmUp = whole(fields.optional("warm_up"), "warm_up", 0, maxSweepFrames, sweep.warmUp);
        sweep.repeats = whole(fields.optional("repeats"), "repeats", 1, maxSweepRepeats, sweep.repeats);
        sweep.timedFrames =
            whole(fields.optional("timed_frames"), "timed_frames", 1, maxSweepFrames, sweep.timedFrames);
        sweep.seed = static_cast<std::uint32_t>(whole(fields.optional("seed"), "seed", 0, maxSweepSeed, 0));
        sweep.moving = flag(fields.optional("moving", Kind::Bool));
        sweep.rebuild = flag(fields.optional("rebuild", Kind::Bool));
        sweep.hdr = flag(fields.optional("hdr", Kind::Bool));
        readTimes(fields.optional("times", Kind::Object), sweep);
        const Json* plot = fields.optional("plot", Kind::Object);
        readScenes(fields.required("scenes", Kind::Array), sweep);
        if (const Json* reference = fields.optional("reference", Kind::Object))
            readReference(*reference, sweep);
        if (const Json* rays = fields.optional("rays", Kind::Object)) readRays(*rays, sweep);
        readVariants(fields.required("variants", Kind::Array), sweep);
        if (plot != nullptr) readPlot(*plot, sweep);
        fields.refuseOthers();
        return sweep;
    }

private:
    void note(const Location& where, std::string message) {
        problems_.push_back({where, std::move(message)});
    }

    std::string text(const Json* value, std::string standard = {}) {
        if (value == nullptr) return standard;
        if (value->text.size() > maxGraphText)
            note(value->where,
                 fmt::format("a text of {} bytes; at most {} are read", value->text.size(), maxGraphText));
        return value->text;
    }

    // Something that is named in tables and in file names.
    std::string name(const Json* value, std::string_view what) {
        if (value == nullptr) return {};
        const bool printable = std::ranges::none_of(
            value->text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
        if (value->text.empty() || value->text.size() > maxSweepName || !printable) {
            note(value->where,
                 fmt::format("the {} must be a printable text of 1 to {} bytes", what, maxSweepName));
            return {};
        }
        return value->text;
    }

    static bool flag(const Json* value) { return value != nullptr && value->boolean; }

    int whole(const Json* value, std::string_view key, int minimum, int maximum, int standard) {
        if (value == nullptr) return standard;
        if (value->kind == Kind::Int && value->integer >= minimum && value->integer <= maximum)
            return static_cast<int>(value->integer);
        note(value->where, fmt::format("'{}' must be a whole number from {} to {}", key, minimum, maximum));
        return standard;
    }

    void readSize(const Json& size, Sweep& sweep) {
        const auto side = [](const Json& json) {
            return json.kind == Kind::Int && json.integer >= 1 && json.integer <= maxSweepSide;
        };
        if (size.kind == Kind::Array && size.items.size() == 2 && side(size.items[0]) && side(size.items[1]))
            sweep.size = {static_cast<std::uint32_t>(size.items[0].integer),
                          static_cast<std::uint32_t>(size.items[1].integer), 1};
        else
            note(size.where, fmt::format("'size' must be [width, height] with 1 to {} each", maxSweepSide));
    }

    std::optional<PortRef> port(const Json* value, std::string_view what) {
        if (value == nullptr) return {};
        auto result = parsePortRef(value->text);
        if (!result)
            note(value->where, fmt::format("'{}' must be \"pass.port\", not '{}'", what, value->text));
        return result;
    }

    std::vector<SweepSetting> settings(const Json* list) {
        std::vector<SweepSetting> result;
        if (list == nullptr) return result;
        for (const Json& item : list->items) {
            if (item.kind == Kind::String)
                result.push_back({item.text, item.where});
            else
                note(item.where,
                     fmt::format("a setting must be a string as '--set' takes it, not {}", item.kindName()));
        }
        return result;
    }

    void readTimes(const Json* times, Sweep& sweep) {
        if (times == nullptr) return;
        for (const Json::Member& member : times->members) {
            SweepTime time{member.key, {}};
            if (member.value.kind != Kind::Array || member.value.items.empty())
                note(member.value.where, fmt::format("the time '{}' must be an array of groups and passes, "
                                                     "as [\"generation\", \"-bom\"]",
                                                     member.key));
            for (const Json& item : member.value.items) {
                if (item.kind != Kind::String || item.text.empty() || item.text == "-") {
                    note(item.where, "a part of a time must be the name of a group or a pass, with '-' "
                                     "before it where it is subtracted");
                    continue;
                }
                const bool minus = item.text.front() == '-';
                time.terms.push_back({item.text.substr(minus ? 1 : 0), minus ? -1.0 : 1.0});
            }
            if (member.key == "total" || member.key == "frame")
                note(member.where, fmt::format("the time '{}' is there already", member.key));
            sweep.times.push_back(std::move(time));
        }
    }

    void readPlot(const Json& plot, Sweep& sweep) {
        JsonFields fields(plot, "'plot'", problems_);
        sweep.plotTime = text(fields.optional("time", Kind::String), sweep.plotTime);
        if (const Json* error = fields.optional("error", Kind::String)) {
            const std::vector<std::string>& errors = sweepErrors();
            sweep.plotError = error->text;
            if (std::ranges::find(errors, error->text) == errors.end())
                note(error->where, fmt::format("the error '{}' is none of flip, mse, rmse and ssim{}",
                                               error->text, didYouMean(error->text, errors)));
        }
        fields.refuseOthers();
    }

    void readScenes(const Json* scenes, Sweep& sweep) {
        if (scenes == nullptr) return;
        if (scenes->items.empty()) note(scenes->where, "'scenes' is empty: there is nothing to measure on");
        for (const Json& item : scenes->items) {
            SweepScene scene;
            scene.where = item.where;
            if (item.kind == Kind::String) {
                scene.source = item.text;
            } else {
                JsonFields fields(item, "a scene", problems_);
                if (item.kind != Kind::Object) continue;
                scene.source = text(fields.required("source", Kind::String));
                scene.camera = text(fields.optional("camera", Kind::String));
                scene.name = name(fields.optional("name", Kind::String), "name of a scene");
                fields.refuseOthers();
            }
            if (scene.name.empty()) {
                const bool builtin = scene.source.starts_with("builtin:");
                scene.name = builtin ? scene.source.substr(8)
                                     : std::filesystem::path(scene.source).filename().string();
                if (!scene.camera.empty()) scene.name += ", " + scene.camera;
            }
            const auto path = std::filesystem::path(scene.source).lexically_normal();
            if (!scene.source.starts_with("builtin:") &&
                (path.empty() || path.is_absolute() || path.begin()->string() == ".."))
                note(item.where,
                     fmt::format("the scene '{}' must be 'builtin:NAME' or a path inside the folder "
                                 "of the sweep file",
                                 scene.source));
            if (std::ranges::any_of(sweep.scenes,
                                    [&](const auto& other) { return other.name == scene.name; }))
                note(item.where,
                     fmt::format("the scene '{}' is there twice: give one another 'name'", scene.name));
            scene.slug = sweepSlug(scene.name, sceneSlugs_);
            sweep.scenes.push_back(std::move(scene));
        }
    }

    void readReference(const Json& json, Sweep& sweep) {
        SweepReference reference;
        reference.where = json.where;
        JsonFields fields(json, "'reference'", problems_);
        reference.graph = text(fields.required("graph", Kind::String));
        if (const auto output = port(fields.required("output", Kind::String), "output"))
            reference.output = *output;
        reference.mask = port(fields.optional("mask", Kind::String), "mask");
        reference.settings = settings(fields.optional("set", Kind::Array));
        reference.frames = whole(fields.optional("frames"), "frames", 1, maxSweepFrames, 1);
        fields.refuseOthers();
        sweep.reference = std::move(reference);
    }

    void readRays(const Json& json, Sweep& sweep) {
        SweepRays rays;
        rays.where = json.where;
        JsonFields fields(json, "'rays'", problems_);
        rays.graph = text(fields.required("graph", Kind::String));
        if (const auto hits = port(fields.required("hits", Kind::String), "hits")) rays.hits = *hits;
        if (const auto buffer = port(fields.required("rays", Kind::String), "rays")) rays.rays = *buffer;
        rays.settings = settings(fields.optional("set", Kind::Array));
        rays.frames = whole(fields.optional("frames"), "frames", 1, maxSweepFrames, 1);
        fields.refuseOthers();
        sweep.rays = std::move(rays);
    }

    void readVariants(const Json* variants, Sweep& sweep) {
        if (variants == nullptr) return;
        if (variants->items.empty())
            note(variants->where, "'variants' is empty: there is nothing to measure");
        for (const Json& item : variants->items) {
            if (item.kind != Kind::Object) {
                note(item.where, fmt::format("a variant must be an object, not {}", item.kindName()));
                continue;
            }
            readVariant(item, sweep);
        }
    }

    void readVariant(const Json& json, Sweep& sweep) {
        SweepVariant variant;
        variant.where = json.where;
        JsonFields fields(json, "a variant", problems_);
        variant.name = name(fields.required("name", Kind::String), "name of a variant");
        if (std::ranges::any_of(sweep.variants,
                                [&](const auto& other) { return other.name == variant.name; }))
            note(json.where, fmt::format("the variant '{}' is there twice", variant.name));
        variant.comment = text(fields.optional("comment", Kind::String));
        variant.graph = text(fields.required("graph", Kind::String));
        readOutput(fields.optional("output", Kind::String), fields.optional("hits", Kind::String), json,
                   sweep, variant);
        variant.settings = settings(fields.optional("set", Kind::Array));
        if (const Json* axes = fields.optional("axes", Kind::Object))
            for (const Json::Member& axis : axes->members) readAxis(axis, variant);
        if (const Json* exclude = fields.optional("exclude", Kind::Array))
            for (const Json& item : exclude->items) readExclusion(item, variant);
        const Json* series = fields.optional("series", Kind::String);
        variant.series = text(series, variant.name);
        if (series != nullptr) checkPlaceholders(*series, variant);
        if (const Json* along = fields.optional("along", Kind::String)) {
            variant.along = along->text;
            requireAxis(*along, along->text, variant);
        } else if (!variant.axes.empty()) {
            variant.along = variant.axes.front().name;
        }
        if (const Json* plot = fields.optional("plot", Kind::String))
            variant.plot = name(plot, "plot of a variant");
        if (const Json* frames = fields.optional("frames")) {
            variant.frames = whole(frames, "frames", 1, maxSweepFrames, 1);
            if (variant.ray)
                note(frames->where,
                     "how many frames a variant with 'hits' runs stands in 'rays': all trace the same");
            else if (sweep.moving)
                note(frames->where,
                     "where scenes move, all variants run as many frames as the reference's time needs");
        }
        fields.refuseOthers();
        sweep.variants.push_back(std::move(variant));
    }

    void readOutput(const Json* output, const Json* hits, const Json& json, const Sweep& sweep,
                    SweepVariant& variant) {
        if ((output == nullptr) == (hits == nullptr)) {
            note(json.where,
                 fmt::format("the variant '{}' must have either 'output' (a picture) or 'hits' (of "
                             "RayQuery)",
                             variant.name));
            return;
        }
        variant.ray = hits != nullptr;
        if (const auto found = port(variant.ray ? hits : output, variant.ray ? "hits" : "output"))
            variant.output = *found;
        if (variant.ray && !sweep.rays)
            note(hits->where, "a variant with 'hits' needs the sweep's 'rays': what they are held against");
        if (!variant.ray && !sweep.reference)
            note(output->where, "a variant with 'output' needs the sweep's 'reference'");
    }

    // What a scalar says as part of a setting, and as a label.
    std::optional<std::string> scalar(const Json& json) {
        switch (json.kind) {
        case Kind::Bool:
            return json.boolean ? "true" : "false";
        case Kind::Int:
            return std::to_string(json.integer);
        case Kind::Float:
            return numberText(json.number);
        case Kind::String:
            return json.text;
        default:
            return std::nullopt;
        }
    }

    void readAxis(const Json::Member& member, SweepVariant& variant) {
        SweepAxis axis;
        axis.name = member.key;
        const Json& json = member.value;
        if (json.kind == Kind::Array) {
            for (const Json& item : json.items) readAxisValue(item, {axis.name + "={}"}, axis);
        } else {
            JsonFields fields(json, fmt::format("the axis '{}'", axis.name), problems_);
            if (json.kind != Kind::Object) return;
            std::vector<std::string> templates;
            for (const SweepSetting& setting : settings(fields.required("set", Kind::Array))) {
                if (setting.text.find("{}") == std::string::npos)
                    note(setting.where,
                         fmt::format("the setting '{}' of the axis '{}' must hold {{}}, for the value",
                                     setting.text, axis.name));
                templates.push_back(setting.text);
            }
            if (const Json* values = fields.required("values", Kind::Array))
                for (const Json& item : values->items) readAxisValue(item, templates, axis);
            fields.refuseOthers();
        }
        if (axis.values.empty()) note(json.where, fmt::format("the axis '{}' has no values", axis.name));
        variant.axes.push_back(std::move(axis));
    }

    // A scalar goes into the templates; an object says its own settings.
    void readAxisValue(const Json& json, const std::vector<std::string>& templates, SweepAxis& axis) {
        SweepAxisValue value;
        if (const auto text = scalar(json)) {
            value.label = *text;
            for (const std::string& form : templates) {
                std::string setting = form;
                if (const size_t at = setting.find("{}"); at != std::string::npos)
                    setting.replace(at, 2, *text);
                value.settings.push_back({setting, json.where});
            }
        } else if (json.kind == Kind::Object) {
            JsonFields fields(json, fmt::format("a value of the axis '{}'", axis.name), problems_);
            value.label = name(fields.required("label", Kind::String), "label of an axis value");
            value.settings = settings(fields.required("set", Kind::Array));
            fields.refuseOthers();
        } else {
            note(json.where,
                 fmt::format("a value of the axis '{}' must be a number, a text, true or false, or an "
                             "object with 'label' and 'set', not {}",
                             axis.name, json.kindName()));
            return;
        }
        if (std::ranges::any_of(axis.values, [&](const auto& other) { return other.label == value.label; }))
            note(json.where, fmt::format("the axis '{}' has the value '{}' twice", axis.name, value.label));
        axis.values.push_back(std::move(value));
    }

    const SweepAxis* requireAxis(const Json& json, const std::string& wanted, const SweepVariant& variant) {
        std::vector<std::string> names;
        for (const SweepAxis& axis : variant.axes) {
            if (axis.name == wanted) return &axis;
            names.push_back(axis.name);
        }
        note(json.where, fmt::format("the variant '{}' has no axis '{}'{}", variant.name, wanted,
                                     didYouMean(wanted, names)));
        return nullptr;
    }

    void readExclusion(const Json& json, SweepVariant& variant) {
        if (json.kind != Kind::Object || json.members.empty()) {
            note(json.where, "an exclusion must be an object of axis and value");
            return;
        }
        std::map<std::string, std::string> exclusion;
        for (const Json::Member& member : json.members) {
            const SweepAxis* axis = requireAxis(member.value, member.key, variant);
            const auto label = scalar(member.value);
            if (!label) note(member.value.where, "an axis is excluded at one of its values");
            if (axis == nullptr || !label) continue;
            std::vector<std::string> labels;
            for (const SweepAxisValue& value : axis->values) labels.push_back(value.label);
            if (std::ranges::find(labels, *label) == labels.end())
                note(member.value.where, fmt::format("the axis '{}' has no value '{}' (it has {})",
                                                     axis->name, *label, fmt::join(labels, ", ")));
            exclusion[member.key] = *label;
        }
        variant.exclude.push_back(std::move(exclusion));
    }

    void checkPlaceholders(const Json& series, const SweepVariant& variant) {
        for (size_t open = series.text.find('{'); open != std::string::npos;
             open = series.text.find('{', open + 1)) {
            const size_t close = series.text.find('}', open);
            if (close == std::string::npos) break;
            requireAxis(series, series.text.substr(open + 1, close - open - 1), variant);
        }
    }

    std::vector<Problem>& problems_;
    std::set<std::string> sceneSlugs_;
};

} // namespace

const std::vector<std::string>& sweepErrors() {
    static const std::vector<std::string> errors{"flip", "mse", "rmse", "ssim"};
    return errors;
}

Sweep parseSweep(std::string_view text, const std::string& file) {
    std::vector<Problem> problems;
    Sweep sweep = SweepReader(problems).read(Json::parse(text, file), file);
    std::ranges::stable_sort(problems, {}, [](const Problem& problem) {
        return std::pair(problem.where.line, problem.where.column);
    });
    if (!problems.empty()) throw InputError(std::move(problems));
    sweep.text = text;
    if (sweep.plotError.empty()) sweep.plotError = "flip";
    return sweep;
}

Sweep loadSweep(const std::filesystem::path& file) { return parseSweep(readText(file), file.string()); }

} // namespace kestrel
