"""tests/benchmark/against.py: ratios within rounds, pictures, spin tests, from folders as sweeps leave them."""
import json
import subprocess
import sys
from pathlib import Path

from kestrel_cli import KESTREL, SOURCE, folder, run_tests

AGAINST = [sys.executable, str(SOURCE / "tests" / "benchmark" / "against.py")]


def against(*arguments):
    return subprocess.run([*AGAINST, *map(str, arguments)], capture_output=True, text=True, check=True).stdout


def measured(out, name, repetition, tracing, flip=0.25, picture=b"same", failed=""):
    """What a sweep leaves of one point: its picture, and one repetition by the name that a revision gives it."""
    point = out / "parts" / "blob" / "bvh"
    point.mkdir(parents=True, exist_ok=True)
    (out / "blob.png").write_bytes(picture)
    errors = {"mse": flip * flip, "psnr": None, "ssim": 1, "flip": flip}
    (point / "picture.json").write_text(json.dumps({"failed": failed, "picture": "blob.png", "errors": errors}))
    steps = [["bvh", "build", "generation", 2.0], ["ao", "trace", "tracing", tracing]]
    (point / name).write_text(json.dumps({"round": 0, "machine": "m", "spin": [20 + repetition, 21],
                                          "frames": [{"ms": 99, "steps": steps}]}))


def test_ratios_are_taken_within_rounds():
    with folder() as here:
        here = Path(here)
        # The machine is ten times as slow in the second round.
        for round_, speed in [(1, 1), (2, 10), (3, 1), (4, 1)]:
            for side, name, tracing in [("old", "turn-0.json", 6.0), ("new", "repetition-0.json", 3.0)]:
                measured(here / side / "out", name, round_, tracing * speed)
                against("aside", here / side / "out", here / side / "rounds" / str(round_))
                assert [f.name for f in (here / side / "out/parts/blob/bvh").iterdir()] == ["picture.json"]
        lines = against("table", here / "old", here / "new", "abc123", KESTREL).splitlines()
        tracing = next(line.split() for line in lines if " tracing " in line)
        assert tracing == ["tracing", "6.00", "3.00", "0.500", "(0.500", "to", "0.500)"], lines
        total = next(line.split() for line in lines if "blob: bvh" in line)
        assert total[2:6] == ["total", "8.00", "5.00", "0.625"], lines
        assert any(line.split() == ["picture", "equal"] for line in lines), lines
        assert any("spin test, abc123: one thread 22.5 (21.0 to 24.0) ms" in line for line in lines), lines


def test_what_differs_is_said():
    for changes, told in [({"flip": 0.26}, "equal in 8 bits; FLIP against the reference 0.250000 and 0.260000"),
                          ({"failed": "no such port"}, "new failed: no such port")]:
        with folder() as here:
            here = Path(here)
            for side, more in [("old", {}), ("new", changes)]:
                measured(here / side / "out", "repetition-0.json", 1, 1.0, **more)
                against("aside", here / side / "out", here / side / "rounds" / "1")
            out = against("table", here / "old", here / "new", "abc123", KESTREL)
            assert told in out, out


def test_a_sweep_is_repeated_by_rounds():
    with folder() as here:
        file = Path(here) / "s.json"
        file.write_text('{"kestrel_sweep": 1, "repeats": 9}')
        assert against("once", file) == "9\n" and json.loads(file.read_text())["repeats"] == 1


if __name__ == "__main__":
    run_tests(globals())
