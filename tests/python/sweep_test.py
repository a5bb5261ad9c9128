"""Sweeps from Python as rows; the examples; an installed package."""
import csv
import json
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import kestrel
from kestrel_cli import KESTREL, SOURCE, Skipped, done, folder, need, run_tests
from python_support import need_numpy, refused

TINY = {"kestrel_sweep": 1, "title": "Tiny", "size": [32, 18], "frames": 1, "repeats": 2, "scenes": ["builtin:blob?detail=0.05"],
        "reference": {"graph": "ray_ao.json", "output": "mean.result", "set": ["ao.tracer=bvh.tracer", "ao.rays=8"]},
        "variants": [{"name": "ROMA", "graph": "ray_ao.json", "output": "mean.result", "axes": {"bom.resolution": [32, 64]}},
                     {"name": "BVH", "graph": "ray_ao.json", "output": "mean.result", "set": ["ao.tracer=bvh.tracer"]}]}


def written(here):
    file = Path(here) / "tiny.json"
    file.write_text(json.dumps(TINY))
    return file


def test_rows_are_those_of_the_table_with_numbers_as_numbers():
    with folder() as here:
        told = []
        rows = kestrel.sweep(written(here), f"{here}/out", progress=lambda fraction, what: told.append(fraction))
        with open(f"{here}/out/results.csv", newline="") as lines:
            table = list(csv.DictReader(lines))
        assert len(rows) == len(table) == 3 and [list(row) for row in rows] == [list(row) for row in table]
        for row, text in zip(rows, table):
            for name, value in row.items():
                same = (value is None and text[name] == "") or str(value) == text[name]
                if isinstance(value, bool):
                    same = text[name] == ("yes" if value else "no")
                elif isinstance(value, float):
                    same = float(text[name]) == value
                assert same, (name, value, text[name])
            assert isinstance(row["flip"], (int, float)) and row["ms total"] > 0 and row["repeat_count"] == 2
        assert [row["axis bom.resolution"] for row in rows] == [32, 64, None] and rows[0]["psnr"] > 0
        assert told == sorted(told) and told[0] == 0 and told[-1] <= 1 and len(told) > 5
        assert kestrel.read_rows(f"{here}/out") == rows == kestrel.read_rows(f"{here}/out/results.csv")
        again = done("sweep", f"{here}/tiny.json", "--out", f"{here}/out", "--resume", "--json").json()
        assert again["rows"][0]["flip"] == rows[0]["flip"]
        assert "resume" in str(refused(lambda: kestrel.sweep(f"{here}/tiny.json", f"{here}/out")))


def test_pandas_reads_the_file_as_the_rows():
    try:
        import pandas
    except ImportError:
        raise Skipped("there is no pandas") from None
    with folder() as here:
        rows = pandas.DataFrame(kestrel.sweep(written(here), f"{here}/out"))
        # pandas' own way to read a number may miss its last bit.
        table = pandas.read_csv(f"{here}/out/results.csv", true_values=["yes"], false_values=["no"], float_precision="round_trip")
        assert list(table.columns) == list(rows.columns) and len(table) == 3
        assert table["machine"].str.match("[a-z]").all() and table["pareto"].dtype == bool and table["flip"].dtype == float
        for name in table.columns:
            read, made = table[name], rows[name].where(rows[name] != "")
            assert read.isna().equals(made.isna()) and list(read.dropna()) == list(made.dropna()), name
        assert table.groupby("variant")["ms total"].median().gt(0).all()


def test_a_sweep_is_stopped_and_goes_on():
    with folder() as here:
        file = written(here)

        def enough(fraction, what):
            if fraction > 0.3:
                raise KeyboardInterrupt

        refused(lambda: kestrel.sweep(file, f"{here}/out", progress=enough), KeyboardInterrupt)
        held = len(list(Path(f"{here}/out").rglob("*.json")))
        rows = kestrel.sweep(file, f"{here}/out", resume=True)
        assert held > 2 and len(rows) == 3 and not any(row["failed"] for row in rows)
        only = kestrel.sweep(file, only="BVH", size=(16, 9))
        assert [row["variant"] for row in only if row["repeat_count"]] == ["BVH"]


def test_an_interrupt_ends_a_sweep_between_two_measurements():
    with folder() as here:
        file = written(here)
        file.write_text(json.dumps({**TINY, "repeats": 10_000}))
        timer = threading.Timer(1, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        refused(lambda: kestrel.sweep(file, f"{here}/out"), KeyboardInterrupt)
        file.write_text(json.dumps(TINY))
        assert len(kestrel.sweep(file, f"{here}/other")) == 3


def test_mistakes_of_a_sweep_come_at_once():
    with folder() as here:
        file = written(here)
        file.write_text(json.dumps({**TINY, "framse": 3, "repeats": 0}))
        told = refused(lambda: kestrel.sweep(file))
        assert len(told.problems) == 2 and all(problem.file.endswith("tiny.json") and problem.line for problem in told.problems)


def test_an_installed_package_is_found_and_finds_the_rest():
    need_numpy()
    build = Path(KESTREL).parent.parent
    with folder() as here:
        for part in ["framework", "passes", "apps/python"]:
            subprocess.run(["cmake", f"-DCMAKE_INSTALL_PREFIX={here}", "-P", build / part / "cmake_install.cmake"], check=True,
                           capture_output=True, timeout=60)
        place, = Path(here).glob("lib/python*/dist-packages")
        script = "import kestrel; print(kestrel.__file__); print(kestrel.render('ray_ao.json', size=(64, 36))['mean.result'].shape)"
        run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, cwd=here,
                             env={**os.environ, "PYTHONPATH": str(place)})
        assert (run.stdout, run.stderr) == (f"{place}/kestrel/__init__.py\n(36, 64)\n", "")
        assert (place / "kestrel" / "passes.pyi").exists()


def need_matplotlib():
    try:
        import matplotlib
    except ImportError:
        raise Skipped("there is no matplotlib") from None


def example(name, here, size=("64", "36")):
    need_numpy()
    run = subprocess.run([sys.executable, str(SOURCE / "apps" / "python" / "examples" / name), *size], cwd=here,
                         capture_output=True, text=True, timeout=110, env={**os.environ, "MPLCONFIGDIR": str(here)})
    assert run.returncode == 0, run.stderr
    return run.stdout


def test_example_first_picture():
    with folder() as here:
        said = example("first_picture.py", here)
        assert "left out: roma, because" in said
        assert 0.001 < kestrel.compare(kestrel.read_image(f"{here}/roma.png"), kestrel.read_image(f"{here}/bvh.png"))["mse"] < 0.1


def test_example_compare_tracers():
    need("embree" in kestrel.parts, "this build has no embree")
    with folder() as here:
        rows = {line.split()[0]: float(line.split()[1]) for line in example("compare_tracers.py", here).splitlines()[1:]}
        assert list(rows) == ["roma", "field", "bvh"] and rows["bvh"] < min(rows["roma"], rows["field"]) < 0.5
        assert kestrel.read_image(f"{here}/roma.flip.png").shape == (36, 64, 3)


def test_example_build_graph():
    with folder() as here:
        said = example("build_graph.py", here)
        assert said.count("not yet: ") >= 2 and "normal" in said and "% of its sky is open" in said
        assert kestrel.load(f"{here}/bvh_ao.json").ao.rays == 4


def test_example_convergence():
    need("embree" in kestrel.parts, "this build has no embree")
    with folder() as here:
        for line in example("convergence.py", here).splitlines():
            errors = [float(part.split()[-1]) for part in line.split(":")[1].split(",")]
            assert len(errors) == 5 and errors[-1] < 0.8 * errors[0], line


def test_example_error_over_time():
    need("embree" in kestrel.parts, "this build has no embree")
    need_matplotlib()
    with folder() as here:
        example("error_over_time.py", here, ("32", "18"))
        picture = kestrel.read_image(f"{here}/error_over_time.png")
        assert picture.shape[:2] == (480, 640) and 0.5 < picture.mean() < 1
        assert len(kestrel.read_rows(f"{here}/results")) == 5


def test_the_readmes_first_ten_minutes():
    """As they stand there, but for the size."""
    need_numpy()
    need("embree" in kestrel.parts, "this build has no embree")
    need_matplotlib()
    section = (SOURCE / "README.md").read_text().split("## From Python\n")[1].split("\n## ")[0]
    lines = [line[4:] for line in section.splitlines() if line.startswith("    ")]
    assert 10 < len(lines) <= 15
    script = "\n".join(lines).replace("(320, 180)", "(64, 36)")
    with folder() as here:
        run = subprocess.run([sys.executable, "-W", "error", "-W", "ignore:.*show the figure", "-c", script], cwd=here, timeout=110,
                             capture_output=True, text=True, env={**os.environ, "MPLCONFIGDIR": here, "MPLBACKEND": "Agg"})
        assert run.returncode == 0, run.stderr
        assert "'what': 'bvh'" in run.stdout and "angular" in run.stdout and "2 to 16" in run.stdout


def test_every_example_has_its_test():
    names = {file.stem for file in (SOURCE / "apps" / "python" / "examples").glob("*.py")}
    assert names == {name[13:] for name in globals() if name.startswith("test_example_")}


if __name__ == "__main__":
    run_tests(globals())
