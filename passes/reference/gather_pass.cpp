#include "gather_pass.h"
#include "draw/face_input.h"
#include "draw/no_light.h"
#include "execute/commands.h"
#include "shared/ray.h"
#include <algorithm>

namespace kestrel {

Declaration declareGather(const Inputs& inputs, const std::vector<std::string>& reads,
                          const std::vector<std::string>& writes, const std::string& leftOut) {
    Declaration declaration;
    const Desc& position = inputs["position"].desc;
    Step step{.name = "gather", .group = "reference"};
    for (const std::string& port : reads) step.uses.push_back({.port = port, .access = Access::Host});
    const bool empty = inputs["position"].constant.has_value();
    for (const std::string& port : writes) {
        const Format format = port == "result" ? Format::RGBA32F : Format::R32F;
        declaration.outputs.push_back(
            {.port = port, .desc = Desc::texture2D(format, position.extent, position.view)});
        if (empty || !leftOut.empty())
            declaration.outputs.back().constant = port == "result" ? noLight : glm::vec4(0);
        step.uses.push_back({.port = port, .access = Access::Copy, .write = true});
    }
    if (empty || !leftOut.empty()) {
        declaration.leftOut.push_back({"tracing", empty ? "there is nothing in view" : leftOut});
        return declaration;
    }
    useFaceNormal(declaration, step, inputs, Access::Host);
    declaration.steps.push_back(std::move(step));
    declaration.depends =
        Causes::Geometry | Causes::Transforms | Causes::Materials | Causes::Lights | Causes::Properties;
    return declaration;
}

GatherSettings gatherSettings(Commands& commands, int samples, float distance) {
    GatherSettings settings;
    settings.samples = samples;
    if (distance > 0) settings.maximumDistance = distance;
    settings.seed = commands.frame().seed;
    settings.progress = [&commands](double fraction) { commands.progress(fraction); };
    return settings;
}

GatherInputs gatherInputs(const Step& step, Commands& commands) {
    GatherInputs inputs;
    inputs.position = commands.downloadImage("position");
    inputs.normal = commands.downloadImage("normal");
    inputs.faceNormal = facesOf(step, commands, inputs.position, inputs.normal);
    return inputs;
}

Image facesOf(const Step& step, Commands& commands, const Image& position, const Image& normal) {
    if (usesFaceNormal(step)) return commands.downloadImage("face_normal");
    const glm::vec3 eye = commands.frame().cameraState.position;
    Image faces(normal.width, normal.height, 4);
    for (int y = 0; y < faces.height; ++y)
        for (int x = 0; x < faces.width; ++x) {
            glm::vec3 n(0), p(0);
            for (int k = 0; k < 3; ++k) {
                n[k] = normal.at(x, y, k);
                p[k] = position.at(x, y, k);
            }
            if (n == glm::vec3(0)) continue;
            const glm::vec3 size = glm::abs(p), unit = glm::normalize(n);
            for (int k = 0; k < 3; ++k) faces.at(x, y, k) = unit[k];
            faces.at(x, y, 3) = shared::rayStart(glm::length(p - eye), std::max({size.x, size.y, size.z}), 0);
        }
    return faces;
}

Image withOpaqueAlpha(const Image& colour) {
    Image result(colour.width, colour.height, 4, 1.0f);
    for (int y = 0; y < colour.height; ++y)
        for (int x = 0; x < colour.width; ++x)
            for (int k = 0; k < 3; ++k) result.at(x, y, k) = colour.at(x, y, k);
    return result;
}

void finishGather(Commands& commands, const GatherResult& result) {
    commands.uploadImage("result", withOpaqueAlpha(result.light));
    commands.report("noise", result.noise);
    commands.report("samples", static_cast<double>(result.samples));
}

} // namespace kestrel
