"""Names that frames and columns of pandas give to degrees of freedom.

NumPy takes such values by position. Their names are compared with the DOFs, because
a wrong order is seen nowhere else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ._arrays import is_frame
from ._part import as_names
from ._pinode import Error


def is_series(values: Any) -> bool:
    """True for a column of pandas."""
    return not is_frame(values) and (
        hasattr(values, "to_numpy") and hasattr(values, "index") and hasattr(values, "dtype"))


def are_numbered(labels: Sequence[Any]) -> bool:
    """True for 0, 1, 2, ...: the labels of pandas for rows and columns without names."""
    return all(_is_whole(label) and label == i for i, label in enumerate(labels))


def are_whole(labels: Sequence[Any]) -> bool:
    """True if all labels are whole numbers."""
    return all(map(_is_whole, labels))


def names_of(where: str, labels: Any, remedy: str) -> list[str] | None:
    """Returns labels of rows or columns as names of DOFs. None: they are unnamed, or
    there are none. `remedy` ends the message on labels that are no names.
    """
    found = [] if labels is None else list(labels)
    if are_numbered(found):
        return None
    for label in found:
        if not _is_whole(label) and not isinstance(label, str):
            raise Error(f"{where} {label!r:.40}, expected texts or whole numbers, {remedy}")
    return as_names(where, found)


def labels_of(values: Any) -> list[str] | None:
    """Returns the columns of a frame as texts. None: they are 0, 1, 2, ..., or there are none."""
    labels = list(values.columns) if is_frame(values) else []
    return None if are_numbered(labels) else list(map(str, labels))


def names_of_columns(**matrices: Any) -> list[str] | None:
    """Returns the DOFs that frames name by their columns or rows. None: there are no such
    frames.
    """
    found: dict[str, list[str]] = {}
    for key, matrix in matrices.items():
        names = _names_of_matrix(key, matrix) if is_frame(matrix) else None
        if names is not None:
            found[key] = names
    for key, names in found.items():
        first = next(iter(found))
        if names != found[first]:
            raise Error(f"{key} has columns of other names than {first}, expected the same, in "
                        "the same order")
    return next(iter(found.values()), None)


def _names_of_matrix(key: str, matrix: Any) -> list[str] | None:
    remedy = f"the names of the DOFs; {key}.to_numpy() has none"
    labels = list(matrix.columns)
    index = list(getattr(matrix, "index", ()))  # frames of other packages have none
    columns = names_of(f"{key} has the column", labels, remedy)
    rows = names_of(f"{key} has the row", index, remedy)
    if rows is None and columns is not None and are_whole(labels):
        # A numbered index is unnamed, but not beside the same numbers in another order.
        rows = list(map(str, index)) if set(labels) == set(index) else None
    if columns is None and rows is not None and are_whole(index):
        columns = list(map(str, labels))
    if None not in (columns, rows) and columns != rows:
        raise Error(f"{key} has rows and columns of different names, expected the same, in "
                    "the same order")
    return rows if columns is None else columns


def names_of_values(values: Any) -> list[str] | None:
    """Returns the names in the index of a column of pandas. None: it has none."""
    labels = list(values.index) if is_series(values) else []
    is_named = all(_is_whole(label) or isinstance(label, str) for label in labels)
    return as_names("index", labels) if is_named and not are_numbered(labels) else None


def check_names_of_columns(where: str, columns: list[str] | None, dofs: Any,
                           of_model: list[str] | None = None) -> None:
    """Raises an Error if the columns of a frame name the DOFs in another order, or only
    some of them. `of_model`: names of the columns of the model's matrices, if the
    model has other DOFs.
    """
    if columns is None:
        return
    for known in (dofs, of_model):
        if not isinstance(known, (list, tuple)) or list(known) == columns:
            continue
        if set(columns) & set(known):
            raise Error(f"{where} has the columns {', '.join(columns):.60}, expected the DOFs of "
                        f"the model in their order: {', '.join(map(str, known)):.60}")


def check_common_order(where: str, columns: list[str] | None, known: list[str] | None,
                       other: str = "the model") -> None:
    """Raises an Error if two lists have the names that they share in another order."""
    if columns is None or known is None:
        return
    shared = [name for name in known if name in columns]
    if shared != [name for name in columns if name in known]:
        raise Error(f"{where} has the columns {', '.join(columns):.60}, expected the order that "
                    f"{other} has: {', '.join(shared):.60}")


def check_places(where: str, names: list[str] | None, dofs: Any, argument: str = "dofs") -> None:
    """Raises an Error if a name is one of `dofs`, but of another place."""
    dofs = dofs.tolist() if hasattr(dofs, "tolist") else dofs
    if names is None or not isinstance(dofs, (list, tuple)):
        return
    dofs = as_names(argument, dofs)
    for i, name in enumerate(names):
        if name in dofs and not (i < len(dofs) and dofs[i] == name):
            other = f"{argument}[{i}] is {dofs[i]!r:.40}" if i < len(dofs) else (
                f"{argument} has {len(dofs)} names")
            raise Error(f"{where} has {name!r:.40} at place {i}, but {other}, expected the same "
                        "order; to_numpy() takes values by their places")


def default_names(count: int) -> list[str]:
    """Returns the DOFs of a model that names none."""
    return [f"u{i + 1}" for i in range(count)]


def check_floors(dofs: Any, influence: Any, **columns: Any) -> None:
    """Raises an Error if columns of pandas, a value per floor, have other places than the
    floors, or than one another.
    """
    first: tuple[str, list[str]] | None = None
    for key, values in columns.items():
        names = names_of_values(values)
        check_places(f"ShearBuilding: {key}", names, dofs)
        if first is not None:
            check_places(f"ShearBuilding: {key}", names or _numbers_of(values), first[1], first[0])
        elif is_series(values):
            first = (key, names or _numbers_of(values))
    check_influence("ShearBuilding", influence, dofs)


def _numbers_of(values: Any) -> list[str] | None:
    return list(map(str, values.index)) if is_series(values) else None


def check_influence(where: str, influence: Any, dofs: Any) -> None:
    """Raises an Error if columns of pandas have other places than the DOFs."""
    for direction, values in influence.items() if isinstance(influence, Mapping) else ():
        place = f"{where}: influence[{direction!r:.40}]"
        check_places(place, names_of_values(values), dofs)


def check_rows(where: str, values: Mapping[str, Any]) -> None:
    """Raises an Error if frames or columns of pandas, one row a sample, have other rows than
    one another. Rows 0, 1, 2, ... are unnamed.
    """
    first: tuple[str, Any] | None = None
    for name, value in values.items():
        index = value.index if is_frame(value) and hasattr(value, "index") else (
            value.index if is_series(value) else None)
        if index is None or callable(index) or _is_numbered(index):
            continue
        if first is None:
            first = (name, index)
        elif len(index) == len(first[1]) and not _are_close(first[1], index):
            raise Error(f"{where}: {name} has an index that differs from that of {first[0]}, "
                        "expected the same samples; to_numpy() takes values by their places")


def _is_numbered(index: Any) -> bool:
    labels = np.asarray(index)
    return labels.dtype.kind in "iu" and np.array_equal(labels, np.arange(len(labels)))


def _are_close(one: Any, other: Any) -> bool:
    """True if two indexes are the same within half a sample, as clocks of loggers are."""
    if one.equals(other):
        return True
    a, b = _numbers_of_index(one), _numbers_of_index(other)
    if a is None or b is None or a.dtype != b.dtype or len(a) < 2:
        return False
    apart = np.abs(a - b).astype(float)
    return bool(np.all(apart <= 0.5 * float(abs(a[-1] - a[0])) / (len(a) - 1)))


def _numbers_of_index(index: Any) -> np.ndarray | None:
    """Returns an index as float, or dates and spans as int64 in ns."""
    if getattr(index, "tz", None) is not None:
        index = index.tz_convert("UTC").tz_localize(None)
    labels = np.asarray(index)
    if labels.dtype.kind in "iuf":
        return labels.astype(float)
    if labels.dtype.kind in "Mm":
        return labels.astype(f"{labels.dtype.kind}8[ns]").astype(np.int64)
    return None


def _is_whole(label: Any) -> bool:
    return isinstance(label, (int, np.integer)) and not isinstance(label, bool)
