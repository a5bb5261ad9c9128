"""What the tests of the Python module share."""
import kestrel
from kestrel_cli import Skipped

SCENE, SIZE = "builtin:tower?detail=0.05", (64, 36)


def need_numpy():
    try:
        import numpy
    except ImportError:
        raise Skipped("there is no numpy") from None
    return numpy


def refused(call, error=kestrel.InputError):
    """Calls what must be refused; the error."""
    try:
        call()
    except error as told:
        return told
    raise AssertionError("it was not refused")
