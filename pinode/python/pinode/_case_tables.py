"""Tables of a case, and its purpose.

The purpose is "check" (also for fits) if responses are given, else a simulation or
the planning of sensors.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from ._arguments import words_of
from ._columns import curves
from ._part_checks import check_names_of_columns
from ._pinode import Error

# Keywords of a case, and their tables in a case file.
KEYS = {
    "model": "model",
    "groups": "group",
    "elements": "element",
    "libraries": "library",
    "networks": "network",
    "unknown_forces": "unknown_force",
    "records": "record",
    "modes": "mode",
    "frfs": "frf",
    "reference_curves": "reference_curve",
}


# Keywords that take a list, and what makes an entry.
_LISTS = {
    "groups": "pinode.Group",
    "elements": "pinode.Element",
    "libraries": "pinode.Library",
    "networks": "pinode.Network",
    "unknown_forces": "pinode.UnknownForce",
    "records": "pinode.Record",
    "modes": "pinode.Mode",
    "frfs": "dictionary",
    "reference_curves": "dictionary",
}


def check_parts(parts: Mapping[str, Any]) -> None:
    """Raises an Error if a list of parts is not a list of dictionaries."""
    for key, maker in _LISTS.items():
        part = parts.get(key)
        if isinstance(part, Mapping):
            raise Error(
                f"{key} is a single {type(part).__name__}, expected a list: {key}=[...]"
            )
        if isinstance(part, (list, tuple)) and not part:
            raise Error(
                f"{key} is an empty list, expected at least one entry; otherwise leave out {key}"
            )
        if part is not None and not isinstance(part, (list, tuple)):
            raise Error(f"{key} is {words_of(part)}, expected a list: {key}=[...]")
        for place, entry in enumerate(part or ()):
            if not isinstance(entry, Mapping):
                raise Error(f"{key}[{place}] is {words_of(entry)}, expected a {maker}")


def tables_of(parts: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the parts of a case as the tables of a file."""
    tables = {KEYS.get(key, key): part for key, part in parts.items()}
    if "group" in tables and isinstance(tables.get("model"), Mapping):
        tables["group"] = [_group(f"groups[{i}]", group, tables["model"])
                           for i, group in enumerate(tables["group"])]
    if "reference_curve" in tables:
        tables["reference_curve"] = curves(tables["reference_curve"])
    return tables


def _group(where: str, group: Mapping[str, Any], model: Mapping[str, Any]) -> Mapping[str, Any]:
    """Returns the table of a group. A matrix over all DOFs of a finite-element model is
    reduced as the model is: it is the key `set_export`.
    """
    export = model.get("finite_element") or {}
    check_names_of_columns(f"{where}: matrix", getattr(group, "columns", None),
                           export.get("dofs") if export else model.get("dofs"))
    shape = getattr(group.get("matrix"), "shape", None)
    is_whole = shape is not None and shape == getattr(export.get("mass"), "shape", None)
    if not is_whole or not (model.get("reduction") or export.get("remove_dofs")):
        return group
    return {"set_export" if key == "matrix" else key: value for key, value in group.items()}


def purpose_of(tree: Mapping[str, Any]) -> str:
    """Returns the purpose that the records in these tables can have."""
    given = tree.get("record")
    listed = given if isinstance(given, (list, tuple)) else ()
    records = [r for r in listed
               if isinstance(r, Mapping) and r.get("excitation") != "ambient"]
    simulated = any(is_for_simulation(r) for r in records)
    if any(not _channels(r) for r in records) or (simulated and tree.get("plan") is not None):
        return "planning"
    return "simulation" if simulated else "check"


def is_for_simulation(record: Mapping[str, Any]) -> bool:
    """True if a record has a channel without values."""
    file = record.get("file")
    # A file of PEER has one motion, which needs no name.
    if isinstance(file, (str, os.PathLike)) and str(file).lower().endswith(".at2"):
        return False
    return any(isinstance(c, Mapping) and "column" not in c and "file" not in c
               for c in _channels(record))


def _channels(record: Mapping[str, Any]) -> tuple[Any, ...]:
    channels = record.get("channel") or ()
    return tuple(channels) if isinstance(channels, (list, tuple)) else (channels,)
