"""Checks of the parts of a case that need more than the kind of one value."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from ._arguments import NUMBER, hint, words_of
from ._part import as_matrix, counted
from ._pinode import Error, element_types, function_error

_DAMPING_RULES = ("rayleigh", "ratios", "diagonal")


def shape_words(shape: tuple[int, ...]) -> str:
    """Returns a shape as text for a message: "2 x 3", or "an array of 3 numbers"."""
    if len(shape) == 1:
        return f"an array of {counted(shape[0], 'number')}"
    return " x ".join(map(str, shape)) or "no array"


def check_square(where: str, name: str, matrix: Any, size: int | None = None) -> None:
    """Raises an Error if an array in memory is not square; files are read with the case."""
    if matrix is None or isinstance(matrix, (str, os.PathLike, Mapping)):
        return
    try:
        shape = matrix.shape if hasattr(matrix, "tocsc") else np.shape(as_matrix(matrix))
    except ValueError:  # rows of different lengths
        shape = ()
    wanted = "n x n" if size is None else f"{size} x {size}"
    if len(shape) != 2 or shape[0] != shape[1] or size not in (None, shape[0]):
        as_mass = "" if size is None else " as mass is"
        raise Error(f"{where}: {name} is {shape_words(shape)}, expected {wanted}{as_mass}")
    values = np.asarray(matrix.data if hasattr(matrix, "tocsc") else as_matrix(matrix))
    # Anything but a number is refused with the case.
    if values.dtype.kind == "f" and not np.all(np.isfinite(values)):
        raise Error(f"{where}: {name} has a value that is not finite, expected numbers")


def check_values(where: str, name: str, values: list[Any], count: int, *,
                 zero: bool = False) -> None:
    """Raises an Error unless there are `count` positive numbers, or zeros if `zero`."""
    if len(values) != count:
        raise Error(f"{where}: {name} has {counted(len(values), 'value')}, expected {count}, one "
                    "for each of masses")
    expected = "zero or a positive number" if zero else "a positive number"
    for i, value in enumerate(values):
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not is_number or not 0.0 <= value < np.inf or (value == 0.0 and not zero):
            raise Error(f"{where}: {name}[{i}] is {value}, expected {expected}")


def check_dofs(where: str, dofs: Any, size: int | None, of: str) -> None:
    """Raises an Error unless there is a name for each of the `size` entries of `of`."""
    if dofs is not None and size is not None and len(dofs) != size:
        raise Error(f"{where}: dofs has {counted(len(dofs), 'name')} and {of}, expected one for "
                    "each")


def check_damping(where: str, damping: Any) -> None:
    """Raises an Error if damping is a dictionary that is no rule."""
    # A matrix of SciPy by keys is a dictionary too.
    is_rule = isinstance(damping, Mapping) and not hasattr(damping, "tocsc")
    if not is_rule or "file" in damping:
        return
    for key in damping:
        if key not in _DAMPING_RULES:
            raise Error(f"{where}: damping has no key '{key}'; {hint(str(key), _DAMPING_RULES)}")
    if len(damping) != 1:
        raise Error(f"{where}: damping has {len(damping)} keys, expected one of "
                    + ", ".join(_DAMPING_RULES))


def check_bounds(where: str, lower: Any, upper: Any) -> None:
    """Raises an Error if the lower bound is not below the upper one."""
    if lower is not None and upper is not None and not lower < upper:
        raise Error(f"{where}: lower is {lower} and upper is {upper}, expected lower < upper")


def check_law(where: str, type: str, parameters: Mapping[str, Any] | None) -> None:
    """Raises an Error if an element's type or one of its parameters is unknown, or if one
    that has no default is missing.
    """
    types = element_types()
    if type not in types:
        raise Error(f"{where}: type is '{type:.40}'; {hint(type, types)}")
    known = types[type]
    given = parameters or {}
    for name, value in given.items():
        if name not in known:
            raise Error(f"{where}: parameters has no key '{name!s:.40}'; {hint(str(name), known)}")
        if not NUMBER.fits(value) and not isinstance(value, Mapping):
            raise Error(f"{where}: parameters['{name}'] is {words_of(value)}, expected a number, "
                        "which stays fixed, or pinode.Unknown(...)")
    for name, is_required in known.items():
        if is_required and name not in given:
            raise Error(f"{where}: parameters has no '{name}', expected a number, which stays "
                        "fixed, or pinode.Unknown(...)")


def check_functions(where: str, inputs: list[str], terms: list[Any]) -> None:
    """Raises an Error if one of a library's terms is no function of its inputs."""
    features = ["".join(str(name).split()) for name in inputs]
    for i, term in enumerate(terms):
        basis = term.get("basis") if isinstance(term, Mapping) else term
        if not isinstance(basis, str):
            raise Error(f"{where}: terms[{i}] is {words_of(term)}, expected a function such as "
                        "'x[u1]^3', or {'basis': function, 'initial': number}")
        error = function_error(basis, features)
        if error:
            raise Error(f"{where}: terms[{i}]: {error} (of the inputs {', '.join(features)})")
