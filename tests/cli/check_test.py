"""kestrel check, dot, passes, scene, compare, and the usage."""
import json
import re
from pathlib import Path

from json_schema import misfits
from kestrel_cli import RAY_AO, SOURCE, done, folder, kestrel, refused, run_tests

BLOB = ["--scene", "builtin:blob?detail=0.05"]


def test_check_lists_order_memory_and_what_is_left_out():
    out = done("check", RAY_AO, *BLOB).out
    order = out[out.index("order:"):out.index("resources:")]
    assert order.index("bom (") < order.index("roma (") < order.index("ao (") < order.index("mean ("), order
    assert "unshared" in out
    assert "left out: bvh, because nobody reads" in out
    assert "because no material is masked or blended" in out


def test_check_needs_no_opengl():
    without = {"__EGL_VENDOR_LIBRARY_FILENAMES": "/none", "LIBGL_DRIVERS_PATH": "/none", "EGL_PLATFORM": "none"}
    out = done("check", RAY_AO, *BLOB, "--minimum", env=without).out
    assert "the minimum" in out
    refused("check", RAY_AO, *BLOB, "--gl", env=without, status=3)
    fallen = kestrel("check", RAY_AO, *BLOB, env=without)
    assert fallen.status == 0 and "minimum of OpenGL 4.6" in fallen.err, fallen.err


def test_where_no_device_is_a_limit_is_a_note():
    large = ["check", RAY_AO, "--scene", "builtin:tower", "--set", "ao.tracer=bvh.tracer", "--no-shaders"]
    without = {"__EGL_VENDOR_LIBRARY_FILENAMES": "/none", "LIBGL_DRIVERS_PATH": "/none", "EGL_PLATFORM": "none"}
    assert any("texels" in line for line in refused(*large, "--minimum", status=3))
    told = kestrel(*large, env=without)
    assert told.status == 0 and "beyond the minimum of OpenGL 4.6: pass 'bvh'" in told.err, told.err
    assert "bvh (Bvh)" in told.out


def test_check_says_what_the_swap_leaves_out():
    out = done("check", RAY_AO, *BLOB, "--set", "ao.tracer=bvh.tracer", "--json").json()
    names = [item["name"] for item in out["passes"]]
    assert "bvh" in names and "roma" not in names and "bom" not in names
    why = {item["what"]: item["why"] for item in out["left_out"]}
    assert "roma" in why and "bom" in why, why


def test_check_keep_all_leaves_nothing_out():
    out = done("check", RAY_AO, *BLOB, "--keep-all", "--json").json()
    assert "bvh" in [item["name"] for item in out["passes"]]


def test_check_takes_capabilities_from_a_file():
    with folder() as here:
        file = Path(here) / "caps.json"
        file.write_text('{"renderer": "small", "max_texture_buffer_texels": 16}')
        lines = refused("check", RAY_AO, *BLOB, "--set", "ao.tracer=bvh.tracer", "--capabilities", file, status=3)
        assert any("texel" in line for line in lines), lines
        file.write_text('{"max_texel_size": 16, "extensions": [1]}')
        lines = refused("check", RAY_AO, *BLOB, "--capabilities", file)
        assert any("caps.json:1:2" in line and "max_texel_size" in line for line in lines), lines


def test_check_tells_every_mistake_with_its_place():
    with folder() as here:
        file = Path(here) / "bad.json"
        file.write_text(Path(RAY_AO).read_text().replace('"type": "Roma"', '"type": "Rhoma"')
                        .replace('"ao.depth"', '"ao.dept"'))
        lines = refused("check", file, *BLOB)
        assert any("'Rhoma'" in line and "did you mean 'Roma'" in line and "bad.json:" in line for line in lines), lines
        assert any("'dept'" in line or "ao.dept" in line for line in lines), lines
        file.write_text('{"kestrel": 1,\n "passes": [}')
        assert "bad.json:2:" in refused("check", file, *BLOB)[0]


def test_check_reports_a_value_where_it_stands():
    with folder() as here:
        file = Path(here) / "graph.json"
        text = Path(RAY_AO).read_text()
        line = next(i for i, line in enumerate(text.splitlines(), 1) if '"resolution": 128' in line)
        for value, said in [("100", "must be 32, 64, 128 or 256, not 100"), ("1e400", "the number 1e400 is too large"),
                            ("100.5", "must be a whole number, not a number")]:
            file.write_text(text.replace('"resolution": 128', f'"resolution": {value}'))
            lines = refused("check", file, *BLOB, "--minimum", "--no-shaders")
            assert f"graph.json:{line}:" in lines[0] and said in lines[0], lines
        file.write_text(text.replace('"resolution": 128', '"resolution": 128.0'))
        done("check", file, *BLOB, "--minimum", "--no-shaders")
        done("check", RAY_AO, *BLOB, "--minimum", "--no-shaders", "--set", "bom.resolution=128.0")
        assert "1e400" in refused("check", RAY_AO, *BLOB, "--set", "bom.resolution=1e400")[0]


def test_check_wants_outputs_and_suffers_a_pass_that_is_not_connected():
    with folder() as here:
        file = Path(here) / "graph.json"
        graph = json.loads(Path(RAY_AO).read_text())
        graph["passes"]["spare"] = {"type": "Roma"}
        file.write_text(json.dumps(graph))
        out = done("check", file, *BLOB, "--minimum", "--no-shaders").out
        assert "left out: spare, because its input 'occupancy' is not connected" in out, out
        done("check", file, *BLOB, "--minimum", "--no-shaders", "--keep-all")
        line = refused("render", file, *BLOB, "--output", "spare.maps=x.bin")[0]
        assert "is not connected" in line or "spare" in line, line
        del graph["passes"]["spare"]
        graph["outputs"] = []
        file.write_text(json.dumps(graph))
        assert "has no outputs" in refused("check", file, *BLOB, "--minimum", "--no-shaders")[0]
        assert "has no outputs" in refused("render", file, *BLOB)[0]


def test_check_tells_the_first_cause_of_what_cannot_be_made():
    too_much = ["--set", "bom.resolution=256", "--set", "roma.angular=16"]
    line = refused("check", RAY_AO, *BLOB, "--minimum", *too_much)[0]
    assert "'mean.result' cannot be made" in line
    assert "need 536870912 bytes in one storage block; the limit is 134217728" in line


def test_dot_draws_what_is_left_out_faded():
    out = done("dot", RAY_AO, *BLOB).out
    assert out.startswith("digraph")
    faded = [line for line in out.splitlines() if line.strip().startswith('"bvh" [')]
    assert len(faded) == 1 and "dashed" in faded[0] and "nobody reads" in faded[0], faded
    assert '"roma" -> "ao" [label="tracer", style=bold]' in out


def test_dot_draws_every_shipped_graph_whatever_a_device_could_bear():
    for graph in sorted((SOURCE / "graphs").glob("*.json")):
        if graph.name != "schema.json":
            assert done("dot", graph, "--scene", "builtin:tower").out.startswith("digraph"), graph


def test_passes_lists_and_tells():
    assert "Roma" in done("passes").out
    assert "angular" in done("passes", "Roma").out
    table = done("passes", "--json").json()["passes"]
    roma = [item for item in table if item["name"] == "Roma"][0]
    assert {"name", "direction", "kind", "optional", "description"} <= set(roma["ports"][0])
    assert "did you mean 'Roma'" in refused("passes", "Rmoa")[0]
    assert "$schema" in json.loads(done("passes", "--schema").out)


def test_schemas_are_current_and_what_is_shipped_fits():
    graphs = SOURCE / "graphs"
    for command, files in [("passes", graphs), ("passes", graphs / "sweeps" / "graphs"), ("sweep", graphs / "sweeps")]:
        text = done(command, "--schema").out
        shipped = graphs / "schema.json" if command == "passes" else files / "schema.json"
        assert text == shipped.read_text(), f"{shipped} is old: kestrel {command} --schema > {shipped}"
        seen = [file for file in sorted(files.glob("*.json")) if file.name != "schema.json"]
        assert seen
        for file in seen:
            assert misfits(json.loads(file.read_text()), json.loads(text)) == [], file


def test_the_schema_of_sweeps_refuses_what_the_reader_refuses():
    schema = done("sweep", "--schema").json()
    picture = {"name": "a", "graph": "ray_ao.json", "output": "mean.result"}
    sweep = {"kestrel_sweep": 1, "scenes": ["builtin:blob"], "variants": [picture],
             "reference": {"graph": "reference_ao.json", "output": "reference.visibility"}}
    assert misfits(sweep, schema) == []
    with folder() as here:
        file = Path(here) / "sweep.json"
        file.write_text(json.dumps(sweep))
        done("sweep", file, "--list")
        for wrong in [{"frame": 3}, {"frames": 0}, {"repeats": 10_001}, {"size": [4]}, {"scenes": []},
                      {"kestrel_sweep": 2}, {"scenes": [{"camera": "stairs"}]}, {"plot": {"error": "psnr"}},
                      {"times": {"total": ["roma"]}}, {"times": {"own": []}}, {"hdr": 1},
                      {"variants": [{**picture, "hits": "query.hits"}]}, {"variants": [{"name": "a"}]},
                      {"variants": [{**picture, "axes": {"x": []}}]}, {"variants": [{**picture, "set": [1]}]},
                      {"variants": [{**picture, "axes": {"x": {"set": ["x=1"], "values": [1]}}}]}]:
            assert misfits({**sweep, **wrong}, schema), wrong
            file.write_text(json.dumps({**sweep, **wrong}))
            refused("sweep", file, "--list")


def test_scene_lists_tells_and_exports():
    assert "builtin:tower" in done("scene", "list").out
    info = done("scene", "info", "builtin:blob?detail=0.05", "--json").json()
    assert info["facts"]["triangles"] > 0 and info["facts"]["masked"] is False and info["cameras"]
    with folder() as here:
        done("scene", "export", "builtin:blob?detail=0.05", f"{here}/blob.glb")
        again = done("scene", "info", f"{here}/blob.glb", "--json").json()
        assert again["facts"]["triangles"] == info["facts"]["triangles"]
        assert "out.xyz" in refused("scene", "export", "builtin:blob", f"{here}/none/../out.xyz")[0]


def test_compare_measures_and_holds_limits():
    with folder() as here:
        for name, value in [("a", 0), ("b", 7)]:
            done("render", RAY_AO, *BLOB, "--size", "64x36", "--seed", value, "--output", f"mean.result={here}/{name}.png")
        same = done("compare", f"{here}/a.png", f"{here}/a.png", "--json").json()
        assert same["mse"] == 0 and same["flip"]["mean"] == 0
        other = done("compare", f"{here}/a.png", f"{here}/b.png", "--json", "--heatmap", f"{here}/heat.png").json()
        assert {"mse", "rmse", "psnr", "ssim", "flip"} <= set(other) and other["mse"] > 0
        assert (Path(here) / "heat.png").exists()
        limit = kestrel("compare", f"{here}/a.png", f"{here}/b.png", "--max", "mse=0")
        assert limit.status == 1 and "mse" in limit.err, limit.err


def test_a_report_of_a_fault_brings_the_machine_along():
    with folder() as here:
        report = done("--version", "--gl").json()
        own = report["kestrel"]
        assert own["clock"] == ("finish" if report["software"] else "timer query")
        assert own["driver"] and own["parts"].startswith("egl")
        for method, extension in [("interlock", "GL_ARB_fragment_shader_interlock"),
                                  ("framebuffer_fetch", "GL_EXT_shader_framebuffer_fetch")]:
            lacks = own["differs"].get("OccupancyMap", {}).get(f"method={method}", [])
            assert any(extension in sentence for sentence in lacks) == (extension not in report["extensions"])
        assert "method=exact" not in own["differs"].get("OccupancyMap", {})
        # Its reader checks graphs against it.
        file = Path(here) / "report.json"
        file.write_text(json.dumps(report))
        there = done("check", RAY_AO, *BLOB, "--capabilities", file, "--json").json()
        here_ = done("check", RAY_AO, *BLOB, "--json").json()
        assert there == here_
    assert "--version" in refused("--gl")[0]


def test_usage():
    assert "kestrel 0" in done("--version").out and "backends: egl" in done("--version").out
    for command in ["render", "check", "passes", "dot", "compare", "scene", "sweep"]:
        assert command in done("--help").out
        assert "Example" in done(command, "--help").out
    assert "--help" in refused()[0]
    assert "frobnicate" in refused("frobnicate")[0]
    assert "--frobnicate" in refused("render", RAY_AO, "--frobnicate")[0]
    assert len(refused("render")) == 1
    assert "FILE is missing" in refused("sweep")[0]


def test_facts_tell_what_a_scene_leaves_out_of_the_passes_of_a_graph():
    facts = {fact["fact"]: fact["passes"] for fact in json.loads(done("passes", "--facts", RAY_AO, "--json").out)["facts"]}
    opaque = {one["pass"]: one for one in facts["no masked or blended material"]}
    assert opaque["OccupancyMap"]["left_out"] == [{"what": "alpha test", "why": "no material is masked or blended"}]
    assert "DirectLight" not in {one["pass"] for passes in facts.values() for one in passes}
    assert "| no triangle |" in done("passes", "--facts", RAY_AO, "--markdown").out
    assert "did you mean 'ray_ao.json'" in refused("passes", "--facts", "rey_ao.json")[0]


def test_what_a_build_left_out_is_told_where_a_type_is_unknown():
    """As after the demo, which builds the plugins of its own graphs: shaders are there whose plugin is not."""
    with folder() as here:
        share = Path(here)
        (share / "graphs").symlink_to(SOURCE / "graphs")
        (share / "shaders").mkdir()
        for each in (SOURCE / "shaders").iterdir():
            (share / "shaders" / each.name).symlink_to(each)
        (share / "shaders" / "unbuilt").mkdir()
        graph = json.loads(Path(RAY_AO).read_text())
        graph["passes"]["gbuffer"]["type"] = "Unheard"
        (share / "graph.json").write_text(json.dumps(graph))
        env = {"KESTREL_SHARE": str(share)}
        told = "kestrel: not built here: unbuilt; apps/build.sh builds all"
        for arguments in [["check", share / "graph.json"], ["passes", "Unheard"]]:
            lines = refused(*arguments, env=env)
            assert "Unheard" in lines[0] and lines[-1] == told, lines
        assert told not in refused("check", share / "none.json", env=env)


def test_the_demo_builds_the_plugins_of_its_graphs():
    script = (SOURCE / "apps" / "demo.sh").read_text()
    graphs = set(re.findall(r"graphs/\w+\.json", script))
    assert graphs
    types = {one["type"] for graph in graphs for one in json.loads((SOURCE / graph).read_text())["passes"].values()}
    plugins = {row["plugin"].removesuffix(".so") for row in done("passes", "--json").json()["passes"] if row["name"] in types}
    built = re.search(r"passes='([\w;]+)'", (SOURCE / "apps" / "build.sh").read_text()).group(1)
    assert plugins | {"reference"} == set(built.split(";")), plugins


if __name__ == "__main__":
    run_tests(globals())
