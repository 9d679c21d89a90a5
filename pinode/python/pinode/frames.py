"""Results as frames of pandas."""

from __future__ import annotations

import functools
import numbers
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ._mode_shapes import shape_pairs
from ._pinode import Error

if TYPE_CHECKING:
    import pandas

    from .forecast import Simulation

__all__ = ["frame", "of_check", "of_modes", "of_plan", "of_simulation", "of_table"]


# What looks like a result for as long as nobody looks into it.
_PLAIN = (numbers.Number, str, bytes, list, tuple, set, range, dict, np.ndarray)


def _of_results(make: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(make)
    def call(outcome: Any, *args: Any, **kwargs: Any) -> Any:
        if outcome is None or isinstance(outcome, _PLAIN):
            raise _no_result(outcome)
        try:
            return make(outcome, *args, **kwargs)
        except AttributeError as failure:
            # Python 3.9 does not say whose attribute is missing.
            if getattr(failure, "obj", outcome) is not outcome:
                raise
        raise _no_result(outcome)

    return call


def _no_result(outcome: Any) -> Error:
    return Error(f"a frame of a {type(outcome).__name__}, expected a result")


def _pandas() -> Any:
    try:
        import pandas
    except ImportError:
        raise Error("pandas is missing, expected it for frames") from None
    return pandas


@_of_results
def frame(outcome: Any, what: str) -> "pandas.DataFrame":
    """Returns a part of a result as a frame.

    `what` is one of these names. Otherwise it is the name of a record.

    parameters, modes: one row each.
    history: one row per iteration. stages: one row per stage.
    changes: of a damage analysis: one row per group, then other changes.
    equations: of a discovery: one row per term. pareto: one row per number of terms
        in the regression of an output.
    profiles: one row per point, indexed by parameter.
    forces: indexed by time; columns (force, "force" | "lower95" | "upper95").
    loops: one row per sample, indexed by (term, output, record).
    ambient: indexed by frequency (Hz); columns (record, channel, "measured" |
        "modelled").
    mode_shapes: indexed by DOF; columns (mode from 1, "initial" | "updated").

    The frame of a record is indexed by time. Its columns are (channel, "measured" |
    "predicted" | "deviation" | "before"). "before" is the simulation of the initial
    model.

    If the result lacks this part, the frame has no rows.
    """
    pandas = _pandas()
    if not isinstance(what, str):
        raise Error(f"what: a frame of a {type(what).__name__}, expected a name")
    make = _FRAMES.get(what)
    return _record(outcome, what, pandas) if make is None else make(outcome, pandas)


@_of_results
def of_modes(found: Any, what: str = "modes") -> "pandas.DataFrame":
    """Returns a part of identified modes as a frame.

    modes: one row each, with frequency, damping, sigmas, intervals, and the real part
        of the shape at each place.
    shapes: indexed by place; columns (mode from 1, "real" | "imaginary" |
        "sigma_real" | "sigma_imaginary").
    diagram: one row per pole of the stabilisation diagram. `mode` counts the modes of
        the record from 1; 0 stands for none.
    """
    pandas, places = _pandas(), found.places
    if not isinstance(what, str):
        raise _no_such(what, "modes, shapes or diagram")
    if what == "modes":
        rows = []
        for mode in found:
            row = {key: value for key, value in mode.items() if np.ndim(value) == 0}
            row.update(zip(places, mode["shape"].real))
            rows.append(row)
        index = pandas.RangeIndex(1, len(rows) + 1, name="mode")
        return pandas.DataFrame(rows, index=index)
    if what == "shapes":
        columns = {}
        for number, mode in enumerate(found, 1):
            columns[number, "real"] = mode["shape"].real
            columns[number, "imaginary"] = mode["shape"].imag
            columns[number, "sigma_real"] = mode["shape_sigma_real"]
            columns[number, "sigma_imaginary"] = mode["shape_sigma_imaginary"]
        return pandas.DataFrame(columns, index=pandas.Index(places, name="place"))
    if what == "diagram":
        keys = ("order", "frequency_hz", "frequency_sigma", "damping_ratio", "mode")
        parts = []
        for band in found.diagram:
            part = pandas.DataFrame({key: band[key] for key in keys})
            part.insert(0, "record", band["record"])
            parts.append(part)
        if not parts:
            return pandas.DataFrame(columns=["record", *keys])
        table = pandas.concat(parts, ignore_index=True)
        table["mode"] += 1
        return table
    raise _no_such(what, "modes, shapes or diagram")


@_of_results
def of_plan(plan: Any, what: str = "sensors") -> "pandas.DataFrame":
    """Returns a part of a sensor plan as a frame.

    sensors: one row each, the most informative first, with the expected deviations of
        this and all previous sensors together.
    deviations: one row per parameter, with the case's own sensors, the planned ones,
        and sensors at all places.
    durations: one row per duration of the records.
    """
    pandas, deviations = _pandas(), plan.deviations
    if not isinstance(what, str):
        raise _no_such(what, "sensors, deviations or durations")
    if what == "sensors":
        return _rows(pandas, list(plan), "name", ["name"])
    if what == "deviations":
        rows = [{"parameter": name, **row} for name, row in deviations.items()]
        return _rows(pandas, rows, "parameter", ["parameter"])
    if what == "durations":
        return _rows(pandas, plan.durations, "duration", ["duration"])
    raise _no_such(what, "sensors, deviations or durations")


def of_check(check: "Mapping[str, Any]", what: str = "expected") -> "pandas.DataFrame":
    """Returns a part of a check as a frame.

    expected: one row per free parameter, with the standard deviation that a fit would
        have.
    steps: integration steps of each record.
    """
    pandas = _pandas()
    if not isinstance(check, Mapping) or not hasattr(check, "to_pandas"):
        raise _no_result(check)
    if not isinstance(what, str) or what not in ("expected", "steps"):
        raise _no_such(what, "expected or steps")
    index = "name" if what == "expected" else "record"
    return _rows(pandas, check.get(what, []), index, [index])


@_of_results
def of_simulation(
    simulation: "Simulation", record: str | None = None
) -> "pandas.DataFrame":
    """Returns the channels of a simulated record, indexed by time. Default: the first
    record.
    """
    pandas = _pandas()
    if record is None:
        record = next(iter(simulation))
    if not isinstance(record, str) or record not in simulation:
        raise Error(f"there is no record '{record}' in the simulation")
    response = simulation[record]
    return pandas.DataFrame(
        response["channels"], index=pandas.Index(response["time"], name="time")
    )


def of_table(columns: "Mapping[str, Any]") -> "pandas.DataFrame":
    """Returns columns of equal length, by name, as a frame, see ResultFolder.table."""
    pandas = _pandas()
    if not isinstance(columns, Mapping):
        raise Error(f"a frame of a {type(columns).__name__}, expected columns by name")
    try:
        return pandas.DataFrame(dict(columns))
    except (TypeError, ValueError) as failure:
        raise Error(f"the columns are no table: {failure}") from None


def _no_such(what: Any, expected: str) -> Error:
    name = f"'{what}'" if isinstance(what, str) else f"a {type(what).__name__}"
    return Error(f"what: a frame of {name}, expected {expected}")


def _rows(pandas: Any, rows: Any, index: str, columns: Any) -> Any:
    """Returns dictionaries as a frame. `columns` are those of a frame without rows."""
    table = pandas.DataFrame(rows) if rows else pandas.DataFrame(columns=columns)
    return table.set_index(index)


def _side_by_side(pandas: Any, parts: Any, name: str) -> Any:
    """Joins frames that each have an index of their own, such as times."""
    if not parts:
        return pandas.DataFrame(index=pandas.Index([], name=name))
    return pandas.concat(parts, axis=1).rename_axis(index=name)


def _parameters(outcome: Any, pandas: Any) -> Any:
    rows = list(outcome.parameters.values())
    columns = rows[0]._fields if rows else ["name"]
    return pandas.DataFrame(rows, columns=columns).set_index("name")


def _changes(outcome: Any, pandas: Any) -> Any:
    return _rows(pandas, getattr(outcome, "changes", []), "name", ["name"])


def _equations(outcome: Any, pandas: Any) -> Any:
    rows = [{"output": e["output"], **term}
            for e in getattr(outcome, "equations", []) for term in e["terms"]]
    return _rows(pandas, rows, ["output", "basis"], ["output", "basis"])


def _pareto(outcome: Any, pandas: Any) -> Any:
    rows = [{"output": e["output"], **point, "chosen": point["residual"] == e["residual"]}
            for e in getattr(outcome, "equations", []) for point in e["pareto"]]
    return _rows(pandas, rows, ["output", "terms"], ["output", "terms"])


def _profiles(outcome: Any, pandas: Any) -> Any:
    rows = [{"name": name, "value": value, "likelihood_ratio": ratio,
             "threshold95": p["threshold95"]}
            for name, p in outcome.profiles.items()
            for value, ratio in zip(p["values"], p["likelihood_ratios"])]
    return _rows(pandas, rows, "name", ["name"])


def _forces(outcome: Any, pandas: Any) -> Any:
    return _side_by_side(pandas, [
        pandas.DataFrame({(name, key): force[key] for key in ("force", "lower95", "upper95")},
                         index=force["time"])
        for name, force in outcome.forces.items()], "time")


def _loops(outcome: Any, pandas: Any) -> Any:
    keys = ["term", "output", "record"]
    parts = []
    for loop in outcome.loops:
        rate = loop["rate"] if len(loop["rate"]) else np.nan
        part = pandas.DataFrame({"time": loop["time"], "deformation": loop["deformation"],
                                 "rate": rate, "force": loop["force"]})
        parts.append(part.assign(**{key: loop[key] for key in keys}))
    if not parts:
        return pandas.DataFrame(columns=keys).set_index(keys)
    return pandas.concat(parts).set_index(keys)


def _ambient(outcome: Any, pandas: Any) -> Any:
    return _side_by_side(pandas, [
        pandas.DataFrame({(name, channel, key): score[key][row] for row, channel
                          in enumerate(score["channels"]) for key in ("measured", "modelled")},
                         index=score["frequencies_hz"])
        for name, score in outcome.ambient.items()], "frequency_hz")


def _mode_shapes(outcome: Any, pandas: Any) -> Any:
    dofs, pairs = shape_pairs(outcome, len(outcome.modes))
    columns = {}
    for pair in pairs:
        columns[pair.number, "initial"] = pair.initial
        columns[pair.number, "updated"] = pair.updated
    return pandas.DataFrame(columns, index=pandas.Index(dofs, name="dof"))


def _record(outcome: Any, name: str, pandas: Any) -> Any:
    record = outcome.record(name)
    columns = {}
    before = outcome.before(name)
    for channel, values in record.measured.items():
        missing = np.full(len(record.time), np.nan)
        columns[channel, "measured"] = values
        columns[channel, "predicted"] = record.predicted.get(channel, missing)
        columns[channel, "deviation"] = record.deviation.get(channel, missing)
        columns[channel, "before"] = before.get(channel, missing)
    return pandas.DataFrame(columns, index=pandas.Index(record.time, name="time"))


_FRAMES = {
    "parameters": _parameters,
    "history": lambda outcome, pandas: pandas.DataFrame(outcome.history),
    "stages": lambda outcome, pandas: pandas.DataFrame(outcome.json["solver"]["stages"]),
    "modes": lambda outcome, pandas: pandas.DataFrame(outcome.modes),
    "changes": _changes,
    "equations": _equations,
    "pareto": _pareto,
    "profiles": _profiles,
    "forces": _forces,
    "loops": _loops,
    "ambient": _ambient,
    "mode_shapes": _mode_shapes,
}
