"""Checks of arguments, with messages in Python's terms.

`takes` states the kind of value of each argument of a constructor or a function. An
unknown keyword raises a `KeywordError`, a value of another kind an `Error`. Both name
the argument.
"""

from __future__ import annotations

import difflib
import functools
import inspect
import numbers
import os
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from ._pinode import Error


class KeywordError(Error, TypeError):
    """An unknown keyword, or a missing one."""


class Kind(NamedTuple):
    """A kind of value: its name, and the test of a value."""

    expected: str
    fits: Callable[[Any], bool]


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _is_number(value: Any) -> bool:
    if isinstance(value, np.ndarray):  # such as a sum of NumPy
        return value.ndim == 0 and value.dtype.kind in "iuf"
    return isinstance(value, numbers.Real) and not isinstance(value, (bool, np.bool_))


def _is_whole(value: Any) -> bool:
    return isinstance(value, numbers.Integral) and not isinstance(value, (bool, np.bool_))


def _is_flag(value: Any) -> bool:
    return isinstance(value, (bool, np.bool_)) or (isinstance(value, int) and value in (0, 1))


def _is_path(value: Any) -> bool:
    return isinstance(value, (str, os.PathLike))


def _is_list(value: Any) -> bool:
    """True for a list, an array of one dimension or more, a column of pandas, and a
    range.
    """
    if isinstance(value, (str, bytes, Mapping)):
        return False
    return hasattr(value, "__iter__") and getattr(value, "shape", (0,)) != ()


def _is_matrix(value: Any) -> bool:
    """True for an array, rows, or a file of them. The part checks their sizes."""
    is_sparse = hasattr(value, "tocsc")
    return is_sparse or _is_path(value) or isinstance(value, Mapping) or _is_list(value)


TEXT = Kind("a text", _is_text)
NUMBER = Kind("a number", _is_number)
POSITIVE = Kind("a positive number", lambda v: _is_number(v) and float(v) > 0.0)
NOT_NEGATIVE = Kind("zero or a positive number", lambda v: _is_number(v) and float(v) >= 0.0)
WHOLE = Kind("a whole number", _is_whole)
COUNT = Kind("a whole number, 0 or more", lambda v: _is_whole(v) and int(v) >= 0)
FLAG = Kind("True or False", _is_flag)
PATH = Kind("a path", _is_path)
MAPPING = Kind("a dictionary", lambda v: isinstance(v, Mapping))
LIST = Kind("a list", _is_list)
NAMES = Kind("a list of names", _is_list)
VALUES = Kind("a list or an array of numbers", _is_list)
MATRIX = Kind("an array, n x n", _is_matrix)
ANY = Kind("a value", lambda v: True)


def either(*kinds: Kind) -> Kind:
    """Returns the kind of values that are of one of several kinds."""
    return Kind(" or ".join(kind.expected for kind in kinds),
                lambda v: any(kind.fits(v) for kind in kinds))


def one_of(*words: str) -> Kind:
    """Returns the kind of values that are one of these texts."""
    return Kind("one of " + ", ".join(f"'{word}'" for word in words),
                lambda v: isinstance(v, str) and v in words)


def words_of(value: Any) -> str:
    """Returns a value as text for a message."""
    if isinstance(value, str):
        return f"the text {value!r:.40}"
    if isinstance(value, (bool, np.bool_)) or value is None:
        return str(value)
    if isinstance(value, (int, float, np.number)):
        try:
            return f"the number {value!r:.40}"
        except ValueError:  # more digits than Python writes
            return "a very large number"
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple) and shape:
        return "an array of " + " x ".join(str(n) for n in shape)
    return f"a value of type {type(value).__name__}"


def hint(word: str, known: Any) -> str:
    """Returns a sentence with the word that was probably meant, or with all known
    ones.
    """
    known = [str(name) for name in known]
    near = difflib.get_close_matches(word, known, 1, 0.6)
    begins = [name for name in known if len(word) > 2 and name.startswith(word)]
    near = near or begins[:1]
    return f"did you mean '{near[0]}'?" if near else "there are " + ", ".join(known)


# Names of arguments in other packages, and here.
_OTHERS = {
    "dt": "step", "delta": "step", "sample_rate": "fs", "sampling_rate": "fs",
    "sampling_frequency": "fs", "freq": "fs", "data": "values", "type": "quantity",
    "unknowns": "groups", "std": "sigma", "noise": "sigma", "names": "dofs", "m": "mass",
    "M": "mass", "K": "stiffness", "k": "stiffness", "C": "damping", "c": "damping",
    "zeta": "damping", "frequency": "frequency_hz", "channel": "channels", "record": "records",
    "group": "groups", "element": "elements", "library": "libraries", "network": "networks",
    "unknown_force": "unknown_forces", "mode": "modes", "frf": "frfs", "min": "lower",
    "max": "upper",
    "num_threads": "threads", "n_jobs": "threads", "verbose": "progress",
    "reference_curve": "reference_curves",
}


def unknown_keyword(title: str, key: str, known: Any) -> KeywordError:
    """Returns the exception for a keyword that is not one of `known`."""
    other = _OTHERS.get(key)
    said = f"did you mean '{other}'?" if other in known else hint(key, known)
    return KeywordError(f"{title}() has no keyword '{key}'; {said}")


def check_kind(where: str, name: str, value: Any, kind: Kind) -> None:
    """Raises an Error if `value` is of another kind."""
    try:
        fits = kind.fits(value)
    except Exception:  # objects that fail where they are looked at
        fits = False
    if fits:
        return
    meant = ""
    if isinstance(value, str) and kind.expected.startswith("one of"):
        near = difflib.get_close_matches(value, kind.expected[7:].replace("'", "").split(", "), 1)
        meant = f"; did you mean '{near[0]}'?" if near else ""
    raise Error(f"{where}: {name} is {words_of(value)}, expected {kind.expected}{meant}")


def takes(**kinds: Kind) -> Callable[[Any], Any]:
    """Returns a decorator that checks the arguments of a function.

    `kinds` may include keywords that the function takes as **keys. Arguments without
    a kind are not checked, and neither is None as the default.
    """

    def decorate(function: Any) -> Any:
        signature = inspect.signature(function)
        title = function.__qualname__.replace(".__init__", "")
        explicit = [p for p in signature.parameters.values()
                    if p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL) and p.name != "self"]
        known = [p.name for p in explicit] + [
            name for name in kinds if name not in signature.parameters]
        required = {p.name for p in explicit if p.default is p.empty}

        @functools.wraps(function)
        def call(*args: Any, **kwargs: Any) -> Any:
            for key in kwargs:
                if key not in known:
                    raise unknown_keyword(title, key, known)
            try:
                given = signature.bind(*args, **kwargs).arguments
            except TypeError as failure:
                raise KeywordError(f"{title}(): {failure}") from None
            further = next((n for n, p in signature.parameters.items()
                            if p.kind is p.VAR_KEYWORD), None)
            given = {**given, **(given.get(further) or {})}
            name = given.get("name")
            where = f"{title}({name!r:.40})" if isinstance(name, str) else title
            for key, value in given.items():
                if key in kinds and (value is not None or key in required):
                    check_kind(where, key, value, kinds[key])
            return function(*args, **kwargs)

        call.known_keywords = known  # type: ignore[attr-defined]
        return call

    return decorate
