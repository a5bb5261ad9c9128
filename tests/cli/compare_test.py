"""kestrel compare with several tests, layers of EXR files, and pictures of other programs."""
import json
import struct
from pathlib import Path

from kestrel_cli import done, folder, kestrel, refused, run_tests

WIDTH, HEIGHT = 12, 8


def exr(file, planes):
    """Writes a picture of one value a channel: scan lines of float32, uncompressed."""
    def attribute(name, kind, data):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data

    names = sorted(planes)
    channels = b"".join(name.encode() + b"\0" + struct.pack("<iIii", 2, 0, 1, 1) for name in names) + b"\0"
    window = struct.pack("<iiii", 0, 0, WIDTH - 1, HEIGHT - 1)
    head = struct.pack("<II", 20000630, 2) + attribute("channels", "chlist", channels) + \
        attribute("compression", "compression", b"\0") + attribute("dataWindow", "box2i", window) + \
        attribute("displayWindow", "box2i", window) + attribute("lineOrder", "lineOrder", b"\0") + \
        attribute("pixelAspectRatio", "float", struct.pack("<f", 1)) + \
        attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)) + \
        attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    line = b"".join(struct.pack("<f", planes[name]) * WIDTH for name in names)
    start = len(head) + 8 * HEIGHT
    table = b"".join(struct.pack("<Q", start + y * (8 + len(line))) for y in range(HEIGHT))
    Path(file).write_bytes(head + table + b"".join(struct.pack("<ii", y, len(line)) + line for y in range(HEIGHT)))


def hdr(file, mantissa, exponent=129, header="", resolution=f"-Y {HEIGHT} +X {WIDTH}"):
    pixels = bytes([mantissa] * 3 + [exponent]) * (WIDTH * HEIGHT)
    text = f"#?RADIANCE\n{header}FORMAT=32-bit_rle_rgbe\n\n{resolution}\n"
    Path(file).write_bytes(text.encode() + pixels)


def pictures(here):
    exr(here / "reference.exr", {"R": 1, "G": 1, "B": 1})
    exr(here / "near.exr", {"R": 1, "G": 1.1, "B": 1})
    hdr(here / "far.hdr", 64)  # 0.5
    return here


def test_several_tests_make_a_table():
    with folder() as name:
        here = pictures(Path(name))
        lines = done("compare", "reference.exr", "near.exr", "far.hdr", folder=here).out.splitlines()
        assert lines[0] == "against reference.exr, HDR" and len(lines) == 4, lines
        assert lines[1].split()[:2] == ["test", "MSE"], lines
        rows = {row.split()[0]: float(row.split()[1]) for row in lines[2:]}
        assert abs(rows["near.exr"] - 0.01 / 3) < 1e-6 and rows["far.hdr"] == 0.25, rows


def test_several_tests_as_json_are_an_array_and_one_is_an_object():
    with folder() as name:
        here = pictures(Path(name))
        both = done("compare", "reference.exr", "near.exr", "far.hdr", "--json", folder=here).json()
        assert [one["test"] for one in both] == ["near.exr", "far.hdr"]
        alone = done("compare", "reference.exr", "far.hdr", "--json", folder=here).json()
        assert {key: value for key, value in both[1].items() if key != "test"} == alone


def test_limits_hold_for_each_test_and_each_that_misses_is_named():
    with folder() as name:
        here = pictures(Path(name))
        run = kestrel("compare", "reference.exr", "near.exr", "far.hdr", "--max", "mse=0.01", folder=here)
        assert run.status == 1 and run.lines() == ["far.hdr: mse is 0.25, above the maximum 0.01"], run.err
        done("compare", "reference.exr", "near.exr", "far.hdr", "--max", "mse=0.25", folder=here)


def test_heat_maps_of_several_tests_are_named_after_them():
    with folder() as name:
        here = pictures(Path(name))
        done("compare", "reference.exr", "near.exr", "far.hdr", "--heatmap", "flip_{}.png", folder=here)
        assert (here / "flip_near.png").exists() and (here / "flip_far.png").exists()
        refused("compare", "reference.exr", "near.exr", "far.hdr", "--heatmap", "flip.png", folder=here)


def test_what_is_wrong_with_each_test_is_told_at_once_and_the_others_are_measured():
    with folder() as name:
        here = pictures(Path(name))
        run = kestrel("compare", "reference.exr", "gone.exr", "near.exr", "also_gone.exr", "--json", folder=here)
        assert run.status == 2
        assert run.lines() == ["kestrel: gone.exr: no such file", "kestrel: also_gone.exr: no such file"], run.err
        assert [one["test"] for one in run.json()] == ["near.exr"]


def test_a_layer_is_named_behind_a_colon():
    with folder() as name:
        here = pictures(Path(name))
        exr(here / "layers.exr", {f"{layer}.{c}": value for layer, value in (("diffuse", 0.5), ("glossy", 1))
                                  for c in "RGB"})
        lines = refused("compare", "reference.exr", "layers.exr", folder=here)
        assert lines == ["kestrel: layers.exr: has several layers: 'diffuse', 'glossy'; name one as in "
                         "'layers.exr:diffuse'"], lines
        done("compare", "reference.exr", "layers.exr:glossy", "--max", "mse=0", folder=here)
        done("compare", "reference.exr:G", "layers.exr:glossy.G", "--max", "mse=0", folder=here)
        # A file whose own name has a colon.
        exr(here / "layers.exr:copy", {"R": 1, "G": 1, "B": 1})
        done("compare", "reference.exr", "layers.exr:copy", "--max", "mse=0", folder=here)
        lines = refused("compare", "reference.exr", "layers.exr:glosy", folder=here)
        assert "did you mean 'glossy'" in lines[0], lines


def test_pictures_are_told_by_their_bytes():
    with folder() as name:
        here = pictures(Path(name))
        (here / "reference").write_bytes((here / "reference.exr").read_bytes())
        (here / "far.pic").write_bytes((here / "far.hdr").read_bytes())
        done("compare", "reference", "reference.exr", "--max", "mse=0", folder=here)
        done("compare", "far.hdr", "far.pic", "--max", "mse=0", folder=here)
        (here / "photo.png").write_bytes(b"\xff\xd8\xff\xe0 JFIF")
        assert refused("compare", "photo.png", "photo.png", folder=here) == \
            ["kestrel: photo.png: is a JPEG picture; PNG, HDR and EXR are read"]


def test_exposures_of_radiance_pictures_are_divided_out_and_told():
    with folder() as name:
        here = pictures(Path(name))
        hdr(here / "bright.hdr", 128, 130, "EXPOSURE=4\n", f"+X {WIDTH} -Y {HEIGHT}")  # 2 / 4
        run = kestrel("compare", "far.hdr", "bright.hdr", "--max", "mse=0", "--json", folder=here)
        assert run.status == 0 and "bright.hdr: divided by the exposure" in run.err, run.err
        assert json.loads(run.out)["mse"] == 0
        done("--quiet", "compare", "far.hdr", "bright.hdr", "--max", "mse=0", folder=here)


if __name__ == "__main__":
    run_tests(globals())
