"""kestrel sweep: a tiny sweep, stopped and resumed, sharded and joined, and its page in a browser."""
import csv
import html
import json
import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

from kestrel_cli import KESTREL, done, files_in, folder, kestrel, refused, run_tests

TINY = {
    "kestrel_sweep": 1,
    "title": "A tiny sweep",
    "size": [64, 36],
    "frames": 2,
    "repeats": 2,
    "rebuild": True,
    "times": {"method": ["generation", "tracing"], "without map": ["generation", "tracing", "-bom"]},
    "plot": {"time": "method", "error": "flip"},
    "scenes": ["builtin:blob?detail=0.05",
               {"name": "tower", "source": "builtin:tower?detail=0.05", "camera": "outside"}],
    "reference": {"graph": "reference_ao.json", "output": "reference.visibility", "mask": "gbuffer.coverage",
                  "set": ["reference.samples=64"]},
    "rays": {"graph": "sweeps/graphs/rays.json", "rays": "rays.rays", "hits": "embree.hits"},
    "variants": [
        {"name": "ROMA", "graph": "ray_ao.json", "output": "mean.result",
         "axes": {"bom.resolution": [32, 64], "roma.angular": [2, 4]},
         "exclude": [{"bom.resolution": 64, "roma.angular": 2}], "series": "ROMA {roma.angular}"},
        {"name": "BVH", "graph": "ray_ao.json", "output": "mean.result", "set": ["ao.tracer=bvh.tracer"]},
        {"name": "rays by ROMA", "graph": "sweeps/graphs/rays.json", "hits": "query.hits", "plot": "rays"},
        {"name": "rays by Embree", "graph": "sweeps/graphs/rays.json", "hits": "embree.hits", "plot": "rays"},
    ],
}
ROWS = 12
NO_EMBREE = "embree" not in kestrel("--version").out


def tiny(here, **changes):
    file = Path(here) / "tiny.json"
    file.write_text(json.dumps({**TINY, **changes}))
    return file


def results(path):
    return json.loads((Path(path) / "results.json").read_text())


def without_times(data):
    """Everything that must be the same however the sweep was run."""
    data = json.loads(json.dumps(data))
    for row in data["rows"]:
        for key in ["ms", "ms_q1", "ms_q3"]:
            row[key] = sorted(row[key])
        row["steps"] = [step["step"] for step in row["steps"]]
        for key in ["compile_ms", "set_up_ms", "pareto", "times_command"]:
            del row[key]
        if row.get("rays"):
            del row["rays"]["tracing_ns"]
    for machine in data["machines"]:
        del machine["spin"]
    return data


def test_measures_everything_it_names():
    if NO_EMBREE:
        return
    with folder() as here:
        out = done("sweep", tiny(here), "--out", f"{here}/out").out
        assert "index.html" in out
        data = results(f"{here}/out")
        assert len(data["rows"]) == ROWS and data["missing"] == []
        for row in data["rows"]:
            assert row["failed"] is None and row["repeat_count"] == 2 and row["memory"] > 0 and row["left_out_count"] > 0
            assert row["ms"]["generation"] > 0 and row["ms"]["tracing"] > 0
            assert row["ms_q1"]["total"] <= row["ms"]["total"] <= row["ms_q3"]["total"] <= row["ms_q3"]["frame"]
        by = {(row["scene"], row["variant"]): row for row in data["rows"]}
        picture = by["tower", "ROMA, resolution 64, angular 4"]
        assert 0 < picture["flip"] < 1 and 0 < picture["mse"] < 1 and 0 < picture["reference_noise"] < 0.1
        assert picture["axes"] == {"bom.resolution": "64", "roma.angular": "4"} and picture["series"] == "ROMA 4"
        assert picture["ms"]["without map"] < picture["ms"]["method"]
        assert by["tower", "BVH"]["flip"] < picture["flip"], "exact rays lie nearer to the truth"
        assert by["tower", "BVH"]["ms"]["without map"] == by["tower", "BVH"]["ms"]["method"]
        embree = by["tower", "rays by Embree"]
        assert embree["rays"]["agreement"] == 1 and embree["rays"]["count"] > 100
        assert {step["step"] for step in embree["steps"]} >= {"embree.build", "embree.trace"}
        assert 0.5 < by["tower", "rays by ROMA"]["rays"]["agreement"] < 1
        names = files_in(f"{here}/out")
        for row in data["rows"]:
            for key in ["picture", "heat_map"]:
                assert row["kind"] == "rays" or row[key] in names
        with open(f"{here}/out/results.csv", newline="") as stream:
            table = list(csv.DictReader(stream))
        assert len(table) == ROWS
        assert abs(float(table[0]["flip"]) - data["rows"][0]["flip"]) < 1e-6


def test_its_commands_make_its_pictures_again():
    if NO_EMBREE:
        return
    with folder() as here:
        done("sweep", tiny(here), "--out", f"{here}/out", "--only", "ROMA", folder=here)
        row = results(f"{here}/out")["rows"][2]
        words = subprocess.run(["bash", "-c", f"printf '%s\\n' {row['command']}"], capture_output=True, text=True,
                               check=True).stdout.splitlines()
        assert words[:2] == ["kestrel", "render"]
        words = [word.replace(".exr", ".png") for word in words]
        done(*words[1:], folder=here)
        again = Path(here) / words[-1].split("=")[-1]
        assert again.read_bytes() == (Path(here) / "out" / row["picture"]).read_bytes()


def test_goes_on_after_it_was_killed():
    if NO_EMBREE:
        return
    with folder() as here:
        file = tiny(here)
        done("sweep", file, "--out", f"{here}/whole")
        out = Path(here) / "stopped"
        run = subprocess.Popen([KESTREL, "sweep", str(file), "--out", str(out)], stdout=subprocess.DEVNULL)
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and run.poll() is None and len(list(out.glob("parts/*/*/repetition-*.json"))) < 3:
            time.sleep(0.01)
        run.send_signal(signal.SIGKILL)
        run.wait()
        kept = {part: part.read_bytes() for part in out.glob("parts/*/*/*.json")}
        assert kept, "it was killed before it had measured anything"
        assert not (out / "results.json").exists() or len(kept) == 3 * ROWS
        assert any("--resume" in line for line in refused("sweep", file, "--out", out))
        done("sweep", file, "--out", out, "--resume")
        for part, text in kept.items():
            assert part.read_bytes() == text, f"{part} was measured twice"
        assert without_times(results(out)) == without_times(results(f"{here}/whole"))


def test_refuses_to_resume_a_changed_sweep():
    if NO_EMBREE:
        return
    with folder() as here:
        done("sweep", tiny(here), "--out", f"{here}/out", "--only", "BVH")
        lines = refused("sweep", tiny(here, frames=3), "--out", f"{here}/out", "--resume")
        assert any("another form of tiny.json" in line for line in lines), lines
        refused("sweep", tiny(here), "--out", f"{here}/out", "--resume", "--size", "32x32")


def test_one_variant_first_and_the_rest_later():
    if NO_EMBREE:
        return
    with folder() as here:
        file = tiny(here)
        done("sweep", file, "--out", f"{here}/out", "--only", "BVH")
        first = results(f"{here}/out")
        assert [row["variant"] for row in first["rows"]] == ["BVH", "BVH"] and len(first["missing"]) == ROWS - 2
        done("sweep", file, "--out", f"{here}/out", "--resume")
        second = results(f"{here}/out")
        assert len(second["rows"]) == ROWS
        assert [r["ms"] for r in second["rows"] if r["variant"] == "BVH"] == [r["ms"] for r in first["rows"]]


def test_shards_join_to_the_whole():
    if NO_EMBREE:
        return
    with folder() as here:
        file = tiny(here)
        done("sweep", file, "--out", f"{here}/whole")
        for i in [1, 2, 3]:
            done("sweep", file, "--out", f"{here}/{i}", "--shard", f"{i}/3")
        assert sum(len(results(f"{here}/{i}")["rows"]) for i in [1, 2, 3]) == ROWS
        done("sweep", file, "--out", f"{here}/joined", "--merge", f"{here}/1", f"{here}/2", f"{here}/3")
        assert without_times(results(f"{here}/joined")) == without_times(results(f"{here}/whole"))
        drawn = [name for name in files_in(f"{here}/whole") if name.startswith("pictures/")]
        assert len(drawn) > 8
        for name in drawn:
            assert (Path(here) / "joined" / name).read_bytes() == (Path(here) / "whole" / name).read_bytes(), name
        assert "holds too" in refused("sweep", file, "--out", f"{here}/twice", "--merge", f"{here}/1", f"{here}/1")[0]


def test_a_variant_that_fails_is_noted_and_the_others_go_on():
    if NO_EMBREE:
        return
    with folder() as here:
        variants = [TINY["variants"][1], {"name": "other rays", "graph": "sweeps/graphs/rays.json", "hits": "query.hits",
                                          "set": ["rays.distance=0.5"], "plot": "rays"}]
        run = kestrel("sweep", tiny(here, variants=variants, scenes=TINY["scenes"][:1]), "--out", f"{here}/out")
        assert run.status == 1 and "traces other rays than the reference" in run.err, run.err
        rows = {row["variant"]: row for row in results(f"{here}/out")["rows"]}
        assert rows["BVH"]["failed"] is None and "other rays" in rows["other rays"]["failed"]


def test_tells_all_mistakes_before_it_measures():
    with folder() as here:
        variants = [{**TINY["variants"][0], "axes": {"bom.resolution": [32, 16], "roma.angulra": [4]}, "exclude": [],
                     "series": "x", "set": ["ao.tracer=bvh.trace"]},
                    {"name": "no", "graph": "ray_oa.json", "output": "mean.result"}]
        lines = refused("sweep", tiny(here, variants=variants), "--out", f"{here}/out")
        text = "\n".join(lines)
        assert "did you mean 'angular'" in text and "16" in text and "did you mean 'tracer'" in text, text
        assert "did you mean 'ray_ao.json'" in text and all("tiny.json:1:" in line for line in lines), text
        assert not (Path(here) / "out").exists()
        assert "I/N" in refused("sweep", tiny(here), "--shard", "3/2", "--list")[0]
        assert "did you mean 'ROMA'" in refused("sweep", tiny(here), "--only", "ROMO", "--list")[0]
        assert "--out" in refused("sweep", tiny(here))[0]


def test_lists_what_it_would_measure():
    with folder() as here:
        file = tiny(here)
        assert "12 measurements in 4 of 4 plots" in done("sweep", file, "--list").out
        whole = done("sweep", file, "--list", "--json").json()
        parts = [done("sweep", file, "--list", "--json", "--shard", f"{i}/2").json() for i in [1, 2]]
        assert len(whole) == ROWS and sum(map(len, parts)) == ROWS
        assert files_in(here) == ["tiny.json"]


def test_shipped_sweeps_are_whole():
    folder_ = Path(os.environ["KESTREL_SOURCE"]) / "graphs" / "sweeps"
    sweeps = [sweep for sweep in sorted(folder_.glob("*.json")) if sweep.stem != "schema"]
    names = [sweep.stem for sweep in sweeps]
    for name in ["ambient_occlusion", "antialiasing", "denoising", "glossy", "indirect", "large_scene", "refresh",
                 "roma_table2", "snap", "soft_shadow", "subdivision"]:
        assert name in names, name
    if NO_EMBREE:
        return
    for sweep in sweeps:
        assert len(done("sweep", sweep, "--list", "--json").json()) > 3, sweep


def browser():
    for name in ["chromium", "chromium-browser", "google-chrome"]:
        if shutil.which(name):
            return name
    return None


def test_the_page_works_in_a_browser():
    if NO_EMBREE or not browser():
        print("skipped: there is no chromium" if not browser() else "skipped: no Embree in this build")
        return
    with folder() as here:
        done("sweep", tiny(here), "--out", f"{here}/out")
        page = subprocess.run(
            [browser(), "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
             f"--user-data-dir={here}/profile", "--enable-logging=stderr", "--virtual-time-budget=5000", "--dump-dom",
             f"file://{here}/out/index.html?selftest"], capture_output=True, text=True, timeout=100)
        told = [line for line in page.stderr.splitlines() if "CONSOLE" in line]
        assert not told, told
        found = re.search(r'data-selftest="([^"]*)"', page.stdout)
        assert found, "the page did not come to its end: " + page.stderr[-1000:]
        found = json.loads(html.unescape(found.group(1)))
        assert found["errors"] == [] and found["unsorted"] == [] and found["sorted"] >= 20, found
        assert found["points"] == ROWS and found["rows"] == ROWS and found["front"] is True, found
        assert found["pictures"] == 2 + 2 * 8, found
        # What the browser has drawn, not what the page says of itself.
        assert len(re.findall(r'class="point[ "]', page.stdout)) == ROWS
        assert len(re.findall(r'<path class="front"', page.stdout)) == 4
        rows = results(f"{here}/out")["rows"]
        order = [int(i) for i in re.findall(r'<tr [^>]*data-row="(\d+)"', page.stdout)]
        assert order == list(range(len(rows)))


if __name__ == "__main__":
    run_tests(globals())
