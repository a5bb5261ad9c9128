// The tables of keys. A key that is added here is read, checked, and stands in the schema.
#include "measure/sweep_keys.h"
#include "scene/setup_keys.h"

namespace kestrel {
namespace {

SchemaJson listOf(SchemaJson items, int least = 0) {
    SchemaJson json = {{"type", "array"}, {"items", std::move(items)}};
    if (least > 0) json["minItems"] = least;
    return json;
}

SchemaJson mapOf(SchemaJson values) {
    return {{"type", "object"}, {"additionalProperties", std::move(values)}};
}

SchemaJson sizeSchema() {
    SchemaJson json = listOf({{"type", "integer"}, {"minimum", 1}, {"maximum", maxSweepSide}}, 2);
    json["maxItems"] = 2;
    json["default"] = {Sweep().size.width, Sweep().size.height};
    return json;
}

SchemaJson timesSchema() {
    SchemaJson json = mapOf(listOf({{"type", "string"}, {"pattern", "^(-.+|[^-].*)$"}}, 1));
    json["propertyNames"] = {{"not", {{"enum", {"total", "frame"}}}}};
    json["description"] = "Each the sum of groups and passes, those with '-' before them subtracted";
    return json;
}

const char* const sceneSource =
    "\"builtin:NAME\", or a file: absolute, or as it is named from the folder of the sweep file";
const char* const graphFile =
    "A graph file: absolute, as it is named from the folder of the sweep file, or the "
    "name of one that comes with Kestrel";

SchemaJson scenesSchema() {
    return listOf(
        {{"anyOf", {{{"type", "string"}, {"description", sceneSource}}, sweepSceneKeys().schema()}}}, 1);
}

SchemaJson exclusionSchema() {
    SchemaJson json = mapOf({{"$ref", "#/$defs/scalar"}});
    json["minProperties"] = 1;
    return listOf(std::move(json));
}

SchemaJson valuesSchema() {
    return listOf({{"anyOf", {{{"$ref", "#/$defs/scalar"}}, sweepAxisValueKeys().schema()}}}, 1);
}

SchemaJson exactSchema() {
    return {{"$ref", "#/$defs/settings"},
            {"description",
             "With these, after all others, the graph traces the same map or field exactly: the "
             "mean squared error is taken apart"}};
}

SchemaJson rangeSchema() {
    SchemaJson json = listOf({{"type", "number"}}, 2);
    json["maxItems"] = 2;
    json["description"] = "From the first to the second";
    return json;
}

SchemaJson freeSchema() {
    SchemaJson choices = listOf({{"$ref", "#/$defs/scalar"}}, 2);
    choices["description"] = "Two numbers are a range, anything else is a list of choices";
    SchemaJson json = mapOf({{"anyOf", {std::move(choices), sweepFreeKeys().schema()}}});
    json["propertyNames"] = {{"$ref", "#/$defs/port"}};
    json["minProperties"] = 1;
    json["description"] = "Properties that 'kestrel tune' finds the best values of";
    return json;
}

SchemaJson sceneNamesSchema(const char* description) {
    SchemaJson json = listOf({{"type", "string"}});
    json["description"] = description;
    return json;
}

SchemaJson templatesSchema() {
    SchemaJson json = listOf({{"type", "string"}, {"pattern", "\\{\\}"}});
    json["description"] = "Settings with {} for the value";
    return json;
}

} // namespace

const std::vector<std::string>& sweepErrors() {
    static const std::vector<std::string> errors{"flip", "mse", "rmse", "ssim"};
    return errors;
}

const SweepKeys<SweepScene>& sweepSceneKeys() {
    static const auto keys = [] {
        SweepKeys<SweepScene> made;
        made.text("source", &SweepScene::source, sceneSource).required();
        made.label("name", &SweepScene::name, "name of a scene", "Of plots and files");
        for (const auto& key : sceneSetupKeys().keys())
            made.custom(key.name, key.kind, key.schema,
                        [read = key.read](SweepReading& reading, const Json& json, SweepScene& into) {
                            read(reading.problems, json, into.setup);
                        });
        return made;
    }();
    return keys;
}

const SweepKeys<SweepReference>& sweepReferenceKeys() {
    static const auto keys =
        SweepKeys<SweepReference>()
            .text("graph", &SweepReference::graph, graphFile)
            .required()
            .port("output", &SweepReference::output, "The picture")
            .required()
            .port("mask", &SweepReference::mask, "Pixels count where it is greater than 0.5")
            .settings(&SweepReference::settings)
            .whole("frames", &SweepReference::frames, 1, maxSweepFrames, "After which the picture is taken");
    return keys;
}

const SweepKeys<SweepRays>& sweepRaysKeys() {
    static const auto keys =
        SweepKeys<SweepRays>()
            .text("graph", &SweepRays::graph, graphFile)
            .required()
            .port("hits", &SweepRays::hits, "What the variants' hits are held against")
            .required()
            .port("rays", &SweepRays::rays, "The rays that all variants trace")
            .required()
            .settings(&SweepRays::settings)
            .whole("frames", &SweepRays::frames, 1, maxSweepFrames, "Those of the last one count");
    return keys;
}

const SweepKeys<SweepAxisValue>& sweepAxisValueKeys() {
    static const auto keys =
        SweepKeys<SweepAxisValue>()
            .label("label", &SweepAxisValue::label, "label of an axis value", "Of the value")
            .required()
            .settings(&SweepAxisValue::settings)
            .required();
    return keys;
}

const SweepKeys<SweepAxisForm>& sweepAxisKeys() {
    static const auto keys =
        SweepKeys<SweepAxisForm>()
            .custom("set", Json::Kind::Array, templatesSchema(),
                    [](SweepReading& reading, const Json& json, SweepAxisForm& form) {
                        form.templates = readSweepSettings(reading, json);
                    })
            .required()
            .custom("values", Json::Kind::Array, valuesSchema(),
                    [](SweepReading&, const Json& json, SweepAxisForm& form) { form.values = &json; })
            .required();
    return keys;
}

const SweepKeys<SweepFreeForm>& sweepFreeKeys() {
    static const auto keys =
        SweepKeys<SweepFreeForm>()
            .custom("range", Json::Kind::Array, rangeSchema(),
                    [](SweepReading&, const Json& json, SweepFreeForm& form) { form.range = &json; })
            .custom("choices", Json::Kind::Array, listOf({{"$ref", "#/$defs/scalar"}}, 1),
                    [](SweepReading&, const Json& json, SweepFreeForm& form) { form.choices = &json; })
            .flag("logarithmic", &SweepFreeForm::logarithmic, "Steps of the range are equal ratios");
    return keys;
}

const SweepKeys<SweepTuning>& sweepTuningKeys() {
    const auto names = [](std::vector<std::string> SweepTuning::*member) {
        return [member](SweepReading& reading, const Json& json, SweepTuning& into) {
            into.*member = readSweepSceneNames(reading, json);
        };
    };
    static const auto keys =
        SweepKeys<SweepTuning>()
            .custom("train", Json::Kind::Array,
                    sceneNamesSchema("Names of scenes over which the mean error is made small"),
                    names(&SweepTuning::train))
            .required()
            .custom("hold_out", Json::Kind::Array,
                    sceneNamesSchema("Names of scenes that only judge; all others where it is absent"),
                    names(&SweepTuning::holdOut))
            .whole("steps", &SweepTuning::steps, 3, 1000, "Values of a range that each round tries")
            .whole("rounds", &SweepTuning::rounds, 1, 100, "Each over narrower ranges")
            .whole("probes", &SweepTuning::probes, 0, 100'000, "Settings of the whole space tried first")
            .number("time", &SweepTuning::mostTime, 0.01, 1e6,
                    "The time of what is found is at most so many times the default's")
            .number("ms", &SweepTuning::mostMs, 0, 1e9,
                    "Instead of 'time': its mean over the scenes of 'train' is at most so many milliseconds");
    return keys;
}

const SweepKeys<SweepVariant>& sweepVariantKeys() {
    static const auto keys =
        SweepKeys<SweepVariant>()
            .label("name", &SweepVariant::name, "name of a variant", "Unique")
            .required()
            .text("comment", &SweepVariant::comment, "For the reader")
            .text("graph", &SweepVariant::graph, graphFile)
            .required()
            .port("output", &SweepVariant::output, "The picture that is held against the reference")
            .port("hits", &SweepVariant::output, "Of RayQuery, held against the hits of 'rays'")
            .settings(&SweepVariant::settings)
            .custom("axes", Json::Kind::Object, mapOf({{"$ref", "#/$defs/axis"}}), readSweepAxes)
            .custom("exclude", Json::Kind::Array, exclusionSchema(), readSweepExclusions)
            .custom("tune", Json::Kind::Object, freeSchema(), readSweepFree)
            .custom("exact", Json::Kind::Array, exactSchema(),
                    [](SweepReading& reading, const Json& json, SweepVariant& into) {
                        into.exact = readSweepSettings(reading, json);
                    })
            .text("series", &SweepVariant::series, "Points of one are joined; {axis} stands for its label")
            .text("along", &SweepVariant::along, "The axis along which they are joined")
            .label("plot", &SweepVariant::plot, "plot of a variant", "Which plot of the scene")
            .whole("frames", &SweepVariant::frames, 1, maxSweepFrames, "Instead of the sweep's");
    return keys;
}

const SweepKeys<Sweep>& sweepPlotKeys() {
    static const auto keys = SweepKeys<Sweep>()
                                 .text("time", &Sweep::plotTime, "\"total\", \"frame\" or one of 'times'")
                                 .choice("error", &Sweep::plotError, sweepErrors(), "the error");
    return keys;
}

const SweepKeys<Sweep>& sweepKeys() {
    using Kind = Json::Kind;
    static const auto keys =
        SweepKeys<Sweep>()
            .custom("kestrel_sweep", Kind::Int, {{"const", 1}},
                    [](SweepReading& reading, const Json& json, Sweep&) {
                        if (json.integer != 1)
                            reading.note(json.where,
                                         "'kestrel_sweep' (the version of the format) must be 1, not " +
                                             std::to_string(json.integer));
                    })
            .required()
            .text("title", &Sweep::title, "Of the page")
            .text("comment", &Sweep::comment, "For the reader")
            .custom("size", std::nullopt, sizeSchema(), readSweepSize)
            .whole("frames", &Sweep::frames, 1, maxSweepFrames, "After which the picture is taken")
            .whole("warm_up", &Sweep::warmUp, 0, maxSweepFrames,
                   "Frames before each repetition that are not timed")
            .whole("repeats", &Sweep::repeats, 1, maxSweepRepeats, "Repetitions of each variant, round-robin")
            .whole("timed_frames", &Sweep::timedFrames, 1, maxSweepFrames, "A repetition")
            .whole("seed", &Sweep::seed, 0, maxSweepSeed, "Of all random numbers")
            .flag("moving", &Sweep::moving, "Scenes move on from frame to frame")
            .flag("rebuild", &Sweep::rebuild, "Everything is made anew in each timed frame")
            .flag("hdr", &Sweep::hdr, "Pictures hold linear light without upper limit")
            .custom("times", Kind::Object, timesSchema(), readSweepTimes)
            .custom("plot", Kind::Object, sweepPlotKeys().schema(),
                    [](SweepReading& reading, const Json& json, Sweep& sweep) {
                        sweepPlotKeys().read(reading, json, "'plot'", sweep);
                    })
            .custom("scenes", Kind::Array, scenesSchema(), readSweepScenes)
            .required()
            .custom("reference", Kind::Object, sweepReferenceKeys().schema(),
                    [](SweepReading& reading, const Json& json, Sweep& sweep) {
                        sweep.reference.emplace().where = json.where;
                        sweepReferenceKeys().read(reading, json, "'reference'", *sweep.reference);
                    })
            .custom("rays", Kind::Object, sweepRaysKeys().schema(),
                    [](SweepReading& reading, const Json& json, Sweep& sweep) {
                        sweep.rays.emplace().where = json.where;
                        sweepRaysKeys().read(reading, json, "'rays'", *sweep.rays);
                    })
            .custom("tune", Kind::Object, sweepTuningKeys().schema(), readSweepTuning)
            // Last: variants are held against the reference and the rays, and are tuned on scenes.
            .custom("variants", Kind::Array, listOf({{"$ref", "#/$defs/variant"}}, 1), readSweepVariants)
            .required();
    return keys;
}

} // namespace kestrel
