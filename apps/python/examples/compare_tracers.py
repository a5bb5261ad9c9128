"""Each tracer of the sweeps' graph against Embree, with heat maps: compare_tracers.py [WIDTH HEIGHT]."""
import sys

import kestrel

size = [int(side) for side in sys.argv[1:]] or [320, 180]
reference = kestrel.load("reference_ao.json")
reference.outputs = ["reference.visibility", "gbuffer.coverage"]
truth = kestrel.render(reference, "builtin:tower", size=size)
mask = truth["gbuffer.coverage"]

graph = kestrel.load("sweeps/graphs/ao.json")
print(f"{'tracer':<8}{'FLIP':>8}{'MSE':>9}{'ms':>8}")
for tracer in ["roma", "field", "bvh"]:
    graph.connect(f"{tracer}.tracer", "ao.tracer")
    renderer = kestrel.Renderer(graph, "builtin:tower", size=size, time_step=0)
    picture = renderer.render(frames=8)["mean.result"]
    errors = kestrel.compare(truth["reference.visibility"], picture, mask=mask)
    kestrel.write_image(f"{tracer}.flip.png", kestrel.heat_map(kestrel.flip(truth["reference.visibility"], picture)),
                        display=True)
    ms = renderer.stats()["frame_ms"]["median"]
    print(f"{tracer:<8}{errors['flip']['mean']:8.4f}{errors['mse']:9.5f}{ms:8.1f}")
