"""A class for each type of pass, made of the table of pass types: `passes.Roma`, its properties as attributes."""
from __future__ import annotations

import json

from . import _kestrel, table
from .graph import Pass

TABLE: dict[str, dict] = {info["name"]: info for info in json.loads(_kestrel.pass_types())["passes"]}
__all__ = sorted(TABLE)


def _attribute(info: dict) -> property:
    name = info["name"]
    return property(lambda self: self._graph._document.get(self.name, name),
                    lambda self, value: self._graph._document.set_property(self.name, name, value),
                    lambda self: self._graph._document.reset(self.name, name), table.property_doc(info))


def _made(info: dict) -> type[Pass]:
    members = {entry["name"]: _attribute(entry) for entry in info["properties"]}
    members |= {"__doc__": table.type_doc(info), "__module__": __name__, "__slots__": (),
                "__annotations__": {entry["name"]: table.annotation(entry) for entry in info["properties"]}}
    return type(info["name"], (Pass,), members)


for _info in TABLE.values():
    globals()[_info["name"]] = _made(_info)
