"""kestrel on scene files: what they name outside their folder, cameras by name and number, what is said about them."""
import base64
import json
import struct
import zlib
from pathlib import Path

from kestrel_cli import RAY_AO, SOURCE, done, folder, kestrel, refused, run_tests

DIRECT_LIGHT = str(SOURCE / "graphs" / "direct_light.json")
SMALL = ["--size", "32x18"]


def png(colour):
    """A picture of one pixel."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(b"\0" + bytes(colour))) + chunk(b"IEND", b""))


def triangle(**changes):
    """A triangle that fills the default camera's view, with an unlit material."""
    data = struct.pack("<9f", -1, -1, 0, 1, -1, 0, 0, 1, 0) + struct.pack("<6f", 0, 0, 1, 0, 0, 1)
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
        "materials": [{"doubleSided": True}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
        "buffers": [{"byteLength": len(data), "uri": uri}], **changes}


def project(here):
    """models/m.gltf whose texture lies in textures/, beside its folder; models/buffer.gltf whose buffer does."""
    for name in ["models", "textures"]:
        Path(here, name).mkdir()
    Path(here, "textures", "red.png").write_bytes(png([255, 0, 0]))
    scene = triangle(images=[{"uri": "../textures/red.png"}], textures=[{"source": 0}],
                     materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "doubleSided": True}])
    Path(here, "models", "m.gltf").write_text(json.dumps(scene))
    plain = triangle()
    Path(here, "textures", "b.bin").write_bytes(base64.b64decode(plain["buffers"][0]["uri"].split(",")[1]))
    plain["buffers"][0]["uri"] = "../textures/b.bin"
    Path(here, "models", "buffer.gltf").write_text(json.dumps(plain))
    return f"{here}/models/m.gltf", f"{here}/models/buffer.gltf"


def test_what_a_scene_names_outside_its_folder_needs_the_switch_that_the_message_names():
    with folder() as here:
        textured, buffered = project(here)
        albedo = ["--output", f"gbuffer.albedo={here}/a.exr"]
        for command in (["render", DIRECT_LIGHT, *SMALL, *albedo, "-s"], ["check", DIRECT_LIGHT, "-s"],
                        ["dot", DIRECT_LIGHT, "-s"], ["scene", "info"]):
            # An image is left out, the rest of the scene is there; without its buffer there is no scene.
            without = kestrel(*command, textured)
            assert without.status == 0, without.err
            assert "../textures/red.png' leaves the folder of the scene" in without.err, without.err
            assert "--allow-outside" in without.err, without.err
            lines = refused(*command, buffered)
            assert len(lines) == 1 and "--allow-outside" in lines[0], lines
            for scene in (textured, buffered):
                done(*command, scene, "--allow-outside")
        exported = f"{here}/out/e.glb"
        refused("scene", "export", buffered, exported)
        done("scene", "export", buffered, exported, "--allow-outside")
        done("scene", "info", exported)


def test_the_switch_changes_the_picture():
    with folder() as here:
        textured, _ = project(here)
        for name, switch in (("without", []), ("with", ["--allow-outside"])):
            result = kestrel("render", DIRECT_LIGHT, *SMALL, "-s", textured, *switch, "--output",
                             f"gbuffer.albedo={here}/{name}.bin")
            assert result.status == 0, result.err
        without, with_it = (Path(here, f"{name}.bin").read_bytes() for name in ("without", "with"))
        assert without != with_it


def test_a_sweep_takes_the_switch_and_its_commands_carry_it():
    with folder() as here:
        textured, _ = project(here)
        sweep = Path(here, "s.json")
        sweep.write_text(json.dumps({
            "kestrel_sweep": 1, "title": "one", "size": [32, 18], "frames": 1, "repeats": 1,
            "scenes": [{"name": "m", "source": "models/m.gltf"}],
            "reference": {"graph": "ray_ao.json", "output": "mean.result"},
            "variants": [{"name": "BVH", "graph": "ray_ao.json", "output": "mean.result", "set": ["ao.tracer=bvh.tracer"]}]}))
        without = kestrel("sweep", sweep, "--list", "--json")
        assert "--allow-outside" not in without.json()[0]["command"]
        with_it = done("sweep", sweep, "--list", "--json", "--allow-outside")
        assert "--allow-outside" in with_it.json()[0]["command"]
        quiet = done("sweep", sweep, "--out", f"{here}/r", "--allow-outside")
        assert quiet.status == 0
        told = kestrel("sweep", sweep, "--out", f"{here}/r2")
        assert "leaves the folder of the scene" in told.err, told.err


def test_graphs_and_scenes_that_the_user_names_may_lie_anywhere():
    with folder() as here:
        Path(here, "graphs").mkdir()
        Path(here, "scenes").mkdir()
        Path(here, "scenes", "t.gltf").write_text(json.dumps(triangle()))
        graph = json.loads(Path(DIRECT_LIGHT).read_text())
        for source in ("../scenes/t.gltf", f"{here}/scenes/t.gltf"):
            graph["scene"] = {"source": source}
            Path(here, "graphs", "g.json").write_text(json.dumps(graph))
            done("check", f"{here}/graphs/g.json")


def cameras(*names):
    return triangle(
        cameras=[{"type": "perspective", "name": name, "perspective": {"yfov": 1, "znear": 0.1}} for name in names],
        nodes=[{"mesh": 0}] + [{"camera": i, "translation": [0, 0, 2 + i]} for i in range(len(names))],
        scenes=[{"nodes": list(range(len(names) + 1))}])


def test_cameras_of_one_name_are_told_apart_and_chosen_by_name_or_number():
    with folder() as here:
        scene = f"{here}/c.gltf"
        Path(scene).write_text(json.dumps(cameras("cam", "cam", "side")))
        assert "cameras: cam, cam (2), side" in done("scene", "info", scene).out
        pictures = {}
        for camera in ("cam", "0", "cam (2)", "1"):
            done("render", DIRECT_LIGHT, *SMALL, "-s", scene, "--camera", camera, "--output", f"gbuffer.depth={here}/d.bin")
            pictures[camera] = Path(here, "d.bin").read_bytes()
        assert pictures["cam"] == pictures["0"] != pictures["1"] == pictures["cam (2)"]
        line = refused("check", DIRECT_LIGHT, "-s", scene, "--camera", "sdie")[0]
        assert "no camera 'sdie' (did you mean 'side'?); it has 'cam', 'cam (2)' and 'side'" in line, line
        line = refused("render", DIRECT_LIGHT, "-s", scene, "--camera", "3")[0]
        assert "no camera '3'" in line and "counted from 0" in line, line


def test_a_factor_that_rounding_took_out_of_its_range_is_clamped_and_told():
    with folder() as here:
        scene = f"{here}/r.gltf"
        rounded = {"pbrMetallicRoughness": {"baseColorFactor": [1.0000001192092896, 1, 1, 1]}}
        Path(scene).write_text(json.dumps(triangle(materials=[rounded])))
        told = kestrel("scene", "info", scene)
        assert told.status == 0 and "materials[0].pbrMetallicRoughness.baseColorFactor[0]" in told.err, told.err
        assert json.loads(kestrel("scene", "info", scene, "--json").out)["warnings"], "scripts see it too"


def test_thousands_of_textures_of_one_size_are_drawn():
    with folder() as here:
        count = 2100
        scene = triangle(
            images=[{"uri": "data:image/png;base64," + base64.b64encode(png([i % 256, i // 256, 90])).decode()} for i in range(count)],
            textures=[{"source": i} for i in range(count)],
            materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}, "doubleSided": True} for i in range(count)])
        scene["meshes"][0]["primitives"][0]["material"] = 1234
        Path(here, "t.gltf").write_text(json.dumps(scene))
        done("render", DIRECT_LIGHT, *SMALL, "-s", f"{here}/t.gltf", "--output", f"gbuffer.albedo={here}/many.exr")
        one = triangle(images=[scene["images"][1234]], textures=[{"source": 0}],
                       materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "doubleSided": True}])
        Path(here, "o.gltf").write_text(json.dumps(one))
        done("render", DIRECT_LIGHT, *SMALL, "-s", f"{here}/o.gltf", "--output", f"gbuffer.albedo={here}/one.exr")
        done("compare", f"{here}/one.exr", f"{here}/many.exr", "--max", "mse=1e-6")


if __name__ == "__main__":
    run_tests(globals())
