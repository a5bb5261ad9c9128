"""Kestrel: which technique gives which error at which run time.

    import kestrel
    renderer = kestrel.Renderer("ray_ao.json", size=(320, 180))
    picture = renderer.render(frames=16)["mean.result"]
"""
from . import _kestrel
from .errors import Error, InputError, MachineError, MeasureError, Problem
from .graph import Graph, Pass, load
from . import passes
from .images import compare, flip, heat_map, read_image, to_srgb, write_image
from .renderer import Renderer, render
from .sweeps import read_rows, sweep

__version__: str = _kestrel.version
parts: str = _kestrel.parts
__all__ = ["Error", "Graph", "InputError", "MachineError", "MeasureError", "Pass", "Problem", "Renderer", "compare", "flip",
           "heat_map", "load", "parts", "passes", "read_image", "read_rows", "render", "sweep", "to_srgb", "write_image"]
