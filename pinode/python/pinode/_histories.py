"""Figures over time: records, forces, loops of devices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._drawing import BLUE, FAINT, MARK, MEASURED, PRIOR, TRUE, UPDATED, band, blank, label, panels
from ._mode_shapes import SECONDS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Their loop says everything: there is no force over the rate.
_SPRINGS = ("cubic", "quadratic_stiffness", "bilinear", "bouc_wen", "backlash_friction", "play",
            "iwan", "baber_noori")
_MOST_LOOP_SAMPLES = 2000
# Number of samples of a known force in a panel; fewer are drawn as dots.
_FEW_SAMPLES = 50


def prediction(
    outcome: Any, record: str | None = None, *, most: int = 12
) -> "Figure | None":
    """Measured and simulated values of a record, for the `most` channels that are
    predicted worst. Default: the first record.

    The first panel shows the whole record with the 95 % band of the simulation, the
    second its strongest part. The third shows the error, with plus and minus two
    sigma of the noise. The simulation of the initial model is drawn too, unless it
    diverges.
    """
    result = outcome.record(record)
    if not result.predicted or len(result.time) < 2:
        return None
    if record is None:
        record = next(iter(outcome.records))
    score = outcome.records[record]
    channels = {c["name"]: c for c in score["channels"]}
    before = outcome.before(record)
    unit = time_units(outcome)[record]

    def error(name: str) -> float:
        value = channels[name]["nrmse"] if name in channels else 0.0
        return np.inf if value is None else value

    worst = sorted(result.predicted, key=lambda name: -error(name))[:most]
    names = [name for name in result.predicted if name in worst]
    figure = blank(9.0, 4.0 * len(names))
    grid = figure.add_gridspec(2 * len(names), 2)
    for row, name in enumerate(names):
        whole = figure.add_subplot(grid[2 * row, :])
        part = figure.add_subplot(grid[2 * row + 1, 0])
        rest = figure.add_subplot(grid[2 * row + 1, 1])
        measured, predicted = result.measured[name], result.predicted[name]
        strongest = _strongest_part(outcome, measured, result.time, unit)
        half = 1.96 * result.deviation.get(name, np.full(len(predicted), np.nan))
        for ax, where in ((whole, slice(None)), (part, strongest)):
            time = result.time[where]
            band(ax, time, (predicted - half)[where], (predicted + half)[where],
                 label="95 % of measurements")
            ax.plot(time, measured[where], label="measured", **MEASURED)
            if name in before:
                ax.plot(time, before[name][where], label="initial model", zorder=1.9, **PRIOR)
            ax.plot(time, predicted[where], label="model", **UPDATED)
            ax.set_ylabel(label(name, result.units[name]))
            ax.set_ylim(*_range(measured, predicted, before.get(name)))
            ax.margins(x=0.0)
        first = score["first_scored_sample"]
        if 0 < first < len(result.time):
            whole.axvline(result.time[first], **FAINT)
            whole.annotate("scored from here", (result.time[first], 0.04),
                           xycoords=("data", "axes fraction"), size="small", color="0.33")
        whole.set_title(_title(name, score, channels.get(name)), loc="left")
        rest.plot(result.time, measured - predicted, **UPDATED)
        sigma = channels[name]["sigma"] if name in channels else None
        if sigma:
            for side in (-2.0 * sigma, 2.0 * sigma):
                rest.axhline(side, color=MARK, lw=0.9, ls="--")
        rest.set_ylabel(label("residual", result.units[name]))
        rest.margins(x=0.0)
        for ax in (part, rest):
            ax.set_xlabel(label("time", unit))
        if row == 0:
            whole.legend(loc="upper right", ncols=4, fontsize="small")
    return figure


def time_units(outcome: Any) -> "dict[str, str]":
    """Returns the unit of time of each record's file, by record."""
    return {table["name"]: table.get("time_unit", "s")
            for table in outcome.case.to_dict().get("record", [])}


def _title(name: str, score: dict[str, Any], channel: "dict[str, Any] | None") -> str:
    role = "hold-out" if score["role"] == "holdout" else "training"
    text = f"{name} in {score['name']} ({role})"
    for key, words in (("nrmse", "error"), ("prior_nrmse", "initial model")):
        if channel is not None and channel[key] is not None:
            text += f", {words} {100.0 * channel[key]:.3g} %"
    return text


def _range(measured: np.ndarray, *predicted: Any) -> tuple[float, float]:
    """Returns the range of the measured values, and of the predicted ones unless they
    are much larger: the initial model may diverge.
    """
    there = measured[np.isfinite(measured)]
    low, high = (there.min(), there.max()) if len(there) else (0.0, 0.0)
    room = max(high - low, 1e-300)
    least, most = low - 0.5 * room, high + 0.5 * room
    for values in predicted:
        values = values[np.isfinite(values)] if values is not None else ()
        if len(values):
            low = min(low, max(values.min(), least))
            high = max(high, min(values.max(), most))
    margin = 0.05 * max(high - low, 1e-300)
    return low - margin, high + margin


def _strongest_part(
    outcome: Any, values: np.ndarray, time: np.ndarray, unit: str
) -> slice:
    """Returns the range around the largest fluctuation, about six periods of the first
    mode. A free decay begins at its peak.
    """
    size = len(values)
    if not np.isfinite(values).any():
        return slice(0, size)
    peak = int(np.nanargmax(np.abs(values - np.nanmean(values))))
    wanted = size / 8.0
    modes = outcome.modes
    if modes and modes[0]["updated_hz"]:
        step = (time[1] - time[0]) / SECONDS.get(unit, 1.0)
        wanted = 6.0 / (modes[0]["updated_hz"] * step)
    count = int(np.clip(wanted, min(60.0, size), max(60.0, size / 3.0)))
    count = min(count, size)
    first = int(np.clip(peak - count // 3, 0, size - count))
    return slice(first, first + count)


def forces(outcome: Any) -> "Figure | None":
    """Unknown forces with 95 % bands, and the true force if the case gives one: the
    whole force, and its largest part.
    """
    found = {name: force for name, force in outcome.forces.items()
             if len(force["force"]) > 1 and np.isfinite(force["force"]).all()}
    if not found:
        return None
    units = time_units(outcome)
    figure, axes = panels(2 * len(found), 2, width=9.0, height=2.8)
    for number, (name, force) in enumerate(found.items()):
        record, truth = force["record"], force.get("truth")
        whole, part = axes[2 * number : 2 * number + 2]
        for ax, where in ((whole, slice(None)), (part, _largest_part(force["force"]))):
            time, low, high = (force[k][where] for k in ("time", "lower95", "upper95"))
            band(ax, time, low, high, label="95 % band")
            if truth is not None:
                _draw_truth(ax, truth, time, as_dots=ax is part)
            ax.plot(time, force["force"][where], label="identified", **UPDATED)
            ax.set_xlabel(label("time", units[record]))
            ax.set_xlim(time[0], time[-1])
        whole.set_ylabel(label(name, force["unit"]))
        whole.set_title(f"in {record}", loc="left")
        whole.legend(fontsize="small")
    return figure


def _draw_truth(
    ax: Any, truth: "dict[str, np.ndarray]", time: np.ndarray, as_dots: bool
) -> None:
    """Draws the true force. If a part has few samples, they are dots, because a line
    between them would be wrong for a blow.
    """
    shown = (truth["time"] >= time[0]) & (truth["time"] <= time[-1])
    if as_dots and shown.sum() < _FEW_SAMPLES:
        ax.plot(truth["time"][shown], truth["force"][shown], "o", ms=3, color=TRUE["color"],
                label="truth")
    else:
        ax.plot(truth["time"], truth["force"], label="truth", **TRUE)


def _largest_part(force: np.ndarray) -> slice:
    """Returns the range with the middle 90 % of the force's energy, and as much on both
    sides. If the force lasts for most of the record, returns an eighth of it around
    the peak.
    """
    size = len(force)
    energy = np.concatenate([[0.0], np.cumsum(force**2)[:-1]])
    total = np.sum(force**2)
    begin = int(np.flatnonzero(energy < 0.05 * total).max(initial=0))
    end = int(np.flatnonzero(energy < 0.95 * total).max()) if total else size - 1
    length = end - begin + 1
    short = length < size / 3
    count = min(size, max(3 * length if short else size // 8, 40))
    middle = (begin + end) // 2 if short else int(np.argmax(np.abs(force)))
    first = int(np.clip(middle - count // 2, 0, size - count))
    return slice(first, first + count)


def loops(outcome: Any) -> "Figure | None":
    """Forces of elements, libraries and networks over their deformation, and over its
    rate unless the law is a spring.

    For a long record the figure shows only the part around the largest deformation.
    Known forces are drawn over the deformation that has occurred.
    """
    curves = [c for c in outcome.loops
              if len(c["force"]) > 1 and np.isfinite(c["force"]).all()]
    if not curves:
        return None
    both = any(_has_rate(c) for c in curves)
    figure, axes = panels(len(curves) * (2 if both else 1), 2 if both else 1,
                          width=9.0 if both else 5.0, height=3.2)
    for number, loop in enumerate(curves):
        count = min(len(loop["force"]), _MOST_LOOP_SAMPLES)
        peak = int(np.argmax(np.abs(loop["deformation"])))
        first = int(np.clip(peak - count // 2, 0, len(loop["force"]) - count))
        where = slice(first, first + count)
        row = axes[number * (2 if both else 1):]
        what = "acceleration" if loop["is_acceleration"] else "force"
        for ax, over in zip(row, ("deformation", "rate") if both else ("deformation",)):
            if over == "rate" and not _has_rate(loop):
                ax.remove()
                continue
            known = loop.get("known") if over == "deformation" else None
            if known is not None:
                low, high = loop[over].min(), loop[over].max()
                margin = 0.05 * (high - low)
                ax.plot(known["deformation"], known["force"], label=known["name"], **MEASURED)
                ax.set_xlim(low - margin, high + margin)
            ax.plot(loop[over][where], loop["force"][where], color=BLUE, lw=0.8,
                    label="identified")
            if known is not None:
                ax.legend(fontsize="small")
            ax.set_xlabel(label(loop[f"{over}_name"], loop[f"{over}_unit"]))
            ax.set_ylabel(label(what, loop["force_unit"]))
            ax.locator_params(axis="x", nbins=5)
        name = " ".join(filter(None, [loop["term"], loop["output"]]))
        row[0].set_title(f"{name} in {loop['record']}", loc="left")
    return figure


def _has_rate(loop: "dict[str, Any]") -> bool:
    return loop["type"] not in _SPRINGS and len(loop["rate"]) == len(loop["force"])
