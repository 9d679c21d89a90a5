"""Table in place of a record's file: arrays, and columns of frames."""

from __future__ import annotations

import difflib
import numbers
from collections.abc import Mapping
from typing import Any

import numpy as np

from ._arguments import words_of
from ._arrays import columns_of, is_frame, seconds_of
from ._part import as_matrix
from ._pinode import Error


class Columns:
    """Source of a record's signals.

    `file` is a path, a frame or a dictionary. From a frame or a dictionary the used
    columns are taken. Other columns with numbers are taken too, because a case may
    name them elsewhere.
    """

    def __init__(self, record: str, file: Any) -> None:
        self._record = f"record '{record}'"
        self._path = file if _is_path(file) else None
        self._frame = None if _is_path(file) else _Frame(self._record, file)
        self._columns: dict[str, Any] = {}
        self._time: str | None = None
        # True if its times were dates, which are seconds now.
        self.has_dates = False

    def file(self) -> Any:
        """Value of the key `file` of the record. None: there is none."""
        if self._path is not None:
            return self._path
        if self._frame is None:
            return self._columns or None
        return {**self._frame.others(self._columns), **self._columns} or None

    def time(self, given: Any) -> str | None:
        """Returns the column of the time. `given` is its name, or times in seconds."""
        if given is None or isinstance(given, str):
            self._time = given
            if given is not None and self._frame is not None:
                self._columns[given] = self._times(f"column '{given}'", self._frame.column(given))
            return given
        if self._path is not None:
            raise Error(
                f"{self._record}: 'time' is an array, but the record has a file; expected the "
                "name of a column"
            )
        self._time = self._free_name("t")
        times = self._times("time", as_matrix(given))
        is_array = isinstance(times, np.ndarray)
        if isinstance(times, (list, bytes, Mapping)) or not hasattr(times, "__iter__") or (
                is_array and (times.ndim != 1 or times.dtype.kind not in "biuf")):
            raise Error(f"{self._record}: time is {words_of(given)}, expected a one-dimensional "
                        "array of numbers or dates")
        self._columns[self._time] = times
        return self._time

    def signal(self, value: Any, name: str, table: dict[str, Any]) -> dict[str, Any]:
        """Returns the table of an input or a channel.

        `value` is its values, or a dictionary with them. `name` is the column that
        its array becomes.
        """
        keys = dict(value) if isinstance(value, Mapping) else {"values": value}
        values, file = keys.pop("values", None), keys.get("file")
        is_covariate = "name" in table
        in_memory = self._path is None
        if isinstance(values, str):
            keys["column"] = values
        elif is_covariate and isinstance(values, numbers.Real):
            keys["value"] = float(values)
        elif values is not None:
            if file is not None:
                raise Error(
                    f"{self._record}: '{name}' has both an array and a file; expected an array or "
                    "the name of a column of the file"
                )
            keys.update(self._array(name, as_matrix(values), keys.pop("time", None)))
            in_memory = True
        column = keys.get("column")
        if file is not None and not _is_path(file):
            keys["file"] = self._table(_Frame(f"{self._record}, '{name}'", file), column)
            in_memory = True
        elif file is None and self._frame is not None and isinstance(column, str):
            if column not in self._columns:
                self._columns[column] = self._frame.column(column)
        # A covariate is a number of any kind, and files of PEER have their unit.
        if in_memory and not is_covariate and not str(file).lower().endswith(".at2"):
            keys.setdefault("unit", "model")
        return {**table, **keys}

    def _array(self, name: str, values: Any, time: Any) -> dict[str, Any]:
        """Returns the keys of an array: a column of the record's table, or of a table
        of its own if it has its own times or the record has a file.
        """
        if time is None and self._path is None:
            column = self._free_name(name)
            self._columns[column] = values
            return {"column": column}
        if (time is None) != (self._time is None):
            raise Error(
                f"{self._record}: '{name}' has a 'time', but the record has a 'step'; leave out "
                "one of them, or give the record the 'time'"
                if self._time is None else
                f"{self._record}: '{name}' is an array without times, but the file has a column of "
                "the time; expected {'values': ..., 'time': seconds}, or the record's 'step' "
                "instead of that column"
            )
        if time is None:
            return {"column": name, "file": {name: values}}
        column = name if name != self._time else name + "_"
        times = self._times(f"time of '{name}'", as_matrix(time))
        return {"column": column, "file": {self._time: times, column: values}}

    def _table(self, frame: "_Frame", column: Any) -> dict[str, Any]:
        """Returns the used columns of a signal's own frame."""
        used = {}
        if self._time is not None:
            used[self._time] = self._times(f"column '{self._time}'", frame.column(self._time))
        if isinstance(column, str):
            used[column] = frame.column(column)
        return used or frame.others({})

    def _times(self, where: str, values: Any) -> Any:
        seconds = seconds_of(f"{self._record}: {where}", values)
        self.has_dates = self.has_dates or seconds is not None
        return values if seconds is None else seconds

    def _free_name(self, name: str) -> str:
        """Returns `name`, or a similar one if another column has this name."""
        while name in self._columns or (self._frame is not None and name in self._frame):
            name += "_"
        return name


def curves(given: Any) -> Any:
    """Returns the reference curves of a case, with arrays in a table in place of a
    file.
    """
    if not isinstance(given, (list, tuple)):
        return given
    return [_curve(f"reference_curves[{i}]", curve) for i, curve in enumerate(given)]


def _curve(where: str, curve: Any) -> Any:
    if not isinstance(curve, Mapping):
        return curve
    keys, names, arrays = dict(curve), ("deformation", "force"), {}
    if is_frame(keys.get("file")) or isinstance(keys.get("file"), Mapping):
        frame = _Frame(where, keys["file"])
        columns = [keys.get(name, name) for name in names]
        arrays = {c: frame.column(c) for c in columns if isinstance(c, str)}
    elif "file" not in keys:
        arrays = {name: as_matrix(keys.pop(name)) for name in names
                  if name in keys and not isinstance(keys[name], str)}
    return {**keys, "file": arrays} if arrays else keys


class _Frame:
    """Columns by name, of a frame with the names of its index, or of a dictionary."""

    def __init__(self, where: str, columns: Any) -> None:
        self._where = where
        self._is_frame = is_frame(columns)
        self._columns: dict[Any, Any] = {}
        self._index: dict[str, Any] = {}
        self._twice: set[str] = set()
        if not self._is_frame:
            self._columns = dict(columns)
            return
        for name, column in zip(columns.columns, columns_of(columns)):
            if str(name) in self._columns:
                self._twice.add(str(name))
            self._columns[str(name)] = column
        index = getattr(columns, "index", None)
        for level, name in enumerate(getattr(index, "names", ())):
            if name is not None:
                self._index[str(name)] = index.get_level_values(level)

    def __contains__(self, name: str) -> bool:
        return name in self._columns or name in self._index

    def column(self, name: str) -> Any:
        """Returns the numbers of a column. If they are not numbers, the case refuses
        them by name.
        """
        if name in self._twice:
            raise Error(f"{self._where}: several columns are called '{name}', expected one")
        for columns in (self._columns, self._index):
            if name in columns:
                return as_matrix(columns[name])
        names = [n for n in (*self._columns, *self._index) if isinstance(n, str)]
        near = difflib.get_close_matches(name, names, 1)
        hint = f"did you mean '{near[0]}'?" if near else f"expected one of {', '.join(names[:8])}"
        raise Error(f"{self._where}: there is no column '{name}'; {hint}")

    def others(self, used: Mapping[str, Any]) -> dict[Any, Any]:
        """Returns the columns of numbers that are not used. For a dictionary without
        used columns it returns all.
        """
        found = {}
        for name, values in self._columns.items():
            if name in used or name in self._twice:
                continue
            array = as_matrix(values)
            is_column = isinstance(array, np.ndarray) and array.ndim == 1
            if (is_column and array.dtype.kind in "fiu") or not (self._is_frame or used):
                found[name] = array
        return found


def _is_path(file: Any) -> bool:
    return not is_frame(file) and not isinstance(file, Mapping)
