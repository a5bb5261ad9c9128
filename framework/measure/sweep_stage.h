// One scene of a sweep with its reference: where points are opened, held against the reference, and timed.
#pragma once
#include "execute/renderer.h"
#include "measure/sweep_results.h"
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace kestrel {

namespace gl {
class Context;
}

// What all scenes of a run share.
struct SweepRun {
    const Sweep& sweep;
    const Registry& registry;
    gl::Context& context;
    const SweepFolder& folder;
    std::function<void(const std::string& what)> tell; // what is done now; never empty
};

// Errors without a picture beside them: one of both is there, or none where no pixel counts.
struct SweepComparison {
    std::optional<SweepErrors> errors;
    std::optional<SweepRayFigures> rays;
};

class SweepStage {
public:
    // Takes the reference from the folder, or makes it and leaves it there. Throws InputError for a scene or
    // a reference that fails.
    SweepStage(const SweepRun& run, const SweepScene& scene);

    // A renderer of the point before its first frame. Throws InputError.
    [[nodiscard]] std::unique_ptr<Renderer> open(const SweepPoint& point);
    // Makes a renderer of this scene one of another point's, with nothing kept of its frames; what is made of
    // the scene alone, and made alike by the other point, is kept. Throws InputError.
    void change(Renderer& renderer, const SweepPoint& point) const;

    // What the last frame shows against the reference; the FLIP error map where it is asked for. A reference
    // of nothing, and a mask that is 0 everywhere, give no figures. `only`: the one error that is wanted
    // ("mse", "rmse", "ssim" or "flip"); those that take long are left out beside it, and stay 0.
    [[nodiscard]] SweepComparison compare(Renderer& renderer, const SweepPoint& point,
                                          Image* flipMap = nullptr, const std::string& only = {}) const;
    // The error of a point's picture, `first`, taken apart: renders it again from another seed, its exact
    // tracing from both, and once a scene the reference from another seed. Nothing where no pixel counts.
    // Throws InputError.
    [[nodiscard]] std::optional<ErrorSplit> split(const SweepPoint& point, const Image& first);
    // One repetition of timed frames; of a renderer that was just made, `fresh`, the first is never timed.
    [[nodiscard]] std::vector<SweepFrame> timeTurn(Renderer& renderer, bool fresh) const;

    [[nodiscard]] const SweepScene& scene() const { return scene_; }
    [[nodiscard]] const SweepReferenceRecord& reference() const { return record_; }

private:
    [[nodiscard]] std::vector<PortRef> outputsOf(const SweepPoint& point) const;
    [[nodiscard]] std::unique_ptr<Renderer> open(const std::string& graphName,
                                                 const std::vector<SweepSetting>& settings,
                                                 const std::vector<PortRef>& outputs, const Location& where);
    const Scene& sceneUnder(const SceneSetup& setup);
    [[nodiscard]] double timeOfPicture(const Renderer& renderer) const;
    void readReference();
    // The reference from a seed; its mask and reports where they are asked for.
    Image renderReference(std::uint32_t seed, Image* mask, std::map<std::string, double>* reports);
    void takeSecondReference();
    [[nodiscard]] Image picture(const SweepPoint& point, std::uint32_t seed);
    void renderReference();
    void traceReference();
    [[nodiscard]] bool blankMask() const;
    void nextFrame(Renderer& renderer) const;

    const SweepRun& run_;
    const Sweep& sweep_;
    const SweepScene& scene_;
    Scene loaded_;
    std::optional<std::string> loadedSetup_; // of loaded_
    std::set<std::string> warned_;
    SweepReferenceRecord record_;
    Image reference_, mask_;
    Image second_;                 // the reference from another seed; empty: not asked for yet
    std::vector<float> distances_; // of the reference's hits
};

// What the passes reported in the last frame: "pass.key".
std::map<std::string, double> sweepReports(const Renderer& renderer);

// A picture as it is shown: light under the exposure, in sRGB; anything else as it is.
void writeSweepPicture(const std::filesystem::path& file, Image image, bool light, double exposure);

// All mistakes of an error in one line.
std::string sweepMessage(const Error& error);

} // namespace kestrel
