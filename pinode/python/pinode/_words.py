"""Sentences of the library in Python's terms.

The library reads a case as from a file, and its sentences name tables and keys of
files. For a case made of parts they name the parts and arguments.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable
from typing import Any

from ._case_tables import KEYS
from ._pinode import Error

_PLURALS = {table: key for key, table in KEYS.items()} | {"channel": "channels"}
_KEYWORDS = {"frequency": "frequency_hz", "channel": "channels"}
_MODELS = {"shear_building": "ShearBuilding", "finite_element": "FiniteElementModel"}
# Endings of sentences that name what a file has.
_KINDS = {"expected a table": "expected a dictionary",
          "expected a text in quotes": "expected a text",
          "an array, expected tables, each under a header": "a list, expected a dictionary for"}
_LISTS = "|".join(_PLURALS)


def in_python(sentence: str) -> str:
    """Returns `sentence` with the names of parts and arguments in place of tables and
    keys.
    """
    sentence = re.sub(r"\[\[(\w+)\.(\w+)\]\] (\d+)", _place, sentence)
    sentence = re.sub(r"\[\[(\w+)\]\] (\d+)", _place, sentence)
    sentence = re.sub(r"\[\[(?:\w+\.)?(\w+)\]\]",
                      lambda m: _PLURALS.get(m[1], m[1]), sentence)
    sentence = re.sub(r"\[(?:model\.)?([a-z_]+)\](?=:|,|;| \w|$|\.)", r"\1", sentence)
    sentence = re.sub(r"(?<![\w'\"])(?:model\.)?(shear_building|finite_element)\b",
                      lambda m: _MODELS[m[1]], sentence)
    sentence = re.sub(rf"<?\b({_LISTS})\[(\d+)\]\.?([\w.\[\]]*?)>?(?=:|,| |$)", _path, sentence)
    sentence = re.sub(r"<(\w+)\.([\w.]+)>", r"\1.\2", sentence)
    sentence = re.sub(r"\b(records\[\d+\]):(\d+): ", r"\1, sample \2: ", sentence)
    # Tables within braces.
    sentence = re.sub(r"(?<=[{,]) ?(\w+) = ", lambda m: f' "{m[1]}": ', sentence)
    sentence = sentence.replace('{ "', '{"')
    sentence = re.sub(r"\b(\w+) = (?=[\"'{\[]|true|false|\d)", r"\1=", sentence)
    sentence = re.sub(r"=true\b", "=True", sentence)
    sentence = re.sub(r"=false\b", "=False", sentence)
    sentence = re.sub(r"'(frequency|channel)' is", lambda m: f"'{_KEYWORDS[m[1]]}' is", sentence)
    sentence = re.sub(r"has entries of type [<>|=]?[US]\d+", "has texts", sentence)
    for of_file, of_python in _KINDS.items():
        sentence = sentence.replace(of_file, of_python)
    return sentence.replace("a file's name, rows [[...], ...]", "an array, rows [[...], ...]")


def _place(match: "re.Match[str]") -> str:
    """Returns the index of a list's entry, from 0."""
    name = match[match.lastindex - 1]  # type: ignore[operator]
    return f"{_PLURALS.get(name, name)}[{int(match[match.lastindex]) - 1}]"  # type: ignore[index]


def _path(match: "re.Match[str]") -> str:
    """Returns a path into the tree of a case."""
    rest = re.sub(r"\bchannel\[", "channels[", match[3])
    rest = "" if rest == "file" else rest
    return f"{_PLURALS[match[1]]}[{match[2]}]" + (f".{rest}" if rest else "")


def speaks_python(method: Callable[..., Any]) -> Callable[..., Any]:
    """Decorates methods of a Case. Sentences about a case from a file keep the terms of
    files.
    """

    @functools.wraps(method)
    def call(self: Any, *args: Any, **kwargs: Any) -> Any:
        try:
            return method(self, *args, **kwargs)
        except Error as failure:
            words = str(failure)
            if getattr(self, "_parts", None) is None or in_python(words) == words:
                raise
        raise Error(in_python(words))

    if hasattr(method, "known_keywords"):
        call.known_keywords = method.known_keywords  # type: ignore[attr-defined]
    return call
