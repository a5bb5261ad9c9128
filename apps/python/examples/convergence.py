"""How the error of an accumulated picture falls with its frames: convergence.py [WIDTH HEIGHT]."""
import sys

import kestrel

size = [int(side) for side in sys.argv[1:]] or [320, 180]
reference = kestrel.load("reference_ao.json").set("reference.samples=256")
truth = kestrel.render(reference, "builtin:tower", size=size, progress=True)["reference.visibility"]
renderer = kestrel.Renderer("ray_ao.json", "builtin:tower", size=size, time_step=0)
for resolution in [64, 128]:
    renderer.graph.bom.resolution = resolution
    renderer.restart()
    errors = {}
    for frame in range(1, 17):
        renderer.frame()
        if frame & (frame - 1) == 0:
            errors[frame] = kestrel.compare(truth, renderer["mean.result"])["rmse"]
    print(f"map of {resolution}:", ", ".join(f"{frame} frames {error:.4f}" for frame, error in errors.items()))
