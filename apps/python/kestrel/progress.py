"""Progress for notebooks and terminals."""
from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

Progress = Callable[[float, str], Any]


def show(fraction: float, what: str) -> None:
    """One line on standard error that is written over, and taken away at the end: what `progress=True` stands for."""
    bar = "#" * round(20 * fraction)
    line = f"[{bar:<20}] {round(100 * fraction):3} % {what[:60]:<60}"
    sys.stderr.write(f"\r{line}" if fraction < 1 else f"\r{'':{len(line)}}\r")
    sys.stderr.flush()


def function(progress: Progress | bool | None) -> Progress | None:
    """The function that an argument `progress` stands for."""
    if progress is None or isinstance(progress, bool):
        return show if progress else None
    if not callable(progress):
        raise TypeError(f"progress must be a function, a bool or None, not {type(progress).__name__}")
    return progress
