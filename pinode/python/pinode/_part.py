"""A table of a case, and values as its keys take them."""

from __future__ import annotations

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


def as_matrix(value: Any) -> Any:
    """Lists of numbers, or of rows of them, as an array, where they are one."""
    if not isinstance(value, (list, tuple)):
        return value
    try:
        array = as_array(value)
    except (TypeError, ValueError):
        return value
    # Others are refused by name when the case is made.
    return array.astype(float) if array.dtype.kind in "biuf" else value


def as_list(values: Any) -> Any:
    """An array as a list."""
    values = plain(values)
    return values.tolist() if hasattr(values, "tolist") else values


def as_sequence(name: str, values: Any) -> list[Any]:
    """The values of an argument that is to be a list."""
    if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__"):
        raise Error(f"{name} is a value of type {type(values).__name__}, expected a list")
    return list(values)


def as_mapping(name: str, values: Any) -> dict[str, Any]:
    """The values of an argument that is to be a dictionary."""
    if not isinstance(values, Mapping):
        raise Error(f"{name} is a value of type {type(values).__name__}, expected a dictionary")
    return dict(values)


def as_strings(name: str, names: Any) -> Any:
    """Names of NumPy as Python's own."""
    if names is None or isinstance(names, str):
        return names
    return [str(n) if isinstance(n, np.str_) else n for n in as_sequence(name, names)]


def as_path(name: str, path: Any) -> str:
    """The text of an argument that is to be a path."""
    try:
        text = os.fspath(path)
    except TypeError:
        text = None
    if not isinstance(text, str):
        raise Error(f"{name} is a value of type {type(path).__name__}, expected a path")
    return text


def as_folder(output: Any, mat: bool = False) -> str:
    """The folder `output` of results; "": none is written."""
    path = as_path("output", output)
    if mat and not path:
        raise Error(
            "mat=True writes results.mat into the folder of results, and there is "
            "none; expected output, its path"
        )
    return path
