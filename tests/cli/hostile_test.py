"""What goes wrong around a run: full disks, signals, plugins that throw. One clear line, the right exit status, and
nothing half written."""
import json
import os
import random
import re
import shlex
import signal
import subprocess
import time
from pathlib import Path

from kestrel_cli import KESTREL, RAY_AO, SMALL, SOURCE, done, files_in, folder, kestrel, need, refused, run_tests

PLUGINS = Path(KESTREL).parent.parent / "test_plugins"
# A sweep of many short parts.
SWEEP = {"kestrel_sweep": 1, "size": [32, 18], "frames": 1, "repeats": 3, "scenes": ["builtin:blob?detail=0.02"],
         "reference": {"graph": "ray_ao.json", "output": "mean.result", "set": ["ao.tracer=bvh.tracer"]},
         "variants": [{"name": "ROMA", "graph": "ray_ao.json", "output": "mean.result",
                       "axes": {"roma.angular": [2, 4, 8]}}]}


def whole(file):
    """Whether a file is what its ending says, from its first byte to its last."""
    data = file.read_bytes()
    if file.suffix == ".png":
        return data.startswith(b"\x89PNG") and data[-8:-4] == b"IEND"
    if file.suffix == ".json":
        return bool(json.loads(data))
    return len(data) > 0


def expect_whole(here):
    """Every file has a name that it was to have, and is whole."""
    for name in files_in(here):
        assert re.search(r"\.(png|json|csv|md|html|exr|hits|bin|manifest)$", name), f"{name} was left behind"
        assert whole(Path(here, name)), f"{name} is cut off"


def on_mount(options, command):
    """Runs a line of bash in a folder, called $PWD, on a small file system of its own."""
    may = subprocess.run(["unshare", "-m", "true"], capture_output=True)
    need(may.returncode == 0, "this user may mount nothing")
    with folder() as here:
        line = f"mount -t tmpfs -o {options} none {shlex.quote(here)} && cd {shlex.quote(here)} && {command}"
        return subprocess.run(["unshare", "-m", "bash", "-c", line], capture_output=True, text=True, timeout=110)


def quoted(*arguments):
    return " ".join(shlex.quote(str(argument)) for argument in [KESTREL, *arguments])


def test_a_full_disk_is_one_line_and_leaves_nothing():
    for output in ["--output gbuffer.normal=n.exr", "--out out"]:
        # The picture that was there stays.
        run = on_mount("size=64k", "echo before >ao.png; head -c 60000 /dev/zero >filler; " +
                       quoted("render", RAY_AO, "--scene", "builtin:blob?detail=0.05", "--size", "160x90",
                              "--output", "mean.result=ao.png") + f" {output}; echo $?; find . -type f | sort; cat ao.png")
        lines = run.stderr.splitlines()
        assert len(lines) == 1 and lines[0].endswith("cannot be written: No space left on device"), run.stderr
        assert run.stdout.splitlines()[-4:] == ["2", "./ao.png", "./filler", "before"], run.stdout
    for command in [quoted("render", RAY_AO, *SMALL, "--output", "mean.result=-"), quoted("passes", "--schema")]:
        run = subprocess.run(["bash", "-c", command + " >/dev/full"], capture_output=True, text=True, timeout=60)
        assert run.returncode == 2, run.stderr
        assert len(run.stderr.splitlines()) == 1 and run.stderr.startswith("kestrel: "), run.stderr


def test_a_folder_that_is_only_read_is_told_before_the_first_frame():
    for arguments in [["render", RAY_AO, *SMALL, "--frames", 100_000, "--out", "out"],
                      ["sweep", SOURCE / "graphs" / "sweeps" / "denoising.json", "--out", "out"],
                      ["stress", RAY_AO, *SMALL, "--json", "out/r.json"]]:
        run = on_mount("size=64k,ro", quoted(*arguments))
        assert run.returncode == 2, (arguments, run.stderr)
        lines = run.stderr.splitlines()
        assert len(lines) == 1 and "Read-only file system" in lines[0], run.stderr


def started(*arguments):
    return subprocess.Popen([KESTREL, *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def wait_for(run, there):
    deadline = time.monotonic() + 90
    while not there():
        assert run.poll() is None, run.stderr.read()
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_an_interrupted_run_says_so_and_what_it_has_written_is_whole():
    for kind in [signal.SIGINT, signal.SIGTERM]:
        with folder() as here:
            out = Path(here, "out")
            run = started("render", RAY_AO, *SMALL, "--frames", 100_000, "--every", 1, "--out", out)
            wait_for(run, lambda: len(list(out.glob("*"))) > 2)
            run.send_signal(kind)
            error = run.communicate()[1]
            assert run.returncode == -kind, (run.returncode, error)
            assert error == "kestrel: interrupted; what has been written is whole\n", error
            expect_whole(here)
    with folder() as here:
        file = Path(here, "s.json")
        file.write_text(json.dumps(SWEEP))
        out = Path(here, "out")
        run = started("sweep", file, "--out", out)
        wait_for(run, lambda: list(out.glob("parts/*/*/*.json")))
        run.send_signal(signal.SIGINT)
        run.communicate()
        assert run.returncode == -signal.SIGINT
        expect_whole(here)
        done("sweep", file, "--out", out, "--resume")


def failing(here, kind):
    graph = Path(here, "g.json")
    graph.write_text(json.dumps({"kestrel": 1, "scene": {"source": "builtin:blob?detail=0.02"}, "edges": [],
                                 "passes": {"wrong": {"type": kind, "properties": {"amount": 1}}},
                                 "outputs": ["wrong.result"]}))
    return graph


def test_a_plugin_that_throws_is_one_line_that_names_pass_and_call():
    said = {"ThrowsInConstruction": "pass 'wrong' failed in construction: out of bricks",
            "ThrowsInProperty": "pass 'wrong' failed in a property: not that much",
            "ThrowsInDeclare": "pass 'wrong' failed in declare: nothing to declare",
            "ThrowsInStep": "pass 'wrong' failed in step 'fill': an exception of unknown kind",
            "ThrowsInDestruction": "an exception left a function that must not throw: cannot let go"}
    env = {"KESTREL_PLUGINS": str(PLUGINS / "faults")}
    with folder() as here:
        done("render", failing(here, "Fill"), "--size", "8x8", "--out", f"{here}/good", env=env)
        for kind, message in said.items():
            lines = refused("render", failing(here, kind), "--size", "8x8", "--out", f"{here}/{kind}", env=env)
            assert len(lines) == 1 and message in lines[0], (kind, lines)
        expect_whole(f"{here}/ThrowsInDestruction")
        lines = refused("render", failing(here, "BrokenShader"), "--size", "8x8", "--out", f"{here}/shader", env=env)
        assert all("faults/broken.comp:3" in line for line in lines) and "undeclared" in lines[0], lines
        # One that fails to register brings nothing, and the others go on.
        result = kestrel("passes", env={"KESTREL_PLUGINS": str(PLUGINS / "throws")})
        assert result.status == 0 and len(result.lines()) == 1 and "no luck today" in result.err, result.err
        assert files_in(here) == ["ThrowsInDestruction/wrong.result.png", "g.json", "good/wrong.result.png"], files_in(here)


def killed(command, chance, longest):
    run = subprocess.Popen([KESTREL, *map(str, command)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(chance.uniform(0.05, longest))
    run.send_signal(signal.SIGKILL)
    run.wait()


def test_a_render_that_is_killed_leaves_whole_files():
    chance = random.Random(5)
    with folder() as here:
        command = ["render", RAY_AO, *SMALL, "--frames", 40, "--every", 1, "--out", here, "--stats", f"{here}/s.json"]
        held = {}
        for _ in range(20):
            killed(command, chance, 1.5)
            expect_whole(here)
            # The same frames are the same bytes, so that what is there stays what it is.
            for name in files_in(here):
                data = Path(here, name).read_bytes()
                assert name == "s.json" or held.setdefault(name, data) == data, name
        assert held, "it was killed before it had written anything"


def test_a_sweep_that_is_killed_loses_nothing_that_was_finished():
    chance = random.Random(7)
    with folder() as here:
        file = Path(here, "s.json")
        file.write_text(json.dumps(SWEEP))
        out = Path(here, "out")
        kept, wholes = {}, 0
        for _ in range(20):
            killed(["sweep", file, "--out", out, "--resume"], chance, 3)
            expect_whole(here)
            for part, data in kept.items():
                assert part.read_bytes() == data, f"{part} was measured twice"
            kept = {part: part.read_bytes() for part in out.glob("parts/*/*/*.json")}
            if (out / "results.json").exists():
                wholes += 1
                subprocess.run(["rm", "-r", str(out)], check=True)
                kept = {}
        assert kept or wholes, "it was killed before it had measured anything"
        done("sweep", file, "--out", out, "--resume")
        assert len(json.loads((out / "results.json").read_text())["rows"]) == 3
        expect_whole(here)


if __name__ == "__main__":
    run_tests(globals())
