"""kestrel render: files, statistics, settings, and that nothing is written when something fails."""
import json
from pathlib import Path

from kestrel_cli import KESTREL, RAY_AO, SMALL, SOURCE, done, files_in, folder, kestrel, need_part, refused, run_tests, shell


def test_writes_the_outputs_under_their_names():
    with folder() as out:
        result = done("render", RAY_AO, *SMALL, "--out", out)
        assert files_in(out) == ["mean.result.png"], files_in(out)
        assert "mean.result.png" in result.out
        assert "time: 1 frame," in result.out
        assert "memory: " in result.out
        assert "left out: bvh, because nobody reads" in result.out


def test_writes_any_port_by_the_ending_of_the_file():
    with folder() as out:
        for name in ["n.png", "n.hdr", "n.exr", "n.bin"]:
            done("render", RAY_AO, *SMALL, "--output", f"gbuffer.normal={out}/{name}")
        assert files_in(out) == ["n.bin", "n.exr", "n.hdr", "n.png"]
        assert (Path(out) / "n.bin").stat().st_size == 64 * 36 * 8


def test_the_same_command_gives_the_same_bytes():
    with folder() as out:
        for name in ["a", "b"]:
            done("render", RAY_AO, *SMALL, "--frames", 3, "--seed", 5, "--output", f"mean.result={out}/{name}.exr")
        done("render", RAY_AO, *SMALL, "--frames", 3, "--seed", 6, "--output", f"mean.result={out}/c.exr")
        a, b, c = [(Path(out) / f"{name}.exr").read_bytes() for name in "abc"]
        assert a == b
        assert a != c


def test_stats_have_the_stated_keys():
    with folder() as out:
        done("render", RAY_AO, *SMALL, "--frames", 4, "--seed", 3, "--out", out, "--stats", f"{out}/s.json")
        stats = json.loads((Path(out) / "s.json").read_text())
        assert stats["graph_path"] == RAY_AO and stats["scene_path"] == "builtin:tower?detail=0.05"
        for key in ["graph", "scene", "size", "frames", "seed", "renderer", "driver", "clock", "spin", "passes",
                    "frame_ms", "left_out", "memory"]:
            assert key in stats, key
        assert stats["frames"] == 4 and stats["seed"] == 3 and stats["size"] == [64, 36]
        passes = {item["name"]: item for item in stats["passes"]}
        assert passes["gbuffer"]["runs"] == 1, "nothing moves: once is enough"
        assert passes["ao"]["runs"] == 4
        assert 0 < passes["ao"]["ms"]["min"] <= passes["ao"]["ms"]["median"] <= passes["ao"]["ms"]["max"]
        assert "bvh" in [item["what"] for item in stats["left_out"]]
        assert set(stats["memory"]) == {"transient", "unshared", "persistent"}


def test_a_clock_can_be_named():
    with folder() as out:
        runs = {}
        for name in ["finish", "timer_query"]:
            done("render", RAY_AO, *SMALL, "--frames", 3, "--clock", name, "--out", out, "--stats", f"{out}/s.json")
            stats = json.loads((Path(out) / "s.json").read_text())
            assert stats["clock"] == name.replace("_", " ")
            runs[name] = {item["name"]: item["runs"] for item in stats["passes"]}
        assert runs["finish"] == runs["timer_query"]
        assert "'finish'" in refused("render", RAY_AO, *SMALL, "--clock", "finsh", "--out", out)[0]


def test_set_moves_an_edge():
    with folder() as out:
        result = done("render", RAY_AO, *SMALL, "--set", "ao.tracer=bvh.tracer", "--out", out)
        assert "left out: roma" in result.out and "left out: bom" in result.out, result.out
        assert "left out: bvh," not in result.out


def test_sharing_memory_changes_no_image():
    with folder() as out:
        done("render", RAY_AO, *SMALL, "--frames", 2, "--output", f"mean.result={out}/shared.exr")
        done("render", RAY_AO, *SMALL, "--frames", 2, "--no-sharing", "--output", f"mean.result={out}/alone.exr")
        assert (Path(out) / "shared.exr").read_bytes() == (Path(out) / "alone.exr").read_bytes()


def test_check_finite_finds_nothing_in_a_shipped_graph():
    with folder() as out:
        done("render", RAY_AO, *SMALL, "--check-finite", "--frames", 2, "--out", out)


def test_the_time_step_is_chosen():
    """A step of two frames is two frames; one of 0 stands still."""
    run = ["render", RAY_AO, "--scene", "builtin:morph?detail=0.05", "--size", "64x36"]
    with folder() as out:
        for name, frames, options in [("second", 3, []), ("double", 2, ["--time-step", str(2 / 60)]), ("fps", 2, ["--fps", 30]),
                                      ("still", 3, ["--time-step", 0]), ("first", 1, [])]:
            done(*run, "--frames", frames, *options, "--output", f"gbuffer.position={out}/{name}.exr")
        second, double, fps, still, first = [(Path(out) / f"{name}.exr").read_bytes()
                                             for name in ["second", "double", "fps", "still", "first"]]
        assert double == fps == second and still == first and first != second
    assert "excludes" in refused(*run, "--time-step", 1, "--fps", 30)[0].lower()
    assert "--time-step" in refused(*run, "--time-step", -1)[0]


def test_check_finite_names_every_bad_output():
    """A pass that divides by an infinite far plane: each output, its first pixel, and how many."""
    planted = str(Path(KESTREL).parent.parent / "test_plugins" / "planted")
    with folder() as here:
        graph = Path(here) / "far.json"
        graph.write_text(json.dumps({
            "kestrel": 1, "scene": {"source": "builtin:blob?detail=0.02"},
            "passes": {"gbuffer": {"type": "GBuffer"}, "wrong": {"type": "DividesByFar"}, "mean": {"type": "Accumulate"}},
            "edges": [["gbuffer.view_depth", "wrong.view_depth"], ["wrong.result", "mean.signal"]],
            "outputs": ["mean.result"]}))
        run = ["render", graph, "--size", "32x18", "--check-finite", "--out", here]
        env = {"KESTREL_PLUGINS": planted}
        assert kestrel(*run, env=env).status == 0, "the scene's own far plane is finite"
        lines = refused(*run, "--camera", "eye=0,2,5 target=0,0.5,0", status=1, env=env)
        assert [line.split("pass '")[1].split("', pixel")[0] for line in lines] == ["wrong', port 'result", "mean', port 'result"]
        assert "pixel (0, 0), channel 0: inf is infinite" in lines[0] and "is not a number" in lines[1], lines
        for line in lines:
            assert line.startswith("kestrel: frame 0: "), line
            assert line.endswith(f"{32 * 18} of its values are bad"), line


def test_osmesa_gives_the_same_picture():
    need_part("osmesa")
    with folder() as out:
        for backend in ["egl", "osmesa"]:
            done("render", RAY_AO, *SMALL, "--backend", backend, "--output", f"mean.result={out}/{backend}.exr")
        assert (Path(out) / "egl.exr").read_bytes() == (Path(out) / "osmesa.exr").read_bytes()


def test_writes_nothing_when_something_fails():
    with folder() as out:
        lines = refused("render", RAY_AO, *SMALL, "--out", f"{out}/a", "--output", "mean.result=/proc/none/x.png")
        assert "/proc/none" in lines[0], lines
        refused("render", RAY_AO, *SMALL, "--out", f"{out}/b", "--output", "mean.reslut=x.png")
        refused("render", RAY_AO, *SMALL, "--out", f"{out}/c", "--camera", "nobody")
        assert files_in(out) == []


def test_says_what_cannot_be_written_before_the_first_frame():
    with folder() as here:
        Path(here, "file").write_text("")
        for option, value in [("--out", "file/x"), ("--output", "mean.result=file/x.png"), ("--stats", "file/s.json"),
                              ("--stats", ".")]:
            # So many frames would take minutes.
            line = refused("render", RAY_AO, *SMALL, "--frames", 100_000, option, value, folder=here)[0]
            assert "cannot be written" in line and value.split("=")[-1].split("/")[0] in line, line
        assert "--out" in refused("render", RAY_AO, *SMALL, "--out", "")[0]
        assert "--stats" in refused("render", RAY_AO, *SMALL, "--stats", "")[0]
        lines = refused("render", RAY_AO, *SMALL, "--output", "mean.result=a.png", "--output", "ao.visibility=./a.png", folder=here)
        assert "two outputs would go into" in lines[0], lines
        assert files_in(here) == ["file"]


def test_quiet_says_nothing():
    with folder() as here:
        assert done("-q", "render", RAY_AO, *SMALL, "--out", here).out == ""
        assert done("check", RAY_AO, *SMALL, "-q", "--minimum", "--no-shaders").out == ""
        picture = f"{here}/mean.result.png"
        assert done("-q", "compare", picture, picture).out == ""
        assert json.loads(done("-q", "compare", picture, picture, "--json").out)["mse"] == 0


def test_a_sequence_has_a_file_for_each_frame():
    with folder() as here:
        run = ["render", RAY_AO, *SMALL]
        out = done(*run, "--frames", 5, "--output", f"mean.result={here}/f_%03d.exr", "--every", 2,
                   "--output", f"ao.visibility={here}/last.exr").out
        assert files_in(here) == ["f_000.exr", "f_002.exr", "f_004.exr", "last.exr"], files_in(here)
        assert "f_004.exr" in out
        # Each is what a run that ends there writes.
        done(*run, "--frames", 3, "--output", f"mean.result={here}/three.exr")
        assert Path(here, "three.exr").read_bytes() == Path(here, "f_002.exr").read_bytes()
        done(*run, "--frames", 3, "--every", 2, "--out", f"{here}/all")
        assert files_in(f"{here}/all") == ["mean.result.0000.png", "mean.result.0002.png"]
        done(*run, "--output", f"mean.result={here}/100%%.png")
        assert Path(here, "100%.png").exists()
        for name in ["%s.png", "%.png", "%d_%d.png", "%-3d.png"]:
            assert "'%' begins the number of the frame" in refused(*run, "--output", f"mean.result={here}/{name}")[0]
        assert "--every" in refused(*run, "--every", 2, "--output", f"mean.result={here}/x.png")[0]


def test_graphs_and_pictures_go_through_pipes():
    small = " ".join(f"'{word}'" for word in SMALL)
    with folder() as here:
        shell(f"cat {RAY_AO} | $KESTREL render - {small} --output mean.result=exr:- > {here}/a.exr")
        done("render", RAY_AO, *SMALL, "--output", f"mean.result={here}/b.exr")
        assert Path(here, "a.exr").read_bytes() == Path(here, "b.exr").read_bytes()
        shell(f"$KESTREL render <(cat {RAY_AO}) {small} --output mean.result=- | $KESTREL compare - "
              f"<($KESTREL -q render {RAY_AO} {small} --output mean.result=/dev/stdout) --max mse=0")
        stats = shell(f"$KESTREL render {RAY_AO} {small} --out {here} --stats -").stdout
        assert json.loads(stats)["frames"] == 1, "the report goes to standard error"
        assert Path("/dev/stdout").is_symlink()
        two = ["--output", "mean.result=-", "--stats", "-"]
        assert "two outputs" in refused("render", RAY_AO, *SMALL, *two)[0]


def test_a_scene_gains_cameras_and_lights():
    with folder() as here:
        graph = SOURCE / "graphs" / "direct_light.json"
        dark = ["render", graph, "--scene", f"{here}/dark.gltf", "--size", "64x36"]
        Path(here, "dark.gltf").write_text(json.dumps(floor()))
        above = ["--camera", "eye=0,5,0 target=0,0,0 fov=30"]
        done(*dark, *above, "--output", f"direct.result={here}/dark.exr", "--out", here)
        done(*dark, *above, "--light", "directional direction=0,-1,0 intensity=3", "--light",
             "point position=0,1,0 intensity=0", "--output", f"direct.result={here}/lit.exr")
        lit = done("compare", f"{here}/dark.exr", f"{here}/lit.exr", "--json").json()
        # A white diffuse floor, seen straight on: 3 / pi on every pixel.
        assert abs(lit["rmse"] - 3 / 3.14159265) < 0.01, lit
        lines = refused(*dark, "--camera", "eye=0,5 target=0,0,0", "--light", "sun direction=0,-1,0")
        assert len(lines) == 2 and "'eye'" in lines[0] and "'sun'" in lines[1], lines
        assert "did you mean 'floor'" in refused(*dark, "--camera", "node=flor")[0]
        assert "'walk'" in refused(*dark, "--animation", "walk")[0]


def test_time_goes_on_as_it_is_told():
    with folder() as here:
        run = ["render", RAY_AO, "--scene", "builtin:skinned?detail=0.1", "--size", "64x36"]
        done(*run, "--fps", 4, "--frames", 4, "--output", f"gbuffer.normal={here}/f_%d.exr")
        done(*run, "--time", 0.75, "--still", "--frames", 2, "--output", f"gbuffer.normal={here}/there.exr")
        done(*run, "--animation", "none", "--fps", 4, "--frames", 4, "--output", f"gbuffer.normal={here}/rest_%d.exr")
        read = lambda name: Path(here, name).read_bytes()
        assert read("f_0.exr") != read("f_3.exr") == read("there.exr")
        assert read("rest_0.exr") == read("rest_3.exr")
        late = kestrel(*run, "--time", 1000, "--output", f"gbuffer.normal={here}/late.exr")
        assert late.status == 0 and "lies after the end of the scene's timeline" in late.err, late.err


def floor():
    """A glTF document: a square of 20 at y = 0, upward, white and rough; no camera, no light."""
    import base64, struct
    corners = struct.pack("<12f", -10, 0, -10, -10, 0, 10, 10, 0, 10, 10, 0, -10) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    return {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"name": "floor", "mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
            "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 1}}],
            "buffers": [{"byteLength": 60, "uri": "data:application/octet-stream;base64," + base64.b64encode(corners).decode()}],
            "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-10, 0, -10],
                           "max": [10, 0, 10]}, {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}]}


def test_refuses_what_it_does_not_know():
    assert "bvh.tracre" in refused("render", RAY_AO, *SMALL, "--set", "ao.tracer=bvh.tracre")[0]
    assert "64y36" in refused("render", RAY_AO, "--size", "64y36")[0]
    assert "0x36" in refused("render", RAY_AO, "--size", "0x36")[0]
    assert ".jpg" in refused("render", RAY_AO, *SMALL, "--output", "mean.result=x.jpg")[0]
    assert "pass.port=FILE" in refused("render", RAY_AO, *SMALL, "--output", "mean.result")[0]
    assert "did you mean 'osmesa'" in refused("render", RAY_AO, *SMALL, "--backend", "osmsea")[0]
    assert "did you mean 'tower'" in refused("render", RAY_AO, "--scene", "builtin:towre")[0]
    assert "nowhere.glb" in refused("render", RAY_AO, "--scene", "nowhere.glb")[0]
    assert "--frames" in refused("render", RAY_AO, "--frames", 0)[0]


def test_a_bad_scene_file_is_one_line_and_nothing_is_written():
    bad = {
        "cut.gltf": ('{"asset": {"version": "2.0"', "cut.gltf"),
        "outside.gltf": ('{"asset": {"version": "2.0"}, "buffers": [{"byteLength": 12, "uri": "../secret.bin"}]}', "../secret.bin"),
        "index.gltf": ('{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [7]}]}', "7"),
        "cut.glb": ("glTF", "cut.glb"),
        "scene.obj": ("v 0 0 0", "scene.obj"),
    }
    with folder() as here:
        for name, (text, named) in bad.items():
            Path(here, name).write_text(text)
            lines = refused("render", RAY_AO, "--scene", f"{here}/{name}", "--out", f"{here}/out")
            assert len(lines) == 1, lines
            assert named in lines[0], lines[0]
        assert files_in(here) == sorted(bad)


def test_a_left_out_port_tells_why():
    # Asking for it makes it wanted; a port of a pass that cannot run here stays out.
    lines = refused("render", RAY_AO, *SMALL, "--output", "roma.tracer=x.png")
    assert "roma.tracer" in lines[0], lines


if __name__ == "__main__":
    run_tests(globals())
