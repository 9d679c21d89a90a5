"""Tables of a case, and its purpose.

The purpose is "check" (also for fits) if responses are given, else a simulation or
the planning of sensors.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from ._arguments import words_of
from ._columns import curves
from ._labels import (
    check_common_order,
    check_names_of_columns,
    check_places,
    default_names,
    names_of_values,
)
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


def tables_of(parts: Mapping[str, Any], model: Any = None) -> dict[str, Any]:
    """Returns the parts of a case as the tables of a file. `model` is that of the case, if
    the parts have none.
    """
    tables = {KEYS.get(key, key): part for key, part in parts.items()}
    model, groups = tables.get("model", model), tables.get("group")
    if isinstance(model, Mapping) and isinstance(groups, (list, tuple)):
        _check_groups(groups)
        tables["group"] = [_group(f"groups[{i}]", group, model) if isinstance(group, Mapping)
                           else group for i, group in enumerate(groups)]
    if "reference_curve" in tables:
        tables["reference_curve"] = curves(tables["reference_curve"])
    return tables


def check_order(parts: Mapping[str, Any], tables: Mapping[str, Any], dofs: list[str]) -> None:
    """Raises an Error if the frame of a group, or the start of a record, has the DOFs of the
    case in another order. `tables` are those of `parts`.
    """
    groups = parts.get("groups", parts.get("group")) or ()
    for i, (group, table) in enumerate(zip(groups, tables.get("group") or ())):
        if "matrix" in table:
            check_names_of_columns(f"groups[{i}]: matrix", getattr(group, "columns", None), dofs)
    for record in tables.get("record") or ():
        _check_start(record, dofs)


def _group(where: str, group: Mapping[str, Any], model: Mapping[str, Any]) -> Mapping[str, Any]:
    """Returns the table of a group. A matrix over all DOFs of a finite-element model is
    reduced as the model is: it is the key `set_export`.
    """
    export = _export(model)
    shape = getattr(group.get("matrix"), "shape", None)
    exported = _exported(export)
    is_whole = shape is not None and (
        shape == getattr(export.get("mass"), "shape", None)
        or (exported is not None and shape == (len(exported), len(exported))))
    _check_columns(where, group, model, is_whole)
    if not is_whole or not (model.get("reduction") or export.get("remove_dofs")):
        return group
    return {"set_export" if key == "matrix" else key: value for key, value in group.items()}


def _check_groups(groups: Sequence[Any]) -> None:
    """Raises an Error if the frames of two groups have the same columns in another order."""
    first: dict[int, tuple[str, list[str]]] = {}  # by size: a reduction may turn its DOFs over
    for i, group in enumerate(groups):
        columns = getattr(group, "columns", None)
        if columns is not None:
            other, names = first.setdefault(len(columns), (f"groups[{i}]", columns))
            check_common_order(f"groups[{i}]: matrix", columns, names, other)


def _check_columns(where: str, group: Mapping[str, Any], model: Mapping[str, Any],
                   is_whole: bool) -> None:
    """Raises an Error if the frame of a group names the DOFs in another order than the
    model does.
    """
    export = _export(model)
    columns = getattr(group, "columns", None)
    of_model = getattr(model, "columns", None)
    if is_whole or not export:
        check_names_of_columns(f"{where}: matrix", columns,
                               _exported(export) if is_whole else _dofs_of(model), of_model)
    else:
        # With a reduction they are compared when its DOFs are known.
        check_names_of_columns(f"{where}: matrix", columns, _dofs_of(model))
    for key in ("changed_export", "set_export"):
        check_names_of_columns(f"{where}: {key}", getattr(group, f"columns_of_{key}", None),
                               _exported(export), of_model)


def _dofs_of(model: Mapping[str, Any]) -> list[str] | None:
    """Returns the DOFs of a model. None: they are not known before the case is made."""
    export, building = _export(model), model.get("shear_building")
    if export:
        dofs = _exported(export)
        if dofs is None or model.get("reduction"):
            return None
        removed = export.get("remove_dofs") or ()
        return [dof for dof in dofs if dof not in removed]
    dofs = model.get("dofs")
    if isinstance(dofs, (list, tuple)):
        return list(dofs)
    masses = building.get("masses") if isinstance(building, Mapping) else None
    return default_names(len(masses)) if isinstance(masses, (list, tuple)) else None


def _export(model: Mapping[str, Any]) -> Mapping[str, Any]:
    export = model.get("finite_element")
    return export if isinstance(export, Mapping) else {}


def _exported(export: Mapping[str, Any]) -> list[str] | None:
    """Returns all DOFs of a finite-element model. None: they are in a file."""
    dofs, shape = export.get("dofs"), getattr(export.get("mass"), "shape", ())
    if dofs is None and len(shape) == 2:
        return default_names(shape[0])
    return list(dofs) if isinstance(dofs, (list, tuple)) else None


def _check_start(record: Any, dofs: list[str] | None) -> None:
    """Raises an Error if columns of pandas start a record in another order than the DOFs."""
    start = record.get("start") if isinstance(record, Mapping) else None
    for key, values in start.items() if isinstance(start, Mapping) else ():
        check_places(f"record '{record.get('name')}': start[{key!r:.40}]", names_of_values(values),
                     dofs)


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
