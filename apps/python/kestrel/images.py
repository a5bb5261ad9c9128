"""Errors between pictures, and pictures in files. Arrays are (height, width) or (height, width, channels) of floats, bool
or uint8 (0 to 255, for 0 to 1); what goes in is copied once, what comes out is float32 and is not."""
from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

from . import _kestrel

if TYPE_CHECKING:
    import numpy


def compare(reference: numpy.ndarray, test: numpy.ndarray, *, mask: numpy.ndarray | None = None, hdr: bool = False,
            pixels_per_degree: float | None = None) -> dict[str, Any]:
    """The errors of `test`: "mse", "rmse", "psnr" (None for equal pictures), "ssim", and "flip" with "mean",
    "weighted_median", "q1", "q3", "min", "max".

    hdr     linear light without an upper limit, for HDR-FLIP; else sRGB code values in [0, 1] (see to_srgb)
    mask    only pixels above 0.5 count
    """
    return json.loads(_kestrel.compare(reference, test, mask, hdr, pixels_per_degree))


def flip(reference: numpy.ndarray, test: numpy.ndarray, *, hdr: bool = False,
         pixels_per_degree: float | None = None) -> numpy.ndarray:
    """The FLIP error of each pixel, in [0, 1]."""
    return _kestrel.flip(reference, test, hdr, pixels_per_degree)


def heat_map(errors: numpy.ndarray) -> numpy.ndarray:
    """Errors in [0, 1] as colours (magma), sRGB code values."""
    return _kestrel.heat_map(errors)


def to_srgb(linear: numpy.ndarray) -> numpy.ndarray:
    """Linear light as sRGB code values; a fourth channel stays."""
    return _kestrel.to_srgb(linear)


def read_image(file: str | os.PathLike[str]) -> numpy.ndarray:
    """A PNG (its code values in [0, 1]), HDR or EXR file, or a layer of one: "file.exr:beauty"."""
    return _kestrel.read_image(os.fspath(file))


def write_image(file: str | os.PathLike[str], image: numpy.ndarray, *, display: bool = False) -> None:
    """Writes .png, .hdr or .exr. Colours in a PNG get the sRGB curve, unless they are `display` values already."""
    _kestrel.write_image(os.fspath(file), image, display)
