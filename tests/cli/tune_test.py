"""kestrel tune: a tiny sweep with free properties, stopped and resumed, sharded and joined."""
import json
import signal
import subprocess
import time
from pathlib import Path

from kestrel_cli import KESTREL, done, files_in, folder, need_part, refused, run_tests

# Times decide nothing: every way is the same.
TINY = {
    "kestrel_sweep": 1,
    "title": "A tiny tuning",
    "size": [64, 36],
    "frames": 1,
    "repeats": 1,
    "rebuild": True,
    "plot": {"error": "mse"},
    "scenes": ["builtin:blob?detail=0.05", {"name": "tower", "source": "builtin:tower?detail=0.05", "camera": "outside"},
               {"name": "stairs", "source": "builtin:tower?detail=0.05", "camera": "stairs"}],
    "reference": {"graph": "reference_ao.json", "output": "reference.visibility", "mask": "gbuffer.coverage",
                  "set": ["reference.samples=64", "reference.distance=0.5"]},
    "tune": {"train": ["blob?detail=0.05", "tower"], "steps": 4, "rounds": 2, "probes": 2, "time": 1000},
    "variants": [
        {"name": "bitmask", "graph": "horizon_ao.json", "output": "blur.result", "set": ["horizons.radius=4"],
         "tune": {"horizons.radius": [0.1, 2], "horizons.method": ["gtao", "bitmask"]}},
        {"name": "HBAO", "graph": "hbao_interleaved.json", "output": "blur.result", "tune": {"hbao.radius": [0.1, 2]}},
        {"name": "BVH", "graph": "ray_ao.json", "output": "mean.result", "set": ["ao.tracer=bvh.tracer"]},
    ],
}


def tiny(here, **changes):
    file = Path(here) / "tiny.json"
    file.write_text(json.dumps({**TINY, **changes}))
    return file


def results(path):
    return json.loads((Path(path) / "results.json").read_text())


def tuning(path):
    """What must be the same however it was run."""
    data = results(path)["tuning"]
    for point in data["points"]:
        del point["time_ratio"]
    return data


def test_finds_better_settings_and_judges_them_beside_the_defaults():
    need_part("embree")
    with folder() as here:
        file = tiny(here)
        out = done("tune", file, "--out", f"{here}/out").out
        assert "horizons.radius=" in out and "plots that were held out" in out
        data = results(f"{here}/out")
        tuned = data["tuning"]
        assert tuned["train"] == TINY["tune"]["train"] and tuned["hold_out"] == ["stairs"] and data["missing"] == []
        assert [point["variant"] for point in tuned["points"]] == ["bitmask", "HBAO"]
        rows = {(row["scene"], row["variant"]): row for row in data["rows"]}
        assert len(rows) == 3 * (3 + sum(point["set"] != point["start"] for point in tuned["points"]))
        bitmask = tuned["points"][0]
        assert bitmask["start"] == ["horizons.radius=4", "horizons.method=bitmask"] and bitmask["error"] < bitmask["start_error"]
        for point in tuned["points"]:
            errors = [step["error"] for step in point["path"]]
            assert errors == sorted(errors, reverse=True) and errors[-1:] in ([], [point["error"]])
        # What was judged is what was found, to the bit.
        for key, name in [("start_error", "bitmask"), ("error", "bitmask, tuned")]:
            mean = sum(rows[scene, name]["mse"] for scene in tuned["train"]) / 2
            assert abs(mean - bitmask[key]) <= 1e-12 * mean, (mean, bitmask[key])
        row = rows["stairs", "bitmask, tuned"]
        assert row["tuned_of"] == "bitmask" and row["mse"] == bitmask["held_out_error"] and row["axes"]["setting"] == "tuned"
        assert all("--set " + setting in row["command"] for setting in bitmask["set"])
        assert row["times_command"].split()[1] == "tune" and row["picture"] in files_in(f"{here}/out")
        ranks = {plot["scene"]: plot for plot in tuned["ranks"]}
        assert [plot["held_out"] for plot in tuned["ranks"]] == [False, False, True]
        for scene, plot in ranks.items():
            assert plot["default"] == sorted(["bitmask", "HBAO", "BVH"], key=lambda name: rows[scene, name]["mse"])
        page = (Path(here) / "out" / "index.html").read_text()
        assert "Default and tuned" in page and "### Tuned" in (Path(here) / "out" / "results.md").read_text()


def test_a_stopped_tuning_goes_on_and_measures_nothing_twice():
    need_part("embree")
    with folder() as here:
        file = tiny(here)
        done("tune", file, "--out", f"{here}/whole")
        out = Path(here) / "stopped"
        run = subprocess.Popen([KESTREL, "tune", str(file), "--out", str(out)], stdout=subprocess.DEVNULL)
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and run.poll() is None and len(list(out.glob("parts/tuning/*/*.error-*.json"))) < 7:
            time.sleep(0.01)
        run.send_signal(signal.SIGKILL)
        run.wait()
        kept = {part: part.read_bytes() for part in out.glob("parts/tuning/*/*.json")}
        assert len(kept) >= 7
        done("tune", file, "--out", out, "--resume")
        for part, text in kept.items():
            assert part.read_bytes() == text, f"{part} was measured twice"
        assert tuning(out) == tuning(f"{here}/whole")
        names = [sorted(part.name for part in Path(path).glob("parts/tuning/*/*.error-*.json")) for path in [out, f"{here}/whole"]]
        assert names[0] == names[1], "another way was gone"
        other = tiny(here, tune={**TINY["tune"], "rounds": 1})
        assert any("'rounds' of tuning was 2 and is 1" in line for line in refused("tune", other, "--out", out, "--resume"))


def test_shards_join_to_what_one_run_finds():
    need_part("embree")
    with folder() as here:
        file = tiny(here)
        done("tune", file, "--out", f"{here}/whole")
        for shard in [1, 2]:
            done("tune", file, "--out", f"{here}/shard{shard}", "--shard", f"{shard}/2")
        assert [point["variant"] for point in tuning(f"{here}/shard1")["points"]] == ["bitmask"]
        done("tune", file, "--out", f"{here}/joined", "--merge", f"{here}/shard1", f"{here}/shard2")
        assert tuning(f"{here}/joined") == tuning(f"{here}/whole") and results(f"{here}/joined")["missing"] == []


def test_tells_what_is_free_and_refuses_what_cannot_be():
    with folder() as here:
        out = done("tune", tiny(here), "--list").out
        assert "bitmask: horizons.radius=4 horizons.method=bitmask\n" in out and "BVH: nothing is free\n" in out
        listed = done("tune", tiny(here), "--list", "--json").json()
        assert listed[1] == {"variant": "HBAO", "start": ["hbao.radius=0.81"]} and listed[2]["start"] == []
        done("sweep", tiny(here), "--list")
        variant = TINY["variants"][0]
        wrong = {**variant, "tune": {"horizon.radius": [0.1, 2], "horizons.raduis": [0.1, 2], "horizons.steps": [0, 100],
                                     "horizons.method": ["gtoa"]}}
        lines = refused("tune", tiny(here, variants=[wrong]), "--out", f"{here}/out")
        for text in ["no pass 'horizon' (did you mean 'horizons'?)", "'raduis' (did you mean 'radius'?)", "'steps' of pass 'horizons'",
                     "'method' of pass 'horizons'"]:
            assert any(text in line for line in lines), (text, lines)
        assert "nothing is free" in refused("tune", tiny(here, variants=[TINY["variants"][2]]), "--out", f"{here}/out")[0]
        plain = {key: value for key, value in TINY.items() if key != "tune"}
        (Path(here) / "plain.json").write_text(json.dumps({**plain, "variants": [TINY["variants"][2]]}))
        assert "has no 'tune'" in refused("tune", Path(here) / "plain.json", "--out", f"{here}/out")[0]


if __name__ == "__main__":
    run_tests(globals())
