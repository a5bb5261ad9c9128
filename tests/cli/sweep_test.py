"""kestrel sweep: a tiny sweep, stopped and resumed, sharded and joined, and its page in a browser."""
import csv
import html
import json
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

from kestrel_cli import KESTREL, SOURCE, done, files_in, folder, kestrel, need, need_part, refused, run_tests

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
        reports = row.get("reports") or {}
        for name in [name for name in reports if name.endswith(", ms")]:
            del reports[name]
    for machine in data["machines"]:
        del machine["spin"], machine["date"]
    return data


def test_measures_everything_it_names():
    need_part("embree")
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
        assert all(re.fullmatch("m[0-9a-f]{6}", line["machine"]) for line in table), "a machine is no number"
        tables = (Path(here) / "out" / "results.md").read_text()
        assert tables == done("sweep", "--markdown", f"{here}/out/results.json").out
        assert f"    kestrel sweep {here}/tiny.json --out results\n" in tables and "### tower: rays\n" in tables
        assert len([line for line in tables.splitlines() if line.startswith("| ")]) == ROWS + 4
        assert "no results.json" in refused("sweep", "--markdown", here + "/tiny.json")[0]
        assert abs(float(table[0]["flip"]) - data["rows"][0]["flip"]) < 1e-6


def test_an_empty_mask_is_told_and_stops_nothing():
    """A scene on which no pixel counts has times without errors; the other scene is as ever."""
    settings = ["first_ao_pass.guard=0", "depth_map.guard=0", "first_ao_pass.cutoff=1"]
    reference = {"graph": "svao.json", "output": "ray_svao.result", "mask": "first_ao_pass.mask", "set": settings}
    variants = [{"name": "map", "graph": "svao.json", "output": "second_ao_pass.result", "set": settings}]
    scenes = [{"name": "blank", "source": "builtin:tower?detail=0.05", "camera": {"eye": [400, 400, 400], "target": [0, 5, 0], "fov": 50}},
              {"name": "seen", "source": "builtin:tower?detail=0.05", "camera": "outside"}]
    with folder() as here:
        file = tiny(here, reference=reference, variants=variants, scenes=scenes, rays=None, times={}, size=[128, 72])
        text = json.loads(file.read_text())
        del text["rays"], text["plot"]
        file.write_text(json.dumps(text))
        told = kestrel("sweep", file, "--out", f"{here}/out")
        assert told.status == 0 and "blank: the mask first_ao_pass.mask is 0 everywhere: no pixel counts" in told.err
        data = results(f"{here}/out")
        assert data["missing"] == [] and [scene.get("nothing_counts", False) for scene in data["scenes"]] == [True, False]
        blank, seen = data["rows"]
        assert blank["failed"] is None and blank["mse"] is None and blank["flip"] is None and blank["ms"]["total"] > 0
        assert seen["mse"] > 0 and seen["flip"] > 0
        assert blank["picture"] in files_in(f"{here}/out") and blank["heat_map"] == ""
        tables = (Path(here) / "out" / "results.md").read_text()
        assert tables.count("No pixel counts here, since the mask is 0 everywhere") == 1
        done("sweep", file, "--out", f"{here}/out", "--resume")
        assert without_times(results(f"{here}/out")) == without_times(data)


def test_takes_the_error_of_a_proxy_apart():
    need_part("embree")
    exact = ["ao.tracer=dda.tracer", "dda.method=dda_3d"]
    variants = [{"name": "field", "graph": "sweeps/graphs/ao.json", "output": "mean.result", "exact": exact,
                 "set": ["ao.tracer=field.tracer"]},
                {"name": "grid walk", "graph": "sweeps/graphs/ao.json", "output": "mean.result", "exact": exact, "set": exact}]
    with folder() as here:
        file = tiny(here, variants=variants, frames=8, repeats=1)
        done("sweep", file, "--out", f"{here}/out")
        for row in results(f"{here}/out")["rows"]:
            split = row["split"]
            assert abs(split["sum"] - split["mse"]) < 0.05 * split["mse"], split
            # The reference's noise as its own halves tell it, and as two seeds do.
            assert 0.5 < split["reference_noise"] / row["reference_noise"] ** 2 < 2, (split, row["reference_noise"])
            assert split["representation"] > 0 and split["sampling"] > 0
            if row["variant"] == "grid walk":
                assert split["algorithm"] == 0 and split["cross"] == 0, "it is the exact tracing itself"
            else:
                assert abs(row["mse"] - split["mse"]) < 0.1 * row["mse"]
                assert split["algorithm"] > 0.002 or row["scene"] != "tower", "spheres about centres are no cells"
        with open(f"{here}/out/results.csv", newline="") as stream:
            assert all(float(line["split representation"]) > 0 for line in csv.DictReader(stream))
        assert "MSE of the representation" in (Path(here) / "out" / "results.md").read_text()
        wrong = [{**variants[0], "exact": ["ao.tracer=ddda.tracer"]}]
        assert any("ddda" in line for line in refused("sweep", tiny(here, variants=wrong), "--list"))


def test_its_commands_make_its_pictures_again_from_anywhere():
    need_part("embree")
    with folder() as here, folder() as reader:
        study = Path(here) / "study"
        study.mkdir()
        tiny(study)
        done("sweep", "tiny.json", "--out", "../out", "--only", "ROMA", folder=study)
        row = results(f"{here}/out")["rows"][2]
        with open(f"{here}/out/results.csv", newline="") as stream:
            assert [line["command"] for line in csv.DictReader(stream)][2] == row["command"]
        words = words_of(row["command"])
        assert words[:2] == ["kestrel", "render"]
        words = [word.replace(".exr", ".png") for word in words]
        done(*words[1:], folder=reader)
        again = Path(reader) / words[-1].split("=")[-1]
        assert again.read_bytes() == (Path(here) / "out" / row["picture"]).read_bytes()
        done(*words_of(row["times_command"])[1:], "--list", folder=reader)


def test_a_scene_of_a_sweep_gains_a_camera_and_lights_and_its_commands_say_so():
    need_part("embree")
    with folder() as here, folder() as reader:
        study = Path(here) / "study"
        study.mkdir()
        (study / "orbit.json").write_text(json.dumps({"kestrel_camera": 1, "target": [0, 1, 0], "fov": 50,
                                                      "keys": [{"time": 0, "eye": [4, 2, 0]}, {"time": 2, "eye": [0, 2, 4]}]}))
        blob = "builtin:blob?detail=0.05"
        scenes = [{"name": "orbit", "source": blob, "camera": {"path": "orbit.json"}, "time": 1, "fps": 30,
                   "lights": [{"kind": "directional", "direction": [0, -1, 0]}]},
                  {"name": "above", "source": blob, "camera": {"eye": [0, 6, 0], "target": [0, 0, 0]}}]
        file = tiny(study, scenes=scenes, variants=[TINY["variants"][1]], rays=TINY["rays"])
        done("sweep", file, "--out", f"{here}/out")
        rows = results(f"{here}/out")["rows"]
        assert [row["scene"] for row in rows] == ["orbit", "above"]
        pictures = [(Path(here) / "out" / row["picture"]).read_bytes() for row in rows]
        assert pictures[0] != pictures[1]
        for row, picture in zip(rows, pictures):
            words = [word.replace(".exr", ".png") for word in words_of(row["command"])]
            done(*words[1:], folder=reader)
            assert (Path(reader) / words[-1].split("=")[-1]).read_bytes() == picture, row["command"]
        scenes[1]["camera"]["fov"] = 30
        (study / "orbit.json").write_text((study / "orbit.json").read_text().replace("50", "51"))
        lines = refused("sweep", tiny(study, scenes=scenes, variants=[TINY["variants"][1]]), "--out", f"{here}/out", "--resume")
        assert any("'camera' of the scene 'above'" in line for line in lines), lines
        assert any("'path' of the scene 'orbit'" in line for line in lines), lines


def words_of(command):
    """As a shell splits it."""
    return subprocess.run(["bash", "-c", f"printf '%s\\n' {command}"], capture_output=True, text=True,
                          check=True).stdout.splitlines()


def test_goes_on_after_it_was_killed():
    need_part("embree")
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


def test_refuses_to_resume_what_was_measured_otherwise_with_every_cause():
    need_part("embree")
    with folder() as here:
        graph = Path(here) / "own.json"
        graph.write_text((SOURCE / "graphs" / "ray_ao.json").read_text())
        variants = [{**TINY["variants"][1], "graph": "own.json"}]
        done("sweep", tiny(here, variants=variants), "--out", f"{here}/out")
        graph.write_text(graph.read_text() + "\n")
        changed = tiny(here, frames=3, seed=5, scenes=["builtin:blob?detail=0.05", {**TINY["scenes"][1], "camera": ""}],
                       variants=[{**variants[0], "set": ["ao.tracer=bvh.tracer", "ao.rays=2"]}])
        text = "\n".join(refused("sweep", changed, "--out", f"{here}/out", "--resume", "--size", "32x32"))
        for cause in ["'size' was '64x36' and is '32x32'", "'frames' was 2 and is 3", "'seed' was 0 and is 5",
                      "the text of the graph 'own.json' has changed", "'camera' of the scene 'tower' was 'outside' and is ''",
                      "'set' of the variant 'BVH'", "cannot be kept for tiny.json"]:
            assert cause in text, cause + ": " + text
        assert text.count("own.json") == 1, text


def test_what_a_sweep_gains_joins_what_is_measured():
    need_part("embree")
    with folder() as here:
        bvh = TINY["variants"][1]
        done("sweep", tiny(here, variants=[bvh], scenes=TINY["scenes"][:1], repeats=1), "--out", f"{here}/out")
        kept = {part: part.read_bytes() for part in Path(here).glob("out/parts/*/*/*.json")}
        assert len(kept) == 2
        more = {**bvh, "name": "more rays", "axes": {"ao.rays": [1, 2]}}
        file = tiny(here, variants=[more, bvh], repeats=2, title="Another title")
        done("sweep", file, "--out", f"{here}/out", "--resume")
        data = results(f"{here}/out")
        assert len(data["rows"]) == 6 and data["missing"] == [] and data["title"] == "Another title"
        assert all(row["repeat_count"] == 2 for row in data["rows"])
        for part, text in kept.items():
            assert part.read_bytes() == text, f"{part} was measured twice"
        done("sweep", tiny(here, variants=[bvh], repeats=2), "--out", f"{here}/out", "--resume")
        assert len(results(f"{here}/out")["rows"]) == 2, "what the sweep no longer has is kept, and not shown"


def test_names_graphs_and_scenes_wherever_they_lie():
    need_part("embree")
    with folder() as here, folder() as elsewhere:
        here, elsewhere = Path(here), Path(elsewhere)
        for name in ["study", "data", "again"]:
            (here / name).mkdir()
        done("scene", "export", "builtin:lattice?detail=0.02", here / "data" / "still.glb")
        (elsewhere / "far.json").write_text((SOURCE / "graphs" / "ray_ao.json").read_text())
        (here / "study" / "link.json").symlink_to(elsewhere / "far.json")
        bvh = {"output": "mean.result", "set": ["ao.tracer=bvh.tracer"]}
        names = {"absolute": elsewhere / "far.json", "above": "../data/near.json", "link": "link.json", "shipped": "ray_ao.json"}
        (here / "data" / "near.json").write_text((elsewhere / "far.json").read_text())
        file = tiny(here / "study", repeats=1, scenes=["../data/still.glb", {"name": "far", "source": str(here / "data/still.glb")}],
                    variants=[{**bvh, "name": name, "graph": str(graph)} for name, graph in names.items()])
        done("sweep", file, "--out", here / "out")
        rows = results(here / "out")["rows"]
        assert len(rows) == 8 and len({row["mse"] for row in rows}) == 1, "one graph and one scene under several names"
        # The study moves: what counts is what the files hold.
        for row in (here / "out" / "parts").glob("*/*/repetition-0.json"):
            row.unlink()
        shutil.copytree(here / "data", here / "again" / "data")
        shutil.copytree(here / "study", here / "again" / "study", symlinks=True)
        done("sweep", here / "again" / "study" / "tiny.json", "--out", here / "out", "--resume")
        with open(here / "again" / "data" / "still.glb", "ab") as scene:
            scene.write(b"    ")
        text = "\n".join(refused("sweep", here / "again" / "study" / "tiny.json", "--out", here / "out", "--resume"))
        assert "the scene 'still.glb' has changed" in text and "'far'" not in text, text
        (here / "again" / "data" / "still.glb").unlink()
        text = "\n".join(refused("sweep", here / "again" / "study" / "tiny.json", "--out", here / "new"))
        assert "there is no scene file" in text and not (here / "new").exists(), text


def test_files_that_graphs_name_count_by_what_they_hold():
    need_part("embree")
    with folder() as here:
        here = Path(here)
        path = {"kestrel_camera": 1, "target": [0, 1, 0], "keys": [{"time": 0, "eye": [4, 2, 4]}]}
        graph = json.loads((SOURCE / "graphs" / "direct_light.json").read_text())
        for part in ["graphs", "data"]:
            (here / part).mkdir()
        done("scene", "export", "builtin:lattice?detail=0.02", here / "data" / "still.glb")
        orbit, sky, other = here / "graphs" / "orbit.json", here / "data" / "sky.hdr", here / "data" / "other.hdr"
        pixel = lambda value: b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n" + bytes([value, value, value, 129])
        orbit.write_text(json.dumps(path))
        sky.write_bytes(pixel(100))
        other.write_bytes(pixel(50))
        graph["scene"] = {"source": "builtin:lattice", "camera": {"path": "orbit.json"}}
        graph["passes"]["sky"]["properties"] = {"kind": "picture", "file": "sky.hdr"}
        (here / "graphs" / "own.json").write_text(json.dumps(graph))
        variant = {"name": "lit", "graph": "graphs/own.json", "output": "tone.image"}
        file = tiny(here, repeats=1, scenes=["data/still.glb"], reference={"graph": "graphs/own.json", "output": "tone.image"},
                    rays=None, variants=[variant, {**variant, "name": "other sky", "set": ["sky.file=other.hdr"]}])
        sweep = json.loads(file.read_text())
        del sweep["rays"]
        file.write_text(json.dumps(sweep))
        done("sweep", file, "--out", here / "out")
        done("sweep", file, "--out", here / "out", "--resume")

        def told():
            return "\n".join(refused("sweep", file, "--out", here / "out", "--resume"))

        orbit.write_text(json.dumps({**path, "fov": 30}))
        assert "the file 'orbit.json' that the graph 'graphs/own.json' names has changed" in told(), told()
        orbit.write_text(json.dumps(path))
        sky.write_bytes(pixel(101))
        assert "the file 'sky.hdr' that" in told() and "orbit" not in told(), told()
        sky.write_bytes(pixel(100))
        other.write_bytes(pixel(51))
        assert "the file 'other.hdr' that" in told() and "sky.hdr" not in told(), told()
        other.write_bytes(pixel(50))
        done("sweep", file, "--out", here / "out", "--resume")


def test_one_variant_first_and_the_rest_later():
    need_part("embree")
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
    need_part("embree")
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
    need_part("embree")
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


def test_the_sweeps_of_the_paper_come_with_it():
    names = [sweep.stem for sweep in (SOURCE / "graphs" / "sweeps").glob("*.json")]
    for name in ["ambient_occlusion", "antialiasing", "denoising", "glossy", "hierarchy", "indirect", "large_scene", "leaks",
                 "near_field", "refresh", "roma_table2", "snap", "soft_shadow", "subdivision"]:
        assert name in names, name


def test_shipped_sweeps_fit_the_shipped_graphs():
    need_part("embree")
    for sweep in sorted((SOURCE / "graphs" / "sweeps").glob("*.json")):
        if sweep.stem == "schema":
            continue
        assert len(done("sweep", sweep, "--list", "--json").json()) > 3, sweep


def browser():
    for name in ["chromium", "chromium-browser", "google-chrome"]:
        if shutil.which(name):
            return name
    return None


def test_the_page_works_in_a_browser():
    need_part("embree")
    need(browser(), "there is no chromium")
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
