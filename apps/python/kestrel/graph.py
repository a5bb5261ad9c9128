"""Graphs as documents: passes, edges, properties, outputs. Nothing here needs OpenGL."""
from __future__ import annotations

import difflib
import functools
import itertools
import os
import tempfile
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, TypeVar

from . import _kestrel

if TYPE_CHECKING:
    import numpy


_count = itertools.count()


@functools.cache
def _folder() -> tempfile.TemporaryDirectory:
    return tempfile.TemporaryDirectory(prefix="kestrel_pictures_")


class Pass:
    """A pass of a graph: its properties are attributes, with the table's ranges. `del` gives one its default back.

    A property that follows a variable of the graph sets the variable, with all that follow it.
    """
    __slots__ = ("_graph", "name")

    def __init__(self, graph: Graph, name: str):
        object.__setattr__(self, "_graph", graph)
        object.__setattr__(self, "name", name)

    @property
    def type(self) -> str:
        """The name of its type, which is that of its class in kestrel.passes."""
        return self._graph._document.pass_type(self.name)

    @property
    def muted(self) -> bool:
        """Does nothing: each output is the first connected input that can stand for it."""
        return self._graph._document.muted(self.name)

    @muted.setter
    def muted(self, muted: bool) -> None:
        self._graph._document.mute(self.name, muted)

    def properties(self) -> dict[str, Any]:
        """Every property with its value, given or by default."""
        return {name: getattr(self, name) for name in type(self).__annotations__}

    def __setattr__(self, name: str, value: Any) -> None:
        if not isinstance(getattr(type(self), name, None), property):
            near = difflib.get_close_matches(name, type(self).__annotations__, 1)
            raise AttributeError(f"{type(self).__name__} '{self.name}' has no property '{name}'"
                                 + (f" (did you mean '{near[0]}'?)" if near else ""), name=name, obj=self)
        object.__setattr__(self, name, value)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *type(self).__annotations__})

    def __repr__(self) -> str:
        told = ", ".join(f"{name}={value!r}" for name, value in self.properties().items())
        return f"<{type(self).__name__} '{self.name}'{': ' + told if told else ''}>"


P = TypeVar("P", bound=Pass)


class Graph:
    """A graph document; `kestrel.load` reads one. `graph["ao"]` is a pass, and so is `graph.ao` where nothing else is
    called so. Mistakes raise InputError and change nothing."""

    def __init__(self, document: Any = None):
        self._document = _kestrel.Document() if document is None else document

    @staticmethod
    def parse(text: str, file: str = "text") -> Graph:
        """Reads the JSON form; `file` is named in problems."""
        return Graph(_kestrel.Document.parse(text, file))

    name: str = property(lambda self: self._document.name, lambda self, name: setattr(self._document, "name", name),
                         doc="Its title.")
    comment: str = property(lambda self: self._document.comment,
                            lambda self, text: setattr(self._document, "comment", text), doc="What it says of itself.")
    scene: str = property(lambda self: self._document.scene, lambda self, scene: setattr(self._document, "scene", scene),
                          doc='"builtin:NAME" or a file, relative to the folder of the graph\'s own.')
    outputs: list[str] = property(lambda self: list(self._document.outputs),
                                  lambda self, ports: setattr(self._document, "outputs", ports),
                                  doc='What it renders, as "pass.port"; to be set as a whole.')
    edges: list[tuple[str, str]] = property(lambda self: self._document.edges,
                                            doc='Pairs of an output and the input that it feeds, as "pass.port".')
    variables: dict[str, Any] = property(lambda self: self._document.variables,
                                         doc="Values that properties of several passes follow.")
    file: str = property(lambda self: self._document.file, doc="Where it was loaded from.")

    def __iter__(self) -> Iterator[str]:
        return iter(self._document.pass_names)

    def __len__(self) -> int:
        return len(self._document.pass_names)

    def __contains__(self, name: str) -> bool:
        return name in self._document.pass_names

    def __getitem__(self, name: str) -> Pass:
        from . import passes
        kind = self._document.pass_type(name)
        return getattr(passes, kind, Pass)(self, name)

    def __getattr__(self, name: str) -> Pass:
        if not name.startswith("_") and name in self:
            return self[name]
        raise AttributeError(f"the graph has no pass '{name}'", name=name, obj=self)

    def __setattr__(self, name: str, value: Any) -> None:
        if name != "_document" and not isinstance(getattr(type(self), name, None), property):
            raise AttributeError(f"'{name}' is no attribute of a graph that can be set", name=name, obj=self)
        object.__setattr__(self, name, value)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self})

    def passes(self) -> list[Pass]:
        """All passes, in the document's order."""
        return [self[name] for name in self]

    def add(self, type: type[P] | str, name: str, **properties: Any) -> P:
        """Adds a pass: `graph.add(passes.Roma, "roma", angular=4)`."""
        self._document.add(type if isinstance(type, str) else type.__name__, name, properties)
        return self[name]

    def show(self, name: str, picture: numpy.ndarray, **properties: Any) -> Pass:
        """Makes an array the picture of a pass of type Image, which is added where the graph has none of that name: its
        output "image" has the array's values to the bit, of three channels with alpha 1. It is copied once, into a file
        that lasts as long as the interpreter; a graph that is to be saved names a file of one's own."""
        file = os.path.join(_folder().name, f"{next(_count)}.exr")
        _kestrel.write_image(file, picture, False)
        changed = self.copy()
        if name not in changed:
            changed.add("Image", name)
        for key, value in {**properties, "file": file}.items():
            setattr(changed[name], key, value)
        self._document.assign(changed._document)
        return self[name]

    def remove(self, name: str) -> None:
        """Removes a pass, its edges and its outputs."""
        self._document.remove(name)

    def rename(self, name: str, to: str) -> None:
        """Gives a pass another name, wherever it stands in the graph."""
        self._document.rename(name, to)

    def connect(self, output: str, input: str) -> None:
        """Feeds an input, "pass.port", by an output; whatever fed it before does so no more."""
        self._document.connect(output, input)

    def disconnect(self, input: str) -> None:
        """Takes away the edge that feeds an input."""
        self._document.disconnect(input)

    def set(self, *settings: str) -> Graph:
        """Changes it as `--set` does: "pass.property=value", "variable=value", "pass.input=pass.output". Returns itself."""
        for setting in settings:
            self._document.set(setting)
        return self

    def validate(self) -> None:
        """Raises InputError with everything that is wrong with it."""
        self._document.validate()

    def copy(self) -> Graph:
        """A graph of its own."""
        return Graph(self._document.copy())

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes the JSON form."""
        self._document.save(os.fspath(file))

    def __str__(self) -> str:
        return self._document.text()

    def __repr__(self) -> str:
        return f"<Graph '{self.name}': {', '.join(self)}>"

    def __eq__(self, other: object) -> bool:
        return str(self) == str(other) if isinstance(other, Graph) else NotImplemented

    __hash__ = None


def load(graph: str | os.PathLike[str]) -> Graph:
    """Reads a graph file, or one that comes with Kestrel by its name: `load("ray_ao.json")`."""
    return Graph(_kestrel.Document.load(os.fspath(graph)))
