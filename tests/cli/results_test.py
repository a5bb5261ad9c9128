"""graphs/results: pages are what their parts make of them, and a sweep's tables join them."""
import json
import os
import re
import shutil
import subprocess
from pathlib import Path

from kestrel_cli import KESTREL, SOURCE, done, folder, need_part, run_tests

RESULTS = SOURCE / "graphs" / "results"


def generate(place, *arguments, status=0):
    run = subprocess.run([place / "generate.sh", *map(str, arguments)], capture_output=True, text=True,
                         env={**os.environ, "KESTREL": KESTREL})
    assert run.returncode == status, run.stdout + run.stderr
    return run


def tables(file):
    """What `kestrel sweep --markdown` says of results, as a page of its own."""
    return re.sub("^##(#*) ", r"#\1 ", done("sweep", "--markdown", file).out, flags=re.M)


def test_the_pages_are_made_of_their_parts():
    generate(RESULTS, "--check")
    page = (RESULTS / "README.md").read_text()
    assert "No GPU has been seen" in page and "easured by hand" in page
    for file in RESULTS.glob("*.json"):
        data = json.loads(file.read_text())
        assert data["missing"] == [] and all(row["ms"] for row in data["rows"]), file
        assert file.with_suffix(".md").read_text() == tables(file)
        assert f"]({file.stem}.md) | 20" in page


def test_a_sweep_joins_the_page():
    need_part("embree")
    with folder() as here:
        here = Path(here)
        shutil.copytree(RESULTS, here / "results")
        sweep = {"kestrel_sweep": 1, "title": "Two tracers | side by side", "size": [32, 18], "frames": 1, "repeats": 1,
                 "scenes": ["builtin:cornell"],
                 "reference": {"graph": "reference_ao.json", "output": "reference.visibility", "set": ["reference.samples=4"]},
                 "variants": [{"name": name, "graph": "ray_ao.json", "output": "mean.result", "set": [f"ao.tracer={name}.tracer"]}
                              for name in ["roma", "bvh"]]}
        (here / "tracers.json").write_text(json.dumps(sweep))
        done("sweep", here / "tracers.json", "--out", here / "out")
        generate(here / "results", here / "out")
        page = (here / "results" / "README.md").read_text()
        own = (here / "results" / "tracers.md").read_text()
        assert "[Two tracers \\| side by side](tracers.md)" in page and own.startswith("# Two tracers \\| side by side\n")
        assert own == tables(here / "out" / "results.json")
        kept = (here / "results" / "tracers.json").read_text()
        assert "times_command" not in kept and len(json.loads(kept)["rows"]) == 2
        generate(here / "results", "--check")
        (here / "results" / "README.md").write_text(page.replace("Results", "Other"))
        generate(here / "results", "--check", status=1)
        generate(here / "results")
        (here / "results" / "tracers.json").unlink()
        assert "tracers.md is of no sweep" in generate(here / "results", "--check", status=1).stdout
        generate(here / "results")
        assert not (here / "results" / "tracers.md").exists()


if __name__ == "__main__":
    run_tests(globals())
