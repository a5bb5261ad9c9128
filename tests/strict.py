"""Compiles every C++ file of a compilation database by itself, without making objects, and tells those that do not hold.

    tests/strict.py build-strict/compile_commands.json [FOLDER]...

With folders, relative to the repository: only what lies in them.
"""
import json
import os
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor


def checked(entry):
    """What the compiler says of one file; empty if nothing."""
    command = shlex.split(entry["command"])
    if "-o" in command:
        del command[command.index("-o"):command.index("-o") + 2]
    ran = subprocess.run(command + ["-fsyntax-only"], cwd=entry["directory"], capture_output=True, text=True)
    return ran.stderr if ran.returncode else ""


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        entries = [entry for entry in json.load(file) if entry["file"].endswith(".cpp")]
    root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    folders = tuple(os.path.join(root, folder) + os.sep for folder in sys.argv[2:])
    if folders:
        entries = [entry for entry in entries if os.path.abspath(entry["file"]).startswith(folders)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        failed = 0
        for text in pool.map(checked, entries):
            failed += bool(text)
            print(text, end="", file=sys.stderr, flush=True)
    print(f"{len(entries) - failed} of {len(entries)} files hold by themselves")
    return 1 if failed or not entries else 0


if __name__ == "__main__":
    sys.exit(main())
