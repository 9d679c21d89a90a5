"""Results as frames of pandas."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._pinode import Error

if TYPE_CHECKING:
    import pandas


def of_modes(found: Any) -> "pandas.DataFrame":
    """Identified modes: frequency and damping with sigmas and intervals, and the
    real part of the shape at each place, by columns."""
    try:
        import pandas
    except ImportError:
        raise Error("pandas is missing, expected it for frames") from None

    rows = []
    for mode in found:
        row = {key: value for key, value in mode.items() if np.ndim(value) == 0}
        row.update(zip(found.places, mode["shape"].real))
        rows.append(row)
    index = pandas.RangeIndex(1, len(rows) + 1, name="mode")
    return pandas.DataFrame(rows, index=index)


def frame(outcome: Any, what: str) -> "pandas.DataFrame":
    """parameters, history, modes, or the record of that name: indexed by time,
    columns (channel, "measured" | "predicted" | "deviation")."""
    try:
        import pandas
    except ImportError:
        raise Error("pandas is missing, expected it for frames") from None

    if not isinstance(what, str):
        raise Error(f"a frame of a {type(what).__name__}, expected a name")
    if what == "parameters":
        rows = list(outcome.parameters.values())
        columns = rows[0]._fields if rows else ["name"]
        return pandas.DataFrame(rows, columns=columns).set_index("name")
    if what == "history":
        return pandas.DataFrame(outcome.history)
    if what == "modes":
        return pandas.DataFrame(outcome.modes)
    record = outcome.record(what)
    columns = {}
    for name, values in record.measured.items():
        missing = np.full(len(record.time), np.nan)
        columns[name, "measured"] = values
        columns[name, "predicted"] = record.predicted.get(name, missing)
        columns[name, "deviation"] = record.deviation.get(name, missing)
    return pandas.DataFrame(columns, index=pandas.Index(record.time, name="time"))
