"""Stores of pinode_watch: records, histories and alarms of watched structures.

    store = pinode.watch.Store("watch.db")
    histories = store.histories()
    store.plot_histories()
"""

from __future__ import annotations

import functools
import inspect
import pathlib
import sqlite3
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar, cast

import numpy as np

from ._part import as_flag, as_path, as_text
from ._pinode import Error

__all__ = ["Store"]

# Marks the file as a store ("pnde").
_APPLICATION = 0x706E6465
_Method = TypeVar("_Method", bound=Callable[..., Any])
_LIGHTS = ("learning", "normal", "notice", "alarm")


def _times(seconds: Sequence[float | None]) -> np.ndarray:
    """Times in s since 1970 as datetime64; a time that is not known is NaT."""
    values = np.array([np.nan if s is None else s for s in seconds], float)
    known = np.abs(values) < 1e12
    times = np.full(len(values), np.datetime64("NaT", "ms"))
    times[known] = np.round(1000 * values[known]).astype("int64").astype("datetime64[ms]")
    return times


def _reads(method: _Method) -> _Method:
    """Makes all queries of a method one transaction: pinode_watch may write between
    two of them. Values that pinode_watch never writes become a pinode.Error.
    """
    signature = inspect.signature(method)

    @functools.wraps(method)
    def read(self: "Store", *values: Any, **keys: Any) -> Any:
        signature.bind(self, *values, **keys)
        if "frame" in keys:
            keys["frame"] = as_flag("frame", keys["frame"])
        begins = False
        try:
            begins = not self._database.in_transaction
            if begins:
                self._database.execute("BEGIN")
            return method(self, **keys)
        except Error:
            raise
        except sqlite3.Error as failure:
            raise Error(f"{self.path}: {failure}") from None
        except (ValueError, TypeError, IndexError, KeyError, OverflowError) as failure:
            raise Error(f"{self.path}: a value in the store is wrong, expected the store "
                        f"as pinode_watch writes it ({failure})") from None
        finally:
            if begins and self._database.in_transaction:
                self._database.rollback()
    return cast(_Method, read)


def _texts(values: Sequence[str]) -> np.ndarray:
    return np.array(values, dtype=object)


class Store:
    """A store of `pinode_watch`, opened for reading only.

    `structure` is needed if the store holds several. Every table is a dict of arrays of
    NumPy with one value a row; `frame=True` makes it a frame of pandas. Times are UTC.
    The program may go on writing meanwhile.
    """

    def __init__(self, path: str | pathlib.Path, structure: str | None = None) -> None:
        file = pathlib.Path(as_path("path", path))
        if structure is not None:
            structure = as_text("structure", structure)
        try:
            is_file = file.is_file()
        except OSError:  # such as a name that is too long
            is_file = False
        if not is_file:
            raise Error(f"{path}: no such store; pinode_watch makes it")
        try:
            self._database = sqlite3.connect(file.resolve().as_uri() + "?mode=ro", uri=True)
            mark = self._database.execute("PRAGMA application_id").fetchone()[0]
            names = {str(n): i for i, n in self._database.execute("SELECT id, name FROM structure")
                     } if mark == _APPLICATION else {}
        except sqlite3.Error as failure:
            raise Error(f"{path}: not a store of pinode_watch ({failure})") from None
        if mark != _APPLICATION:
            raise Error(f"{path}: a database, but not a store of pinode_watch")
        if structure is None and len(names) == 1:
            structure = next(iter(names))
        if structure not in names:
            raise Error(f"{path}: structure = {structure!r}, expected one of "
                        + (", ".join(sorted(names)) or "none: the store is empty"))
        self.path, self.structure = str(path), structure
        self._id = names[structure]

    def __repr__(self) -> str:
        return f"Store({self.path!r}, {self.structure!r})"

    def close(self) -> None:
        """Closes the file."""
        self._database.close()

    def __enter__(self) -> "Store":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _rows(self, sql: str) -> list[tuple[Any, ...]]:
        try:
            return self._database.execute(sql, (self._id,)).fetchall()
        except sqlite3.Error as failure:
            if "no such table" in str(failure):
                return []  # of a store that no newer pinode_watch has opened
            raise Error(f"{self.path}: {failure}") from None

    @staticmethod
    def _table(columns: Mapping[str, np.ndarray], frame: bool) -> Any:
        if not frame:
            return dict(columns)
        try:
            import pandas
        except ImportError:
            raise Error("pandas is missing, expected it for frames") from None
        return pandas.DataFrame(columns)

    @_reads
    def records(self, *, frame: bool = False) -> Any:
        """Records by time: `record` (name of the file), `time`, `duration_s`,
        `refusal` (empty: it was used), `rejected` (by hand) and the covariates that the
        records themselves hold; `histories()` has all.
        """
        rows = self._rows("SELECT id, name, time, duration, refusal, content FROM record "
                          "WHERE structure = ? ORDER BY time, content")
        rejected = {m[0]: m[1] == "reject" for m in self._rows(
            "SELECT subject, kind FROM mend WHERE structure = ? AND "
            "kind IN ('reject', 'accept') ORDER BY id")}
        columns = {
            "record": _texts([r[1] for r in rows]),
            "time": _times([r[2] for r in rows]),
            "duration_s": np.array([r[3] for r in rows], float),
            "refusal": _texts([r[4] for r in rows]),
            "rejected": np.array([rejected.get(r[5], False) for r in rows], bool),
        }
        place = {r[0]: i for i, r in enumerate(rows)}
        fixed = set(columns)
        for record, name, value in self._rows(
                "SELECT record, covariate.name, value FROM covariate JOIN record ON "
                "record.id = record WHERE structure = ? ORDER BY covariate.name"):
            if name in fixed:
                raise Error(f"{self.path}: a covariate has the name {name!r} of another "
                            "column, expected another name and a new store")
            columns.setdefault(name, np.full(len(rows), np.nan))[place[record]] = value
        return self._table(columns, frame)

    @_reads
    def modes(self, *, frame: bool = False) -> Any:
        """All modes of all records by time: `record`, `time`, `frequency_hz`,
        `frequency_sigma_hz`, `damping_ratio`, `damping_sigma` and `shape`, complex
        displacements at the channels that were used.
        """
        rows = self._rows(
            "SELECT record.name, time, frequency_hz, frequency_sigma, damping_ratio, "
            "damping_sigma, shape FROM mode JOIN record ON record.id = record "
            "WHERE structure = ? ORDER BY time, content, number")
        shapes = np.empty(len(rows), dtype=object)
        for i, row in enumerate(rows):
            shapes[i] = np.frombuffer(row[6], complex).copy()
        columns: dict[str, np.ndarray] = {
            "record": _texts([r[0] for r in rows]), "time": _times([r[1] for r in rows])}
        for c, name in enumerate(("frequency_hz", "frequency_sigma_hz", "damping_ratio",
                                  "damping_sigma")):
            columns[name] = np.array([r[2 + c] for r in rows], float)
        columns["shape"] = shapes
        return self._table(columns, frame)

    @_reads
    def histories(self, *, frame: bool = False) -> Any:
        """The last analysis, a row a record: `time`, `light` and the columns of
        histories.csv, such as `mode_1_hz`, `mode_1_expected_lower95_hz`, the covariates,
        and the scores `t2` and `average`. Empty before the first analysis.
        """
        columns: dict[str, np.ndarray] = {}
        for name, values in self._rows('SELECT name, "values" FROM history '
                                       "WHERE structure = ? ORDER BY number"):
            columns[name] = np.frombuffer(values, float).copy()
        if columns:
            columns["time"] = _times(columns["time"].tolist())
            columns["light"] = _texts([_LIGHTS[int(i)] for i in columns["light"]])
        return self._table(columns, frame)

    @_reads
    def alarms(self, *, frame: bool = False) -> Any:
        """Alarms, notices and all-clears: `time`, `kind`, `text`, and for an alarm that a
        person has acknowledged `acknowledged_by` and `why`.
        """
        rows = self._rows("SELECT time, kind, text FROM event WHERE structure = ? "
                          "ORDER BY number")
        who = [("", "")] * len(rows)
        for subject, person, reason in self._rows(
                "SELECT subject, person, reason FROM mend WHERE structure = ? AND "
                "kind = 'acknowledge' ORDER BY id"):
            for i, row in enumerate(rows):
                if row[1] == "alarm" and abs(row[0] - float(subject)) < 1e-3:
                    who[i] = (person, reason)
        return self._table({
            "time": _times([r[0] for r in rows]), "kind": _texts([r[1] for r in rows]),
            "text": _texts([r[2] for r in rows]),
            "acknowledged_by": _texts([w[0] for w in who]),
            "why": _texts([w[1] for w in who])}, frame)

    @_reads
    def decisions(self, *, frame: bool = False) -> Any:
        """All that people decided by `pinode_watch --mend`, the oldest first: `time`,
        `by`, `why`, `kind`, `subject` and `value`.
        """
        rows = self._rows("SELECT time, person, reason, kind, subject, value FROM mend "
                          "WHERE structure = ? ORDER BY id")
        columns = {"time": _times([r[0] for r in rows])}
        for c, name in enumerate(("by", "why", "kind", "subject", "value")):
            columns[name] = _texts([r[1 + c] for r in rows])
        return self._table(columns, frame)

    @_reads
    def _histories_and_alarms(self) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        return self.histories(), self.alarms()

    def plot_histories(self) -> Any:
        """Draws each watched frequency with the band that was expected, and the alarms."""
        from . import _drawing

        data, events = self._histories_and_alarms()
        modes = [n[:-3] for n in data
                 if n.startswith("mode_") and n.endswith("_hz") and n.count("_") == 2]
        if not modes:
            raise Error(f"{self.path}: no mode is watched yet, expected a run of "
                        "pinode_watch with a reference")
        figure, axes = _drawing.panels(len(modes), height=1.8)
        for mode, ax in zip(modes, axes):
            if mode + "_expected_hz" in data:
                ax.fill_between(data["time"], data[mode + "_expected_lower95_hz"],
                                data[mode + "_expected_upper95_hz"], label="expected, 95 %",
                                **_drawing.BAND)
            ax.plot(data["time"], data[mode + "_hz"], ".", ms=2, color="0.4",
                    label="measured")
            for time in events["time"][events["kind"] == "alarm"]:
                ax.axvline(time, color=_drawing.MARK, lw=0.8)
            ax.set_ylabel(mode.replace("_", " ") + " (Hz)")
        axes[0].legend(fontsize="small")
        return figure
