"""One-sentence errors in place of those of pybind11.

If a function of the extension module cannot take a value, pybind11 raises a TypeError
with all signatures and the `repr` of all arguments. This module raises `pinode.Error`
instead, which names the argument. In sentences of the library, flags of programs
become arguments.
"""

from __future__ import annotations

import functools
import inspect
import re
from typing import Any

import numpy as np

_EXPECTED = {
    "int": ((int, np.integer), "a whole number"),
    "float": ((int, float, np.integer, np.floating), "a number"),
    "bool": ((bool, np.bool_), "True or False"),
    "str": ((str,), "a text"),
    "bytes": ((bytes,), "bytes"),
    "list": ((list,), "a list"),
    "dict": ((dict,), "a dictionary"),
}


def install(module: Any) -> None:
    """Wraps the functions of `module` and the methods of its classes."""
    for name, member in list(vars(module).items()):
        if inspect.isbuiltin(member):
            setattr(module, name, _checked(member, module.Error))
        elif inspect.isclass(member) and member is not module.Error:
            for key, method in list(vars(member).items()):
                if key.startswith("__"):
                    continue
                if isinstance(method, staticmethod):
                    checked = _checked(method.__func__, module.Error)
                    setattr(member, key, staticmethod(checked))
                elif callable(method):
                    setattr(member, key, _checked(method, module.Error))


def _checked(function: Any, error: type[Exception]) -> Any:
    name = function.__name__

    @functools.wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        try:
            return function(*args, **kwargs)
        except error as failure:
            sentence = _in_python(str(failure))
            if sentence == str(failure):
                raise
        except TypeError as failure:
            # Not that of a callback that has called something else.
            if not str(failure).startswith(f"{name}(): incompatible function arguments"):
                raise
            sentence = _sentence(function.__doc__ or "", args, kwargs)
        raise error(sentence)

    return call


def _in_python(sentence: str) -> str:
    """Returns a sentence with arguments in place of flags of the programs."""
    return re.sub(r"--(overwrite|resume)\b", r"\1=True", sentence)


def _sentence(signature: str, args: tuple[Any, ...], kwargs: dict[str, Any]) -> str:
    """Returns the sentence on the argument at fault.

    `signature` is pybind11's "name(case: pinode._pinode.CaseHandle, n: int = 0)".
    """
    parameters = re.findall(r"(\w+): ([\w.]+)", signature.partition("->")[0])
    given = {**dict(zip((name for name, _ in parameters), args)), **kwargs}
    for name, kind in parameters:
        if name not in given:
            continue
        value = given[name]
        types, words = _EXPECTED.get(kind, ((), ""))
        if isinstance(value, types) and not (kind != "bool" and isinstance(value, bool)):
            if kind == "int" and abs(int(value)) >= 2**31:
                return f"{name} is beyond 2^31, expected a smaller whole number"
            continue
        if kind.endswith("Handle"):
            if type(value).__name__ == kind.rpartition(".")[2] or value is None:
                continue
            words = "a " + kind.rpartition(".")[2].replace("Handle", "").lower()
        if words:
            return f"{name} is a value of type {type(value).__name__}, expected {words}"
    return f"{signature.partition('(')[0]} does not take these values"
