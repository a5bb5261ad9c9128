"""A sweep from Python, and its plot of error against time (error_over_time.png): error_over_time.py [WIDTH HEIGHT]."""
import json
import sys
from pathlib import Path

import kestrel
import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot

study = {
    "kestrel_sweep": 1, "title": "Three tracers", "size": [int(side) for side in sys.argv[1:]] or [320, 180],
    "frames": 8, "repeats": 3, "scenes": ["builtin:tower"],
    "reference": {"graph": "reference_ao.json", "output": "reference.visibility", "mask": "gbuffer.coverage"},
    "variants": [{"name": name, "graph": "sweeps/graphs/ao.json", "output": "mean.result",
                  "set": [f"ao.tracer={tracer}.tracer"], "axes": {"bom.resolution": [32, 64, 128]} if tracer == "roma" else {}}
                 for name, tracer in [("ROMA", "roma"), ("distance field", "field"), ("BVH", "bvh")]]}
Path("study.json").write_text(json.dumps(study))
rows = kestrel.sweep("study.json", "results", resume=True, progress=True)

for series in dict.fromkeys(row["series"] for row in rows):
    points = sorted((row["ms total"], row["flip"]) for row in rows if row["series"] == series)
    pyplot.plot(*zip(*points), "o-", label=series)
pyplot.xlabel("time of a frame (ms)")
pyplot.ylabel("error (FLIP)")
pyplot.legend()
pyplot.savefig("error_over_time.png")
