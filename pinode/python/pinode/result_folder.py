"""Results on disk, written by a program or by `save`."""

from __future__ import annotations

import csv
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _html
from ._part import as_flag, as_path
from ._pinode import Error
from ._result_tables import CHANGE_HEADER, change_row, tables
from .case import Case

if TYPE_CHECKING:
    from pandas import DataFrame

# Of each kind of folder the file that has what was found, and what it is of. A
# fit's may stand beside that of a verdict or of equations.
_MAIN_FILES = {
    "result.json": ("pinode-result-", "fit"),
    "discover.json": ("pinode-discover-", "discovery"),
    "modes.json": ("pinode-modes-", "modes"),
    "simulate.json": ("pinode-simulate-", "simulation"),
    "check.json": ("pinode-check-", "check"),
    "plan.json": ("pinode-plan-", "plan"),
}


class ResultFolder:
    """A result folder on disk, of any program.

    kind: "fit", "damage", "discovery", "modes", "simulation", "check" or "plan".
    json: content of its main file: result.json, modes.json, simulate.json, check.json
        or plan.json; discover.json of a discovery without a fit.

    A property that this kind of folder lacks raises pinode.Error.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(as_path("path", path))
        try:
            there = [name for name in _MAIN_FILES if (self.path / name).exists()]
        except OSError as failure:
            raise Error(f"{self.path}: cannot be read: {failure.strerror}") from None
        if not there:
            raise Error(
                f"{self.path}: is not a result of pinode, expected a folder with one of "
                + ", ".join(_MAIN_FILES)
            )
        self._file = self.path / there[0]
        schema, self.kind = _MAIN_FILES[self._file.name]
        self.json: dict[str, Any] = _read_json(self._file)
        if not str(self.json.get("schema")).startswith(schema):
            raise Error(f"{self._file}: is not a result of pinode, expected its schema")
        if self.kind == "fit":
            for name, kind in (("damage.json", "damage"), ("discover.json", "discovery")):
                if (self.path / name).exists():
                    self.kind = kind

    def _get(self, key: str, kind: type) -> Any:
        value = self.json.get(key)
        if not isinstance(value, kind):
            what = {"modes": "identified modes"}.get(self.kind, f"a {self.kind}")
            raise Error(f"{self._file}: has no '{key}'; the folder is of {what}")
        return value

    @property
    def usable(self) -> bool:
        """True if the result is usable."""
        return self._get("usable", bool)

    @property
    def verdict(self) -> str:
        """Verdict on the change, for a damage analysis, see Damage.verdict. Grade of
        the fit for other results.
        """
        damage = self.damage
        return self.fit_verdict if damage is None else damage["verdict"]

    @property
    def fit_verdict(self) -> str:
        """Grade of the fit: "good", "with_care" or "not_usable".

        Folders of old versions have no grade; it then follows from `usable`.
        """
        verdict = self.json.get("verdict")
        if verdict is None:
            return "good" if self.usable else "not_usable"
        return self._get("verdict", str)

    @property
    def findings(self) -> list[dict[str, Any]]:
        """Failed checks of a result, each with `check`, `what`, `grade`, `number`,
        `limit` and `advice`.
        """
        return self.json.get("findings", [])

    @property
    def message(self) -> str:
        """Verdict of a fit, a discovery or a check in a sentence."""
        return self._get("message", str)

    @property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """Parameters of a fit by name: value, sigma, interval and unit."""
        return {p["name"]: p for p in self._get("parameters", list)}

    def __getitem__(self, name: str) -> float:
        return self.parameters[name]["value"]

    @property
    def records(self) -> dict[str, dict[str, Any]]:
        """Records by name.

        A fit has role and errors of each, a simulation its samples, a check its kind
        and steps. Identified modes have only the name.
        """
        records = [r if isinstance(r, dict) else {"name": r} for r in self._get("records", list)]
        return {r["name"]: r for r in records}

    @property
    def modes(self) -> list[dict[str, Any]]:
        """Modes, ascending by frequency.

        A fit has the modes of the initial and the updated model, a check those of the
        model. Identified modes are as in IdentifiedModes, each with its complex
        `shape` over `places`.
        """
        modes = self._get("modes", list)
        return [_mode(m, self.places) for m in modes] if self.kind == "modes" else modes

    @property
    def places(self) -> list[str]:
        """Places of the shapes of identified modes, if they are known."""
        return self._get("places", list)

    @property
    def sensors(self) -> list[dict[str, Any]]:
        """Sensors of a plan, the most informative first, as in SensorPlan."""
        return self._get("sensors", list)

    def prediction(self, record: str) -> dict[str, np.ndarray]:
        """Returns the columns of prediction_<record>.csv of a fit."""
        return self.table(f"prediction_{_name(record)}.csv")

    def response(self, record: str) -> dict[str, np.ndarray]:
        """Returns the columns of response_<record>.csv of a simulation."""
        return self.table(f"response_{_name(record)}.csv")

    def table(self, name: str) -> dict[str, np.ndarray]:
        """Returns the columns of one of the CSV files by name.

        A column is an array of numbers, with NaN for empty cells. It is a list of
        texts if a cell is not a number.
        """
        file = self.path / as_path("name", name)
        try:
            with open(file, newline="", encoding="utf-8") as lines:
                header, *rows = csv.reader(lines)
            columns = {key: _column([row[i] for row in rows]) for i, key in enumerate(header)}
            if any(len(row) != len(header) for row in rows):
                raise ValueError(f"a row has not {len(header)} cells")
        except (OSError, ValueError, IndexError) as failure:
            raise Error(f"{file}: cannot be read as a table: {failure}") from None
        return columns

    def to_pandas(self, name: str) -> "DataFrame":
        """Returns one of the CSV files, such as "parameters.csv", as a frame of
        pandas.
        """
        from . import frames

        return frames.of_table(self.table(name))

    def matrix(self, name: str, *, sparse: bool = False) -> Any:
        """Returns one of the matrices, such as "K.mtx", as a full array.

        sparse: True: returns a CSC matrix of SciPy.
        """
        is_sparse, file = as_flag("sparse", sparse), self.path / as_path("name", name)
        from scipy.io import mmread
        from scipy.sparse import csc_array

        try:
            matrix = mmread(file)
        except (OSError, ValueError) as failure:
            raise Error(f"{file}: cannot be read: {failure}") from None
        if is_sparse:
            return csc_array(matrix)
        return matrix.toarray() if hasattr(matrix, "toarray") else matrix

    @property
    def case(self) -> Case:
        """Returns the updated model of a fit or a discovery, model.toml, as a case."""
        return Case.read(self.path / "model.toml")

    @property
    def damage(self) -> dict[str, Any] | None:
        """Content of damage.json, if there is one."""
        return self._beside("damage.json")

    @property
    def discovery(self) -> dict[str, Any] | None:
        """Content of discover.json, if there is one."""
        return self._beside("discover.json")

    @property
    def equations(self) -> list[dict[str, Any]]:
        """Terms of a discovery by output, as in Discovery.equations."""
        found = self.discovery
        if found is None:
            raise Error(f"{self.path}: has no discover.json, expected the folder of a discovery")
        return found["equations"]

    @property
    def rivals(self) -> list[dict[str, Any]]:
        """Other sets of terms of a discovery, as in Discovery.rivals. Empty for folders
        of versions that did not compare.
        """
        found = self.discovery
        if found is None:
            raise Error(f"{self.path}: has no discover.json, expected the folder of a discovery")
        return found.get("rivals", [])

    @property
    def terms(self) -> dict[str, dict[str, float]]:
        """Coefficients of a discovery by output and basis."""
        return {
            e["output"]: {t["basis"]: t["coefficient"] for t in e["terms"]}
            for e in self.equations
        }

    def _beside(self, name: str) -> dict[str, Any] | None:
        file = self.path / name
        return _read_json(file) if file.exists() else None

    def __repr__(self) -> str:
        return f"ResultFolder({str(self.path)!r}: {self.json.get('message', self.kind)})"

    def _repr_html_(self) -> str:
        damage = self.damage
        title = self.json.get("message", self.kind) if damage is None else damage["message"]
        changes = [] if damage is None else [change_row(g) for g in damage["groups"]]
        parts = [_html.table(CHANGE_HEADER, changes)]
        if self.kind in ("fit", "damage", "discovery"):
            parts.append(tables(self.json.get("parameters", []), self.json.get("records", [])))
        terms = [[output, basis, value] for output, found in self.terms.items()
                 for basis, value in found.items()] if self.kind == "discovery" else []
        parts.append(_html.table(["output", "term", "coefficient"], terms))
        for key in ("sensors", "expected") if self.kind in ("plan", "check") else ():
            parts.append(_dictionaries(self.json.get(key, [])))
        if self.kind in ("modes", "check"):
            parts.append(_dictionaries(self.json.get("modes", [])))
        verdict = self.verdict if self.kind in ("fit", "damage", "discovery") else None
        parts.append(_html.sentences("Remarks:", self.json.get("remarks", [])))
        return _html.section(f"{self.path}: {title}", *parts, verdict=verdict)


def _read_json(file: Path) -> dict[str, Any]:
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as failure:
        raise Error(f"{file}: is not a result of pinode: {failure}") from None
    if not isinstance(content, dict):
        raise Error(f"{file}: is not a result of pinode, expected its schema")
    return content


def _name(record: Any) -> str:
    if not isinstance(record, str):
        raise Error(f"record is a value of type {type(record).__name__}, expected a name")
    return record


def _column(cells: list[str]) -> np.ndarray:
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array(cells)


def _mode(entry: dict[str, Any], places: list[str]) -> dict[str, Any]:
    """Returns an identified mode of modes.json, with arrays over `places`."""
    at = {part["place"]: part for part in entry["shape"]}

    def over_places(key: str) -> np.ndarray:
        return np.array([at.get(place, {}).get(key) for place in places], dtype=float)

    return {
        **entry,
        "shape": over_places("real") + 1j * over_places("imaginary"),
        "shape_sigma_real": over_places("sigma_real"),
        "shape_sigma_imaginary": over_places("sigma_imaginary"),
    }


def _dictionaries(rows: list[dict[str, Any]]) -> str:
    """Returns the plain values of dictionaries as a table with the keys of the first
    one.
    """
    if not rows:
        return ""
    keys = [key for key, value in rows[0].items() if not isinstance(value, (list, dict))]
    return _html.table(keys, [[row.get(key) for key in keys] for row in rows])


def read_result(path: str | os.PathLike[str]) -> ResultFolder:
    """Reads the result folder that a program or `save` has written.

    Raises pinode.Error if there is no result in it.
    """
    return ResultFolder(path)
