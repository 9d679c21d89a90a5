"""Conversion of masked arrays and of pandas to NumPy, with NaN for missing entries.

A masked entry hides a number. NumPy returns this number if a plain array is
requested.
"""

from __future__ import annotations

import datetime
import numbers
import re
from typing import Any

import numpy as np

from ._pinode import Error


def plain(values: Any) -> Any:
    """Returns a masked array as an array with NaN. Other values are unchanged."""
    if not isinstance(values, np.ma.MaskedArray) or values.dtype.kind == "V":
        return values
    if not values.mask.any():
        return values.data
    # Others cannot be NaN; they are refused by name where numbers are asked for.
    if values.dtype.kind not in "fiu":
        return values.astype(object).filled(None)
    return values.astype(float).filled(np.nan)


def is_frame(values: Any) -> bool:
    """True for a frame of pandas, or of a similar package."""
    return hasattr(values, "columns") and hasattr(values, "to_numpy")


def as_array(values: Any) -> np.ndarray:
    """Returns `values` as an array, with NaN for masked and NA entries.

    Numbers that are stored as objects become numbers. Raises NumPy's exception if
    `values` is not an array.
    """
    if isinstance(values, (list, tuple)):
        array = np.asarray([plain(v) for v in values])
    elif is_frame(values):
        columns = [as_array(column) for column in columns_of(values)]
        array = np.column_stack(columns) if columns else np.zeros((len(values), 0))
    elif hasattr(values, "to_numpy"):
        array = _of_series(values)
    else:
        array = np.asarray(plain(values))
    return _numbers(array) if array.dtype.kind == "O" else array


def columns_of(frame: Any) -> list[Any]:
    """Returns the columns of a frame, also those that share a name."""
    if hasattr(frame, "iloc"):
        return [frame.iloc[:, place] for place in range(len(frame.columns))]
    return [frame[name] for name in frame.columns]


def _of_series(values: Any) -> np.ndarray:
    kind = getattr(values.dtype, "kind", "")
    # Types of pandas, which become objects in NumPy.
    if hasattr(values.dtype, "na_value") and kind in ("f", "i", "u"):
        return values.to_numpy(dtype=float, na_value=np.nan)
    if hasattr(values.dtype, "tz"):
        return values.to_numpy(dtype="datetime64[ns]")
    return values.to_numpy()


def _numbers(array: np.ndarray) -> np.ndarray:
    """Returns objects as numbers if all of them are numbers or missing."""
    found = np.empty(array.shape)
    for place, value in enumerate(array.ravel()):
        if value is None or type(value).__name__ == "NAType":
            value = np.nan
        if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Number):
            return array
        try:
            found.flat[place] = value
        except (TypeError, ValueError, OverflowError):
            return array
    return found


def rows_of_file(path: str) -> int:
    """Returns the number of rows of a square matrix in a text file, from its first
    line. 0: the line does not state it.
    """
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            line = next((text for text in file if text.strip() and text[0] not in "%#"), "")
        words = [float(word) for word in re.split(r"[,;\s]+", line.strip().strip(",;"))]
    except OSError as failure:
        raise Error(f"{path}: cannot be read: {failure.strerror}") from None
    except ValueError:
        return 0
    if path.lower().endswith(".mtx"):
        return int(words[0])
    return len(words)


def seconds_of(where: str, values: Any) -> np.ndarray | None:
    """Returns dates as seconds since the first one, and time differences as seconds.
    None for other values. `where` is for messages.
    """
    if isinstance(values, (list, tuple)):
        try:
            values = np.asarray(values)
        except (TypeError, ValueError):
            return None
    if not hasattr(values, "dtype") or np.ndim(values) != 1 or not len(values):
        return None
    if values.dtype.kind in "OU":
        known = next((v for v in values if v is not None and v == v), None)
        if isinstance(known, str):
            raise Error(f"{where} contains texts, expected seconds or dates (use "
                        "pandas.to_datetime)")
        kinds = {datetime.datetime: "datetime64[ns]", datetime.timedelta: "timedelta64[ns]"}
        wanted = next((to for kind, to in kinds.items() if isinstance(known, kind)), None)
        if wanted is None:
            return None
        try:
            values = values.astype(wanted)
        except (TypeError, ValueError, OverflowError):
            raise Error(f"{where} has dates that cannot be read, expected seconds") from None
    if values.dtype.kind not in "mM":
        return None
    there = values[~np.isnat(values)]
    if not len(there):
        raise Error(f"{where} contains no time, expected one for each sample")
    # Differences may begin anywhere.
    since = values - there[0] if values.dtype.kind == "M" else values
    return since / np.timedelta64(1, "s")
