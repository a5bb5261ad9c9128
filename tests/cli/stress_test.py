"""kestrel stress: cases in processes of their own, what they find, and that nothing finished is lost."""
import json
import os
import random
import re
import signal
import subprocess
import time
from pathlib import Path

from kestrel_cli import KESTREL, RAY_AO, SOURCE, done, files_in, folder, kestrel, refused, run_tests

BLOB = ["--scene", "builtin:blob?detail=0.02", "--size", "32x18"]
# A planted crash ends by its signal under AddressSanitizer too.
PLANTED = {"KESTREL_PLUGINS": str(Path(KESTREL).parent.parent / "test_plugins" / "planted"),
           "ASAN_OPTIONS": "handle_segv=0"}


def planted(here, kind):
    """A graph of the one wrong pass over the depth of the scene."""
    graph = Path(here) / f"{kind.lower()}.json"
    graph.write_text(json.dumps({
        "kestrel": 1, "name": kind, "scene": {"source": "builtin:blob?detail=0.02"},
        "passes": {"gbuffer": {"type": "GBuffer"}, "wrong": {"type": kind}},
        "edges": [["gbuffer.view_depth", "wrong.view_depth"]], "outputs": ["wrong.result"]}))
    return graph


def stressed(here, graph, *options):
    """The results by case."""
    result = kestrel("stress", graph, "--size", "32x18", "--json", f"{here}/r.json", *options, env=PLANTED)
    assert result.status in (0, 1), result.err
    data = json.loads(Path(here, "r.json").read_text())
    assert (result.status == 1) == any(case["outcome"] not in ("held", "lacking", "unfit") for case in data["cases"])
    return {case["name"]: case for case in data["cases"]}, result


def missed(case):
    return [check for check in case["checks"] if not check["held"]]


def test_a_division_by_the_far_plane_is_found():
    with folder() as here:
        cases, result = stressed(here, planted(here, "DividesByFar"), "--only", "depth")
        wrong = missed(cases["depth/infinite"])
        assert wrong[0]["port"] == "wrong.result" and wrong[0]["expects"] == "finite", wrong
        assert "pass 'wrong', port 'result', pixel (0, 0)" in wrong[0]["what"] and wrong[0]["missed"] == 32 * 18
        assert "depth/infinite: missed: pass 'wrong'" in result.out
        # The command that is told shows it.
        command = cases["depth/infinite"]["command"]
        assert command.startswith("kestrel stress ") and "--only depth/infinite" in command
        again = subprocess.run(command.replace("kestrel", f"'{KESTREL}'", 1), shell=True, capture_output=True, text=True,
                               timeout=60, cwd=here, env={**os.environ, **PLANTED})
        assert again.returncode == 1 and "depth/infinite" in again.stdout, again.stderr
        page = Path(here, "page", "index.html").read_text()
        assert "wrong.result" in page and 'class="missed"' in page and "http" not in re.sub(r"<!--.*?-->", "", page)


def test_a_fixed_epsilon_is_found():
    with folder() as here:
        cases, _ = stressed(here, planted(here, "FixedEpsilon"), "--only", "scale", "--page", f"{here}/page")
        for name in ["scale/1e-06", "scale/1e+06"]:
            wrong = missed(cases[name])
            assert wrong and wrong[0]["port"] == "wrong.result" and wrong[0]["expects"] == "same", cases[name]
            assert wrong[0]["missed"] > 1 and wrong[0]["picture"] in files_in(f"{here}/page")


def test_a_hang_costs_one_case():
    with folder() as here:
        cases, result = stressed(here, planted(here, "Hangs"), "--only", "frame", "--timeout", 4)
        hung = [name for name, case in cases.items() if case["outcome"] == "hung"]
        assert hung == ["frame/1x1", "frame/1x64"], hung
        assert cases["frame/1x1"]["where"] == "pass 'wrong', step 'make'" and "4 s" in cases["frame/1x1"]["why"]
        assert "in pass 'wrong', step 'make'" in result.out
        assert cases["frame/64x1"]["outcome"] == "held"


def test_a_crash_costs_one_case():
    with folder() as here:
        cases, _ = stressed(here, planted(here, "Crashes"), "--only", "geometry")
        crashed = [name for name, case in cases.items() if case["outcome"] == "crashed"]
        assert crashed == ["geometry/empty"], crashed
        assert "signal 11" in cases["geometry/empty"]["why"]
        assert cases["geometry/empty"]["where"] == "pass 'wrong', step 'make'"
        assert cases["geometry/one"]["outcome"] == "held"


def test_dropped_fragments_are_found():
    with folder() as here:
        cases, _ = stressed(here, planted(here, "DropsFragments"), "--only", "layers")
        assert not missed(cases["layers/1"])
        wrong = missed(cases["layers/100"])
        assert wrong and wrong[0]["port"] == "wrong.result" and wrong[0]["expects"] == "order", cases["layers/100"]


def test_what_a_graph_refuses_of_a_case_is_no_failure():
    """Layers are composited pixel by pixel of the frame: a guard band of all passes does not fit."""
    with folder() as here:
        file = f"{here}/r.json"
        out = done("stress", "transparency.json", "--size", "32x18", "--only", "frame/guard", "--json", file).out
        case, = json.loads(Path(file).read_text())["cases"]
        assert case["outcome"] == "unfit" and "without guard band" in case["why"], case
        assert "frame/guard: unfit: " in out and "1 unfit" in out, out


def test_what_is_left_out_and_needed_is_found():
    with folder() as here:
        cases, _ = stressed(here, planted(here, "ClaimsNoNeed"), "--only", "numbers")
        wrong = missed(cases["numbers/keep_all"])
        assert wrong and wrong[0]["port"] == "wrong.result" and wrong[0]["expects"] == "same", cases["numbers/keep_all"]
        assert not missed(cases["numbers/plain"])


def test_a_curve_shows_where_a_technique_breaks():
    with folder() as here:
        graph = planted(here, "FixedEpsilon")
        out = kestrel("stress", graph, "--size", "32x18", "--curve", "scale", "--values", "1e-3,1,1e3", "--frames", 2,
                      "--page", f"{here}/page", "--json", f"{here}/c.json", env=PLANTED)
        assert out.status == 0, out.err
        data = json.loads(Path(here, "c.json").read_text())
        assert data == json.loads(Path(here, "page", "curve.json").read_text())
        series = data["plots"][0]["series"]
        assert [one["name"] for one in series] == ["wrong.result"] and "truth" not in series[0]["plain"]
        small, same, large = (point["own"] for point in series[0]["points"])
        assert same == 0 and small > 0.1 and large > 0.1, series
        assert "wrong.result" in out.out and Path(here, "page", "index.html").exists()
        pictures = [name for name in files_in(f"{here}/page") if name.endswith(".svg")]
        assert len(pictures) == 1 and "wrong.result" in Path(here, "page", pictures[0]).read_text()


def test_a_curve_of_a_sweep_is_held_against_its_reference():
    with folder() as here:
        sweep = Path(here) / "sweep.json"
        graph = str(SOURCE / "graphs" / "sweeps" / "graphs" / "ao.json")
        sweep.write_text(json.dumps({
            "kestrel_sweep": 1, "title": "Three", "size": [32, 18], "frames": 4,
            "scenes": [{"name": "blob", "source": "builtin:blob?detail=0.02"}],
            "reference": {"graph": "reference_ao.json", "output": "reference.visibility", "mask": "gbuffer.coverage",
                          "set": ["reference.samples=64"]},
            "variants": [{"name": tracer, "graph": graph, "output": "mean.result",
                          "set": [f"ao.tracer={tracer}.tracer", "bom.resolution=32"]} for tracer in ["roma", "bvh"]]}))
        done("stress", sweep, "--curve", "off_centre", "--values", "1,1000", "--page", f"{here}/page")
        plot = json.loads(Path(here, "page", "curve.json").read_text())["plots"][0]
        roma, bvh = plot["series"]
        # Cells grow with the distance, triangles do not.
        assert roma["points"][1]["truth"] > 1.25 * roma["plain"]["truth"], roma
        assert bvh["points"][1]["truth"] < 1.2 * bvh["plain"]["truth"], bvh
        assert "--only roma" in roma["command"]
        done("stress", sweep, "--curve", "off_centre", "--values", "1", "--only", "bvh", "--page", f"{here}/page")
        assert len(json.loads(Path(here, "page", "curve.json").read_text())["plots"][0]["series"]) == 1
        assert "is a sweep" in refused("stress", sweep, "--curve", "scale", "--page", f"{here}/p", "--set", "a.b=1")[0]


def test_a_crash_is_a_point_of_a_curve():
    with folder() as here:
        kestrel("stress", planted(here, "Crashes"), "--scene", "builtin:stress_empty", "--size", "32x18", "--curve",
                "scale", "--values", "1", "--page", f"{here}/page", env=PLANTED)
        point = json.loads(Path(here, "page", "curve.json").read_text())["plots"][0]["series"][0]["points"][0]
        assert point["own"] is None and "signal 11" in point["why"], point


def test_bad_curves_are_refused():
    assert "did you mean 'scale'" in refused("stress", RAY_AO, "--curve", "scael", "--page", "p")[0]
    assert "needs --page" in refused("stress", RAY_AO, "--curve", "scale")[0]
    assert "above 0" in refused("stress", RAY_AO, "--curve", "scale", "--page", "p", "--values", "0")[0]
    assert "--frames is of --curve" in refused("stress", RAY_AO, "--frames", 3)[0]


def test_lists_its_cases():
    out = done("stress", "--list").out
    names = [line.split()[0] for line in out.splitlines()[:-1]]
    assert len(names) >= 60 and len(set(names)) == len(names)
    kinds = {name.split("/")[0] for name in names}
    assert kinds == {"numbers", "scale", "place", "turn", "depth", "frame", "geometry", "layers", "light", "rays", "time"}
    assert done("stress", "--list", "--only", "scale").out.count("scale/") == 6


def test_bad_input_is_refused():
    assert "did you mean 'numbers/plain'" in refused("stress", RAY_AO, "--only", "numbers/plian")[0]
    assert "did you mean 'scale'" in refused("stress", RAY_AO, "--only", "scael")[0]
    assert "GRAPH is missing" in refused("stress")[0]
    assert "gbufer" in refused("stress", RAY_AO, "--set", "gbufer.jitter=true")[0]
    assert "give a file" in refused("stress", "-")[0]
    assert "--resume needs --json" in refused("stress", RAY_AO, *BLOB, "--resume")[0]
    with folder() as here:
        done("stress", RAY_AO, *BLOB, "--only", "numbers/plain", "--json", f"{here}/r.json")
        line = refused("stress", RAY_AO, *BLOB, "--only", "numbers/plain", "--json", f"{here}/r.json", "--resume",
                       "--set", "ao.rays=2")[0]
        assert "results of another run" in line, line


def test_results_are_not_written_over_the_graph():
    with folder() as here:
        mine = Path(here, "mine.json")
        text = Path(RAY_AO).read_text()
        mine.write_text(text)
        Path(here, "link.json").symlink_to(mine)
        for graph, file in [(mine, mine), (mine, f"{here}/../{Path(here).name}/link.json"), ("./mine.json", mine)]:
            for words in [["stress", graph, "--json", file], ["stress", graph, "--resume", "--json", file],
                          ["stress", graph, "--curve", "scale", "--page", "p", "--json", file],
                          ["render", graph, "--stats", file]]:
                line = refused(*words, folder=here)[0]
                assert f"{words[-2]} {file} would be written over GRAPH {graph}" in line, line
        assert mine.read_text() == text
        # A name that is a shipped graph's as long as no file has it.
        line = refused("stress", "ray_ao.json", "--json", "ray_ao.json", folder=here)[0]
        assert "--json ray_ao.json would from then on be taken for GRAPH ray_ao.json, which is /" in line, line
        assert not Path(here, "ray_ao.json").exists()


def test_without_a_device_it_says_so():
    lines = refused("stress", RAY_AO, *BLOB, "--only", "numbers/plain", status=3,
                    env={"__EGL_VENDOR_LIBRARY_FILENAMES": "/nowhere.json"})
    assert len(lines) == 1, lines


def test_what_is_killed_loses_nothing_that_was_finished():
    """kill -9 at random moments: what the file holds is whole, and going on makes the rest."""
    chance = random.Random(12)
    with folder() as here:
        file = Path(here) / "r.json"
        command = [KESTREL, "stress", RAY_AO, *BLOB, "--only", "scale", "--json", str(file), "--resume"]
        finished = {}
        for _ in range(20):
            run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(chance.uniform(0.1, 2.5))
            run.send_signal(signal.SIGKILL)
            run.wait()
            held = {case["name"]: case for case in json.loads(file.read_text())["cases"]} if file.exists() else {}
            for name, case in finished.items():
                assert held[name] == case, name
            finished = held
            if len(finished) == 6:
                file.unlink()  # from the start again
                finished = {}
        done(*command[1:])
        assert len(json.loads(file.read_text())["cases"]) == 6


if __name__ == "__main__":
    run_tests(globals())
