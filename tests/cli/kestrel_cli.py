"""What the command-line tests share: running kestrel, and a folder that goes away."""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

KESTREL = os.environ["KESTREL"]
SOURCE = Path(os.environ["KESTREL_SOURCE"])
RAY_AO = str(SOURCE / "graphs" / "ray_ao.json")
SMALL = ["--scene", "builtin:tower?detail=0.05", "--size", "64x36"]


class Result:
    def __init__(self, run):
        self.status = run.returncode
        self.out = run.stdout
        self.err = run.stderr

    def lines(self):
        return self.err.splitlines()

    def json(self):
        return json.loads(self.out)


def kestrel(*arguments, folder=None, env=None):
    run = subprocess.run([KESTREL, *map(str, arguments)], capture_output=True, text=True, timeout=110,
                         cwd=folder, env={**os.environ, **(env or {})})
    return Result(run)


def done(*arguments, **options):
    """Runs a command that must succeed without a word on standard error."""
    result = kestrel(*arguments, **options)
    assert result.status == 0, f"status {result.status}: {result.err}"
    assert result.err == "", result.err
    return result


def refused(*arguments, status=2, **options):
    """Runs a command that must fail; returns the lines that it says why in."""
    result = kestrel(*arguments, **options)
    assert result.status == status, f"status {result.status}, not {status}: {result.err}"
    for line in result.lines():
        assert line.startswith("kestrel: "), line
    assert result.lines(), "no line on standard error"
    return result.lines()


def shell(command):
    """Runs a line of bash, in which $KESTREL is the program; it must succeed."""
    run = subprocess.run(["bash", "-o", "pipefail", "-c", command], capture_output=True, text=True, timeout=110,
                         env={**os.environ, "KESTREL": KESTREL})
    assert run.returncode == 0, f"status {run.returncode}: {run.stderr}"
    return run


def folder():
    return tempfile.TemporaryDirectory(prefix="kestrel_cli_")


def files_in(path):
    return sorted(str(file.relative_to(path)) for file in Path(path).rglob("*") if file.is_file())


class Skipped(Exception):
    """What a test needs is not here: it says so, and counts as skipped, not as passed."""


def need(there, what):
    if not there:
        raise Skipped(what)


def need_part(name):
    """A part that a build may lack: "embree", "osmesa"."""
    need(name in kestrel("--version").out, f"this build has no {name}")


def run_tests(names):
    """Runs the tests that the command line names, or all. Exit status 77 if one was skipped and none failed."""
    wanted = sys.argv[1:]
    skipped = False
    for name, test in sorted(names.items()):
        if name.startswith("test_") and (not wanted or name in wanted):
            try:
                test()
                print(f"{name}: passed")
            except Skipped as why:
                skipped = True
                print(f"{name}: skipped, {why}")
    sys.exit(77 if skipped else 0)
