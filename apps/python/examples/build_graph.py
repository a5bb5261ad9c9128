"""A graph from nothing, its mistakes all at once, and what it sees as arrays: build_graph.py [WIDTH HEIGHT]."""
import sys

import kestrel
from kestrel import passes

size = [int(side) for side in sys.argv[1:]] or [320, 180]
graph = kestrel.Graph()
graph.name, graph.scene = "Ambient occlusion by a BVH", "builtin:blob"
graph.add(passes.GBuffer, "gbuffer")
graph.add(passes.Bvh, "bvh")
graph.add(passes.RayAmbientOcclusion, "ao", rays=4)
graph.connect("bvh.tracer", "ao.tracer")
try:
    graph.validate()
except kestrel.InputError as error:
    for problem in error.problems:
        print("not yet:", problem)

for port in ["depth", "normal", "face_normal"]:
    graph.connect(f"gbuffer.{port}", f"ao.{port}")
graph.outputs = ["ao.visibility", "gbuffer.coverage"]
graph.save("bvh_ao.json")
arrays = kestrel.render(graph, size=size)
seen = arrays["gbuffer.coverage"] > 0.5
print(f"{100 * seen.mean():.0f} % of the picture is covered, {100 * arrays['ao.visibility'][seen].mean():.0f} % of its sky is open")
