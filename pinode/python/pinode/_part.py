"""Tables of a case, and conversion of values for their keys."""

from __future__ import annotations

import numbers
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from ._arrays import as_array, plain
from ._pinode import Error

ArrayLike = Any  # of numbers: a NumPy array, or what becomes one


class Part(dict):
    """A table of a case."""

    def __init__(self, **keys: Any) -> None:
        super().__init__((k, v) for k, v in keys.items() if v is not None)

    def __repr__(self) -> str:
        words = []
        for key, value in self.items():
            shape = getattr(value, "shape", None)
            if shape is not None and shape != ():
                text = "array of " + " x ".join(str(n) for n in shape)
            else:
                text = repr(value)
            words.append(f"{key}={text if len(text) < 60 else '...'}")
        return f"{type(self).__name__}({', '.join(words)})"


def counted(count: int, word: str) -> str:
    """Returns "1 record" or "2 records"."""
    return f"{count} {word}" + ("" if count == 1 else "s")


def as_matrix(value: Any) -> Any:
    """Returns lists of numbers, lists of rows, and columns and frames of pandas as an
    array. Other values are unchanged.
    """
    is_list = isinstance(value, (list, tuple))
    if not is_list and not hasattr(value, "to_numpy"):
        return value
    try:
        array = as_array(value)
    except (TypeError, ValueError):
        return value
    # Others are refused by name when the case is made.
    if not is_list:
        return array
    return array.astype(float) if array.dtype.kind in "biuf" else value


def as_list(values: Any) -> Any:
    """An array as a list."""
    values = as_array(values) if hasattr(values, "to_numpy") else plain(values)
    return values.tolist() if hasattr(values, "tolist") else values


def as_sequence(name: str, values: Any) -> list[Any]:
    """Checks that an argument is a list and returns its values."""
    if not isinstance(values, (str, bytes)) and hasattr(values, "__iter__"):
        try:
            return list(values)
        except TypeError:  # such as an array of no dimension
            pass
    raise Error(f"{name} is a value of type {type(values).__name__}, expected a list")


def as_names(name: str, names: Any) -> Any:
    """Returns names as as_strings does, for arguments that cannot be the name of a
    file.
    """
    if isinstance(names, str):
        raise Error(f"{name} is the text '{names:.40}', expected a list of names")
    return as_strings(name, names)


def as_mapping(name: str, values: Any) -> dict[str, Any]:
    """Checks that an argument is a dictionary and returns it."""
    if not isinstance(values, Mapping):
        raise Error(f"{name} is a value of type {type(values).__name__}, expected a dictionary")
    return dict(values)


def as_strings(name: str, names: Any) -> Any:
    """Returns NumPy's texts as Python's own. Whole numbers are names too."""
    if names is None or isinstance(names, str):
        return names
    return [str(n) if isinstance(n, (np.str_, int, np.integer)) and not isinstance(n, bool) else n
            for n in as_sequence(name, names)]


def as_text(name: str, value: Any) -> str:
    """Checks that an argument is a text and returns it."""
    if not isinstance(value, str):
        raise Error(f"{name} is a value of type {type(value).__name__}, expected a text")
    return value


def as_number(name: str, value: Any) -> float:
    """Checks that an argument is a number and returns it."""
    if not isinstance(value, numbers.Real) or isinstance(value, bool):
        raise Error(f"{name} is a value of type {type(value).__name__}, expected a number")
    try:
        return float(value)
    except OverflowError:
        raise Error(f"{name} is too large for a float, expected a smaller number") from None


def as_flag(name: str, value: Any) -> bool:
    """Checks that an argument is True or False and returns it."""
    is_one = isinstance(value, (bool, np.bool_)) or (isinstance(value, int) and value in (0, 1))
    if not is_one:
        raise Error(f"{name} is a value of type {type(value).__name__}, expected True or False")
    return bool(value)


def as_path(name: str, path: Any) -> str:
    """Checks that an argument is a path and returns its text."""
    try:
        text = os.fspath(path)
    except TypeError:
        text = None
    if not isinstance(text, str):
        raise Error(f"{name} is a value of type {type(path).__name__}, expected a path")
    try:
        if b"\0" not in os.fsencode(text):
            return text
    except UnicodeEncodeError:
        pass
    raise Error(f"{name} is {text!r:.60}, expected a path that a file can have")


def as_watcher(progress: Any, callback: Any) -> tuple[Any, Any]:
    """Checks the arguments `progress` and `callback` of a fit."""
    if callback is not None and not callable(callback):
        raise Error(f"callback is a value of type {type(callback).__name__}, expected a function")
    return None if progress is None else as_flag("progress", progress), callback


def as_folder(output: Any, mat: bool = False) -> str:
    """Returns the folder `output` of results. "": nothing is written."""
    path = as_path("output", output)
    if as_flag("mat", mat) and not path:
        raise Error(
            "mat=True writes results.mat into the folder of results, expected "
            "output, the path of that folder"
        )
    return path
