"""Progress for notebooks and terminals."""
import sys


def show(fraction: float, what: str) -> None:
    """One line on standard error that is written over, and taken away at the end: what `progress=True` stands for."""
    bar = "#" * round(20 * fraction)
    line = f"[{bar:<20}] {round(100 * fraction):3} % {what[:60]:<60}"
    sys.stderr.write(f"\r{line}" if fraction < 1 else f"\r{'':{len(line)}}\r")
    sys.stderr.flush()
