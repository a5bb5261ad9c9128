"""The table of pass types, as `kestrel passes --json` prints it, as Python: annotations, docstrings, stubs.

Run as a program it writes the stubs of kestrel.passes: table.py KESTREL FILE, with the command line's program.
"""
from __future__ import annotations

import json
import subprocess
import sys
import textwrap
from pathlib import Path

KINDS = {"bool": "bool", "int": "int", "float": "float", "text": "str"}


def annotation(info: dict) -> str:
    """The type of a property in Python's words."""
    if info["kind"] == "choice":
        return "Literal[" + ", ".join(json.dumps(choice) for choice in info["choices"]) + "]"
    if info["kind"] == "vector":
        return "tuple[" + ", ".join(["float"] * info["components"]) + "]"
    return KINDS[info["kind"]]


def number(value: float) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def facts(info: dict) -> str:
    """Unit, range, choices and default of a property."""
    told = [info["unit"]] if info.get("unit") else []
    least, most = info.get("minimum"), info.get("maximum")
    if least is not None and most is not None:
        told.append(f"{number(least)} to {number(most)}")
    elif least is not None or most is not None:
        told.append(f"at least {number(least)}" if most is None else f"at most {number(most)}")
    if info["kind"] == "choice":
        told.append(" | ".join(info["choices"]))
    told.append("default " + json.dumps(info["default"]))
    return "; ".join(told)


def property_doc(info: dict) -> str:
    return f"{info['description']} ({facts(info)})."


def type_doc(info: dict) -> str:
    """What a pass is, its ports, and its properties."""
    lines = [info["description"] + "."]
    for title, direction in (("Inputs", "input"), ("Outputs", "output")):
        ports = [port for port in info["ports"] if port["direction"] == direction]
        if ports:
            lines += ["", title + ":"]
            for port in ports:
                note = port["kind"] + (", optional" if port.get("optional") else "")
                lines.append(f"    {port['name']} ({note}): {port['description']}")
    if info["properties"]:
        lines += ["", "Properties:"]
        lines += [f"    {entry['name']}: {property_doc(entry)}" for entry in info["properties"]]
    return "\n".join(lines)


def quoted(text: str, indent: str) -> list[str]:
    body = text.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
    lines = []
    for line in body.splitlines():
        deep = " " * (len(line) - len(line.lstrip()) + 4)
        lines += textwrap.wrap(line, 116 - len(indent), subsequent_indent=deep, break_long_words=False,
                               break_on_hyphens=False, drop_whitespace=True) or [""]
    lines[0] = '"""' + lines[0]
    lines[-1] += '"""'
    return [(indent + line).rstrip() for line in lines]


def stubs(types: list[dict]) -> str:
    """The stubs of kestrel.passes: a class for each type, an attribute for each property."""
    lines = ["# Made of the table of pass types by kestrel/table.py.", "from typing import Literal", "",
             "from .graph import Pass", ""]
    for info in types:
        lines += ["", f"class {info['name']}(Pass):"]
        lines += quoted(type_doc(info), "    ")
        for entry in info["properties"]:
            lines.append(f"    {entry['name']}: {annotation(entry)}")
            lines += quoted(property_doc(entry), "    ")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    _, program, file = sys.argv
    told = subprocess.run([program, "passes", "--json"], stdout=subprocess.PIPE, check=True).stdout
    Path(file).write_text(stubs(json.loads(told)["passes"]), encoding="utf-8")
