"""Rendering: a graph on a scene, frame after frame, its outputs as numpy arrays."""
from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from . import _kestrel
from .graph import Graph, load
from .progress import Progress, function

if TYPE_CHECKING:
    import numpy

Described = str | Mapping[str, Any]


def _text(described: Described | None) -> str:
    return "" if described is None else described if isinstance(described, str) else json.dumps(dict(described))


class Renderer:
    """A graph on a scene, on this machine's OpenGL; no display is needed.

    graph       a Graph, or what `kestrel.load` takes. A Graph stays in use: what is changed in it acts with the next frame,
                and what a change makes wrong is raised there, with the renderer as it was
    scene       "builtin:NAME" or a glTF file; default: the graph's. It stays that of the beginning, with its camera and lights
    camera      the name or number of a camera of the scene, or one of one's own:
                {"eye": [4, 3, 6], "target": [0, 1, 0], "fov": 50}, or the same as `--camera` takes it
    lights      further ones, as `--light` takes them, or as mappings
    animation   which one plays: its name, its number, "none" or "all"
    time, fps   the scene's time in the first frame, in seconds, and its frames a second
    time_step   seconds of the scene from frame to frame in place of 1 / fps; 0: it stands still
    timing      times every step, for `stats()` and a frame's "steps"
    check_finite  MeasureError at the first frame that makes a value that is not finite or out of its range
    keep_all    leaves nothing out
    previews    further ports that can be read, "pass.port"
    progress    called as (fraction, what) during long steps, from another thread; True: a line on standard error.
                What it raises is raised by frame(), once the frame is done

    The interpreter's lock is released while anything is rendered, read or compiled; all renderers of a process share one
    OpenGL context and take turns.
    """

    def __init__(self, graph: Graph | str | os.PathLike[str], scene: str | os.PathLike[str] | None = None, *,
                 size: Sequence[int] = (640, 360), seed: int = 0, camera: Described | None = None,
                 lights: Sequence[Described] = (), animation: str = "", time: float | None = None,
                 fps: float | None = None, time_step: float | None = None, timing: bool = False,
                 check_finite: bool = False, keep_all: bool = False, previews: Sequence[str] = (),
                 allow_outside: bool = False, progress: Progress | bool | None = None):
        self.graph = graph if isinstance(graph, Graph) else load(graph)
        self._native = _kestrel.Renderer(self.graph._document, {
            "scene": "" if scene is None else os.fspath(scene), "size": list(size), "seed": seed,
            "camera": _text(camera), "lights": [_text(light) for light in lights], "animation": animation,
            "time": time, "fps": fps, "time_step": time_step, "timing": timing, "check_finite": check_finite,
            "keep_all": keep_all, "previews": list(previews), "allow_outside": allow_outside,
            "progress": function(progress)})
        self._taken = self._state()

    def _state(self) -> tuple[Graph, int]:
        return self.graph, self.graph._document.revision

    def _take(self) -> None:
        graph, revision = self._state()
        if self._taken[0] is not graph or self._taken[1] != revision:
            self._native.set_graph(graph._document)
            self._taken = graph, revision

    def frame(self) -> dict[str, Any]:
        """Renders one frame: its "index", the wall clock "ms", what passes report as "values" by pass and name, and with
        timing its "steps". Read the pictures by read(), or all outputs by outputs()."""
        self._take()
        return self._native.frame()

    def render(self, frames: int = 1) -> dict[str, numpy.ndarray]:
        """Renders so many frames and returns the outputs of the last."""
        for _ in range(frames):
            self.frame()
        return self.outputs()

    def read(self, port: str, layer: int | None = None, mip: int = 0) -> numpy.ndarray:
        """What a port, "pass.port", held after the last frame: an output, a preview, or whatever else has memory of its own.

        A texture is float32 of (height, width), or (height, width, channels) where it has several, rows from the top;
        arrays, volumes and cubes have the layers in front, unless one is chosen. A buffer is uint8, for `.view(dtype)`.
        OpenGL copies once, into memory that the array then owns; several layers are copied once more.
        """
        return self._native.read(port, layer, mip)

    __getitem__ = read

    def outputs(self) -> dict[str, numpy.ndarray]:
        """Every output of the graph by its name, "pass.port"."""
        return {port: self.read(port) for port in self._native.outputs()}

    @property
    def plan(self) -> dict[str, Any]:
        """What runs in which order on which memory, as `kestrel check --json` tells it."""
        self._take()
        return json.loads(self._native.plan())

    @property
    def left_out(self) -> list[dict[str, str]]:
        """What is not made for this scene and these outputs: "what", and "why"."""
        return self.plan["left_out"]

    def stats(self) -> dict[str, Any]:
        """Times, memory and what was left out over all frames so far, as `render --stats` writes it."""
        return json.loads(self._native.stats())

    def restart(self) -> None:
        """The next frame is the first: nothing is kept."""
        self._native.restart()

    def set_time(self, seconds: float) -> None:
        """The scene's time in the next frame."""
        self._native.set_time(seconds)

    def set_size(self, size: Sequence[int]) -> None:
        """Width and height of the next frame in pixels."""
        self._native.set_size(list(size))

    def set_previews(self, ports: Sequence[str]) -> None:
        """Which further ports can be read after the next frame."""
        self._native.set_previews(list(ports))


def render(graph: Graph | str | os.PathLike[str], scene: str | os.PathLike[str] | None = None, *, frames: int = 1,
           **options: Any) -> dict[str, numpy.ndarray]:
    """The outputs of a graph after some frames, with the options of Renderer."""
    return Renderer(graph, scene, **options).render(frames)
