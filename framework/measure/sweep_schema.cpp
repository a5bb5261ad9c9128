#include "measure/sweep_schema.h"
#include "measure/sweep_keys.h"

namespace kestrel {

std::string sweepSchema() {
    SchemaJson json = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                       {"title", "A Kestrel sweep"}};
    json.update(sweepKeys().schema());
    const SchemaJson axis = sweepAxisKeys().schema();
    SchemaJson variant = sweepVariantKeys().schema();
    variant["oneOf"] = {{{"required", {"output"}}}, {{"required", {"hits"}}}};
    json["$defs"] = {
        {"port", {{"type", "string"}, {"pattern", "^[a-z][a-z0-9_]*\\.[a-z][a-z0-9_]*$"}}},
        {"settings",
         {{"type", "array"},
          {"items", {{"type", "string"}}},
          {"description", "As --set takes them: pass.property=value, or pass.input=pass.output"}}},
        {"scalar", {{"type", {"string", "number", "boolean"}}}},
        {"axis", {{"anyOf", {axis["properties"]["values"], axis}}}}, // the short form is the values alone
        {"variant", variant}};
    return json.dump(2) + "\n";
}

} // namespace kestrel
