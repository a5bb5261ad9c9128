"""Sweeps: error against run time of many variants, as rows."""
from __future__ import annotations

import csv
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from . import _kestrel
from .progress import Progress, function, show

TEXTS = {"scene", "camera", "variant", "kind", "series", "plot", "machine", "failed", "command"}


def _number(text: str) -> Any:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def read_rows(results: str | os.PathLike[str]) -> list[dict[str, Any]]:
    """The rows of a results.csv, or of a folder that has one: what `pandas.DataFrame` takes.

    Numbers are numbers, and None where something was not measured (an equal image has no PSNR); "pareto" is a bool.
    The values of an axis are numbers where all of them are.
    """
    file = Path(results)
    with open(file / "results.csv" if file.is_dir() else file, newline="", encoding="utf-8") as lines:
        rows: list[dict[str, Any]] = list(csv.DictReader(lines))
    for name in rows[0] if rows else ():
        column = [row[name] for row in rows]
        if name == "pareto":
            column = [value == "yes" for value in column]
        elif name.startswith("axis "):
            numbers = [_number(value) if value else None for value in column]
            column = [value or None for value in column] if any(isinstance(value, str) for value in numbers) else numbers
        elif name not in TEXTS:
            column = [_number(value) if value else None for value in column]
        for row, value in zip(rows, column):
            row[name] = value
    return rows


def sweep(file: str | os.PathLike[str], out: str | os.PathLike[str] | None = None, *, resume: bool = False, only: str = "",
          size: Sequence[int] | None = None, frames: int | None = None, shard: str = "", allow_outside: bool = False,
          progress: Progress | bool | None = None) -> list[dict[str, Any]]:
    """Measures a sweep file, as `kestrel sweep` does, and returns its rows (see read_rows).

    `out` is the folder of the results, with pictures and page; without it they are thrown away. An interrupt, or whatever
    `progress` raises, ends it between two measurements; `resume=True` goes on from there. A variant that fails has its
    reason as "failed".
    """
    if out is None:
        with tempfile.TemporaryDirectory(prefix="kestrel_sweep_") as folder:
            return sweep(file, folder, only=only, size=size, frames=frames, shard=shard, allow_outside=allow_outside,
                         progress=progress)
    _kestrel.sweep(os.fspath(file), os.fspath(out), resume, only, None if size is None else list(size), frames, shard,
                   allow_outside, function(progress))
    if progress is True:
        show(1, "")
    return read_rows(out)
