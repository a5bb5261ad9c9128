"""kestrel render: files, statistics, settings, and that nothing is written when something fails."""
import json
from pathlib import Path

from kestrel_cli import RAY_AO, SMALL, done, files_in, folder, kestrel, need_part, refused, run_tests


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
