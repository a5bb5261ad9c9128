#!/usr/bin/env python3
"""Kestrel's references against a second tracer: Cycles, of Debian's package `blender` (with python3-numpy).

    tests/external/cycles.py [--samples N] [--out FOLDER] [QUANTITY...]

Renders each quantity by Kestrel and by Cycles from the same camera, one ray through the middle of each of 160x90 pixels, and
prints: the ratio of the means (Kestrel over Cycles), the root mean square error over the mean, both over pixels with geometry; of
the pictures, and of means over 10x10 pixels, in which noise has gone. `--store` writes the
means of Cycles to tests/golden/cycles.json, which test_shipped_gl holds Kestrel against wherever it is built. What is rendered
stands in that file: scene, camera, lights, graph. KESTREL names the program (build/bin/kestrel). Not part of the tests that
run everywhere.
"""
import argparse
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import zlib
from array import array
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KESTREL = Path(os.environ.get("KESTREL", ROOT / "build/bin/kestrel")).resolve()
STORED = ROOT / "tests/golden/cycles.json"
SIZE, BLOCK = (160, 90), 10


def run(*command):
    # Blender takes the modules of the python3 that it finds first: Debian's, beside it.
    environment = dict(os.environ, PATH="/usr/bin:/bin") if command[0] == "blender" else None
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, env=environment)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


# ---- Scenes without cameras, lights and emission: what shines is added to both alike.

def without_lights(glb):
    data = glb.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20:20 + length])
    document.pop("cameras", None)
    document.get("extensions", {}).pop("KHR_lights_punctual", None)
    for node in document["nodes"]:
        node.pop("camera", None)
        node.pop("extras", None)
        node.get("extensions", {}).pop("KHR_lights_punctual", None)
    for material in document.get("materials", []):
        material.pop("emissiveFactor", None)
        material.pop("emissiveTexture", None)
        material.pop("extensions", None)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length:]
    glb.write_bytes(struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest)


def scene_file(source, folder):
    glb = folder / (source.replace(":", "_").replace("?", "_").replace("=", "_") + ".glb")
    if source.startswith("builtin:"):
        if not glb.exists():
            run(KESTREL, "-q", "scene", "export", source, glb)
            without_lights(glb)
        return glb
    return STORED.parent / source


# ---- Pictures

def kestrel_picture(row, scene, folder, port, samples):
    """Linear values, three a pixel, rows from the top."""
    file = folder / "kestrel.exr"
    command = [KESTREL, "-q", "render", ROOT / "graphs" / row["graph"], "-s", scene, "--size", "%dx%d" % SIZE,
               "--camera", json.dumps(row["camera"]), "--output", f"{port}={file}"]
    for light in row.get("lights", []):
        command += ["--light", json.dumps(light)]
    for setting in row.get("set", []):
        command += ["--set", setting.replace("SAMPLES", str(samples))]
    run(*command)
    return exr(file)


def exr(file):
    """What Kestrel writes: lines without compression, or zip; three or one 32-bit channels."""
    code = (
        "import bpy, numpy, sys\n"
        f"image = bpy.data.images.load({str(file)!r}); image.colorspace_settings.name = 'Non-Color'\n"
        "w, h = image.size; pixels = numpy.empty(w * h * 4, numpy.float32); image.pixels.foreach_get(pixels)\n"
        f"pixels.reshape(h, w, 4)[::-1, :, :3].tofile({str(file)!r} + '.raw')\n"
    )
    run("blender", "-b", "--factory-startup", "--python-expr", code)
    return raw(Path(str(file) + ".raw"))


def raw(file):
    values = array("f")
    values.frombytes(file.read_bytes())
    return values


def write_png(file, values):
    width, height = SIZE
    code = bytes(round(255 * min(1, math.sqrt(max(0, v)))) for v in values)
    rows = b"".join(b"\0" + code[3 * width * y:3 * width * (y + 1)] for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                     chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


# ---- Figures

def means_of_blocks(values, mask):
    """Luminance-free: red, green and blue of blocks of pixels, None where less than half of a block has geometry."""
    width, height = SIZE
    means = []
    for top in range(0, height, BLOCK):
        for left in range(0, width, BLOCK):
            inside = [y * width + x for y in range(top, top + BLOCK) for x in range(left, left + BLOCK) if mask[y * width + x] > 0]
            enough = 2 * len(inside) >= BLOCK * BLOCK
            means.append([sum(values[3 * i + k] for i in inside) / len(inside) for k in range(3)] if enough else None)
    return means


def compared(ours, theirs):
    """Ratio of means, root mean square difference over the mean."""
    mean = sum(theirs) / len(theirs)
    square = sum((a - b) ** 2 for a, b in zip(ours, theirs)) / len(theirs)
    return sum(ours) / len(ours) / mean if mean else math.inf, math.sqrt(square) / mean if mean else math.inf


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("quantity", nargs="*", help="by name; all, if none is given")
    parser.add_argument("--samples", type=int, default=1024, help="a pixel, of both tracers")
    parser.add_argument("--out", type=Path, help="keep the pictures there, as PNG of the square root of the light")
    parser.add_argument("--store", action="store_true", help="write the figures of Cycles to tests/golden/cycles.json")
    arguments = parser.parse_args()
    document = json.loads(STORED.read_text())
    rows = [row for row in document["rows"] if not arguments.quantity or row["name"] in arguments.quantity]
    if not rows:
        sys.exit("cycles.py: no such quantity; there are " + ", ".join(row["name"] for row in document["rows"]))
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        job = [dict(row["cycles"], name=row["name"], size=SIZE, samples=arguments.samples, camera=row["camera"],
                    lights=row.get("lights", []), file=str(scene_file(row["scene"], folder)),
                    out=str(folder / f"{i}.raw")) for i, row in enumerate(rows)]
        (folder / "job.json").write_text(json.dumps(job))
        log = run("blender", "-b", "--factory-startup", "-P", Path(__file__).with_name("cycles_render.py"), "--", folder / "job.json")
        document["by"] = "Cycles of " + next(line for line in log.splitlines() if line.startswith("Blender "))
        print(f"{document['by']}, {arguments.samples} samples a pixel\n")
        print("| quantity | scene | ratio of means | RMSE over the mean | RMSE of 10x10 pixels |\n|---|---|---|---|---|")
        for row, picture in zip(rows, job):
            if not Path(picture["out"]).exists():
                sys.exit(f"{row['name']}: Blender wrote nothing\n{log[-3000:]}")
            scene = Path(picture["file"])
            ours = kestrel_picture(row, scene, folder, row["port"], arguments.samples)
            mask = kestrel_picture(dict(row, set=["reference.samples=2"], graph="reference_ao.json"), scene, folder, row.get("mask", "gbuffer.coverage"), 2)
            mask = mask[1 if "mask" in row else 0::3]  # of the material: what is metallic
            theirs = raw(Path(picture["out"]))
            if arguments.out:
                arguments.out.mkdir(parents=True, exist_ok=True)
                for by, values in ("kestrel", ours), ("cycles", theirs):
                    write_png(arguments.out / f"{row['name'].replace(' ', '_')}_{by}.png", values)
            pixels = [3 * i + k for i in range(SIZE[0] * SIZE[1]) if mask[i] > 0 for k in range(3)]
            ratio, error = compared([ours[i] for i in pixels], [theirs[i] for i in pixels])
            blocks, stored = means_of_blocks(ours, mask), means_of_blocks(theirs, mask)
            _, coarse = compared([v for b in blocks if b for v in b], [v for b in stored if b for v in b])
            print(f"| {row['name']} | `{row['scene']}` | {ratio:.4f} | {error:.4f} | {coarse:.4f} |", flush=True)
            row["blocks"] = [[float(f"{v:.5g}") for v in b] if b else None for b in stored]
    if arguments.store:
        lines = ",\n    ".join(json.dumps(row) for row in document["rows"])
        head = {key: value for key, value in document.items() if key != "rows"}
        STORED.write_text(json.dumps(head)[:-1] + ', "rows": [\n    ' + lines + "\n]}\n")


if __name__ == "__main__":
    main()
