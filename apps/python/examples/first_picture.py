"""A picture, and the same by another technique: first_picture.py [WIDTH HEIGHT]."""
import sys

import kestrel

size = [int(side) for side in sys.argv[1:]] or [640, 360]
renderer = kestrel.Renderer("ray_ao.json", size=size)
kestrel.write_image("roma.png", renderer.render(frames=16)["mean.result"])

renderer.graph.connect("bvh.tracer", "ao.tracer")  # acts with the next frame
kestrel.write_image("bvh.png", renderer.render(frames=16)["mean.result"])
for item in renderer.left_out:
    print(f"left out: {item['what']}, because {item['why']}")
