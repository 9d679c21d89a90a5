"""A result that programs, or `save`, have left on disk."""

from __future__ import annotations

import csv
import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from . import _html
from ._part import as_path
from ._pinode import Error
from ._result_tables import CHANGE_HEADER, change_row, tables
from .case import Case


class ResultFolder:
    """A result folder on disk."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(as_path("path", path))
        file = self.path / "result.json"
        try:
            self.json: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as failure:
            raise Error(f"{file}: is no result of pinode: {failure}") from None
        if not isinstance(self.json, dict) or not str(self.json.get("schema")).startswith(
            "pinode-result-"
        ):
            raise Error(f"{file}: is no result of pinode, expected its schema")

    def _get(self, key: str, kind: type) -> Any:
        value = self.json.get(key)
        if not isinstance(value, kind):
            raise Error(f"{self.path / 'result.json'}: has no '{key}' of a result")
        return value

    @property
    def usable(self) -> bool:
        """Whether the programs called the result usable."""
        return self._get("usable", bool)

    @property
    def message(self) -> str:
        """The verdict in a sentence."""
        return self._get("message", str)

    @property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """By name: value, sigma, interval and unit."""
        return {p["name"]: p for p in self._get("parameters", list)}

    def __getitem__(self, name: str) -> float:
        return self.parameters[name]["value"]

    @property
    def records(self) -> dict[str, dict[str, Any]]:
        """By name: role and errors of each record."""
        return {r["name"]: r for r in self._get("records", list)}

    @property
    def modes(self) -> list[dict[str, Any]]:
        """Of the model, before and after, ascending."""
        return self._get("modes", list)

    def prediction(self, record: str) -> dict[str, np.ndarray]:
        """Columns of prediction_<record>.csv."""
        if not isinstance(record, str):
            raise Error(f"record is a value of type {type(record).__name__}, expected a name")
        return self.table(f"prediction_{record}.csv")

    def table(self, name: str) -> dict[str, np.ndarray]:
        """The columns of one of its CSV files with numbers."""
        file = self.path / name
        try:
            with open(file, newline="", encoding="utf-8") as lines:
                rows = list(csv.reader(lines))
            header, body = rows[0], rows[1:]
            numbers = np.array(
                [[float(cell) if cell else np.nan for cell in row] for row in body]
            ).reshape(len(body), len(header))
        except (OSError, ValueError, IndexError) as failure:
            raise Error(f"{file}: cannot be read as a table: {failure}") from None
        return {name: numbers[:, i] for i, name in enumerate(header)}

    def matrix(self, name: str, *, sparse: bool = False) -> Any:
        """One of its matrices, such as "K.mtx", full; `sparse`: as SciPy's CSC."""
        from scipy.io import mmread
        from scipy.sparse import csc_array

        try:
            matrix = mmread(self.path / as_path("name", name))
        except (OSError, ValueError) as failure:
            raise Error(f"{self.path / name}: cannot be read: {failure}") from None
        if sparse:
            return csc_array(matrix)
        return matrix.toarray() if hasattr(matrix, "toarray") else matrix

    @property
    def case(self) -> Case:
        """The updated model as a case, model.toml."""
        return Case.read(self.path / "model.toml")

    @property
    def damage(self) -> dict[str, Any] | None:
        """The content of damage.json, where there is one."""
        file = self.path / "damage.json"
        return json.loads(file.read_text(encoding="utf-8")) if file.exists() else None

    def __repr__(self) -> str:
        return f"ResultFolder({str(self.path)!r}: {self.message})"

    def _repr_html_(self) -> str:
        damage = self.damage
        changes = [] if damage is None else [change_row(g) for g in damage["groups"]]
        return _html.section(
            f"{self.path}: {self.message if damage is None else damage['message']}",
            _html.table(CHANGE_HEADER, changes),
            tables(self.parameters.values(), self.records.values()),
            _html.sentences("Remarks:", self._get("remarks", list)),
        )


def read_result(path: str | os.PathLike[str]) -> ResultFolder:
    """The result folder that a program, or `save`, has written."""
    return ResultFolder(path)
