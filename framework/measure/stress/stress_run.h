// Runs stress cases in this process. What may crash or hang: stress_workers.h runs them in others.
#pragma once
#include "execute/renderer.h"
#include "measure/stress/stress_distance.h"
#include "measure/stress/stress_results.h"
#include <functional>
#include <optional>

namespace kestrel {

struct StressOptions {
    Extent size{64, 36, 1};
    bool keepAll = false;                // of every case
    std::filesystem::path pictures = {}; // folder for pictures of what is missed; empty: none are written
    std::filesystem::path keep = {};     // folder for the outputs' pictures of every case; empty: none are
    std::optional<int> frames = {};      // of every case, in place of its own
    std::function<void(const std::string& step)> begins = {}; // told before each step runs
};

// The file in StressOptions::keep of a case's picture of "pass.port".
[[nodiscard]] std::string keptPictureName(const std::string& name, const std::string& port);

class StressRunner {
public:
    // On the current context. The graph must be valid; its scene setup counts for the user's scene only,
    // which is set up already.
    StressRunner(Graph graph, Scene scene, const Registry& registry, const Capabilities& capabilities,
                 StressOptions options);

    // Never throws an Error: what a graph or a device refuses is an outcome. `command` stays empty.
    StressResult run(const StressCase& one);

private:
    using Pictures = std::map<std::string, Image>; // of the graph's outputs that can be compared, by port
    struct Rendered {
        Pictures pictures;
        std::vector<BadOutput> bad; // the first of each port
        std::map<std::string, StressMean>
            light;                  // by port that carries light, of all frames; of closed rooms only
        std::vector<PortRef> ports; // that were looked at
    };
    // The plain scene in pictures of one size and number of frames.
    struct Base {
        Pictures picture;
        std::map<std::string, StressDistance> seeds; // by port
    };

    [[nodiscard]] Rendered render(const StressCase& one, const SceneEdit& edit, std::uint32_t seed,
                                  bool plain);
    void applyEvent(Renderer& renderer, const StressEvent& event, const CameraState& camera) const;
    [[nodiscard]] const Base& base(const StressCase& one);
    [[nodiscard]] Pictures read(Renderer& renderer) const;
    [[nodiscard]] const PortInfo* portInfo(const PortRef& port) const;

    void addEnergy(StressResult& result, const StressCase& one, const Rendered& rendered) const;
    void addFinite(StressResult& result, const Rendered& rendered) const;
    void addComparison(StressResult& result, const StressCase& one, const Pictures& truth,
                       const std::map<std::string, StressDistance>& seeds, const Pictures& pictures) const;
    void keepPicture(StressCheck& check, const StressCase& one, const Image& truth, const Image& image) const;

    Graph graph_;
    Scene scene_;
    double radius_ = 1; // of scene_
    const Registry& registry_;
    Capabilities capabilities_;
    StressOptions options_;
    std::map<std::string, Base> bases_;
};

} // namespace kestrel
