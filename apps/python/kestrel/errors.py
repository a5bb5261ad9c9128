"""What Kestrel raises, with all problems at once and the place of each."""
from __future__ import annotations

from typing import NamedTuple


class Problem(NamedTuple):
    """One thing that is wrong, and where: a file (or what stands for one), line and column from 1, 0 where unknown."""
    message: str
    file: str = ""
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        place = ":".join(str(part) for part in (self.file, self.line, self.column) if part)
        return f"{place}: {self.message}" if place else self.message


class Error(Exception):
    """Base of all errors of Kestrel; its text has a line a problem."""

    def __init__(self, problems: list[Problem]):
        super().__init__("\n".join(map(str, problems)))
        self.problems = problems

    def __reduce__(self):
        return type(self), (self.problems,)


class MeasureError(Error):
    """A measured check failed: values that are not finite, with `check_finite`."""


class InputError(Error, ValueError):
    """Something that was given is wrong: a graph, a scene, a file, a value, an array."""


class MachineError(Error, RuntimeError):
    """The machine lacks something: OpenGL 4.6, a part that this build was made without."""


def made(status: int, problems: list[tuple]) -> Error:
    """The error of an exit status (1, 2, 3) of the command line."""
    return {1: MeasureError, 3: MachineError}.get(status, InputError)([Problem(*problem) for problem in problems])
