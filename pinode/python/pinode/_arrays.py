"""Arrays as others have them, masked ones and those of pandas, as arrays of NumPy with
NaN where an entry is missing.

What is masked has a number below its mask that nobody is to see; NumPy itself
hands that out wherever a plain array is asked for.
"""

from __future__ import annotations

import datetime
import numbers
import re
from typing import Any

import numpy as np

from ._pinode import Error


def plain(values: Any) -> Any:
    """An array with masked entries as one with NaN in their places; any other value
    as it is."""
    if not isinstance(values, np.ma.MaskedArray) or values.dtype.kind == "V":
        return values
    if not values.mask.any():
        return values.data
    # Others cannot be NaN; they are refused by name where numbers are asked for.
    if values.dtype.kind not in "fiu":
        return values.astype(object).filled(None)
    return values.astype(float).filled(np.nan)


def is_frame(values: Any) -> bool:
    """Whether it is a frame of pandas, or of others that look like it."""
    return hasattr(values, "columns") and hasattr(values, "to_numpy")


def as_array(values: Any) -> np.ndarray:
    """`values` as an array, NaN where they are masked or NA, and where they are
    numbers that are kept as objects. Raises what NumPy raises for what is no array."""
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
    """The columns of a frame, of those too that are called alike."""
    if hasattr(frame, "iloc"):
        return [frame.iloc[:, place] for place in range(len(frame.columns))]
    return [frame[name] for name in frame.columns]


def _of_series(values: Any) -> np.ndarray:
    kind = getattr(values.dtype, "kind", "")
    # Of pandas' own types, which become objects by themselves.
    if hasattr(values.dtype, "na_value") and kind in ("f", "i", "u"):
        return values.to_numpy(dtype=float, na_value=np.nan)
    if hasattr(values.dtype, "tz"):
        return values.to_numpy(dtype="datetime64[ns]")
    return values.to_numpy()


def _numbers(array: np.ndarray) -> np.ndarray:
    """Objects as numbers, where all of them are some or missing."""
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
    """Of a square matrix in a text file, as its first line says; 0: it does not."""
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
    """Of dates those since the first of them, of differences of time those that they
    are; None of what is neither. `where`: for messages."""
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
            raise Error(f"{where} has texts, expected seconds, or dates as pandas.to_datetime has "
                        "them")
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
        raise Error(f"{where} has no time at all, expected one for each sample")
    # Differences may begin anywhere.
    since = values - there[0] if values.dtype.kind == "M" else values
    return since / np.timedelta64(1, "s")
