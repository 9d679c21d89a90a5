"""A table of a case, and values as its keys take them."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

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
        array = np.asarray(value)
    except (TypeError, ValueError):
        return value
    # Others are refused by name when the case is made.
    return array.astype(float) if array.dtype.kind in "biuf" else value


def as_list(values: Any) -> Any:
    """An array as a list."""
    return values.tolist() if hasattr(values, "tolist") else values


def as_strings(names: Any) -> Any:
    """Names of NumPy as Python's own."""
    if names is None or isinstance(names, str):
        return names
    return [str(name) if isinstance(name, np.str_) else name for name in names]


def as_folder(output: Any, mat: bool = False) -> str:
    """The folder `output` of results; "": none is written."""
    try:
        path = os.fspath(output)
    except TypeError:
        path = None
    if not isinstance(path, str):
        raise Error(
            f"output is a value of type {type(output).__name__}, expected the "
            "path of a folder"
        )
    if mat and not path:
        raise Error(
            "mat=True writes results.mat into the folder of results, and there is "
            "none; expected output, its path"
        )
    return path
