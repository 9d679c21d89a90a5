"""The figures of the report, drawn by matplotlib.

Each function takes a result and returns a `matplotlib.figure.Figure`, or None
where there is nothing to draw.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._pinode import Error

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_GREY, _BLUE, _RED = "0.45", "#1f6fb4", "#c0392b"


def _figure(rows: int = 1, width: float = 7.0, height: float = 2.4) -> Any:
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise Error("matplotlib is missing, expected it for figures") from None

    figure = Figure(figsize=(width, max(1, rows) * height), layout="constrained")
    return figure, figure.subplots(max(1, rows), 1, squeeze=False)[:, 0]


def all_figures(outcome: Any) -> "dict[str, Figure]":
    """All that the result has, by name."""
    drawn = {
        "changes": changes(outcome),
        "parameters": parameters(outcome),
        "modes": modes(outcome),
        "convergence": convergence(outcome),
        "loops": loops(outcome),
        "forces": forces(outcome),
        "profiles": profiles(outcome),
        "ambient": ambient(outcome),
        "equations": equations(outcome),
    }
    for name in outcome.records:
        drawn[f"prediction_{name}"] = prediction(outcome, name)
    return {name: figure for name, figure in drawn.items() if figure is not None}


def of_modes(found: Any) -> "dict[str, Figure]":
    """Of identified modes: stabilisation diagrams and shapes, by name."""
    drawn = {
        f"stabilisation_{record}": stabilisation(found, record) for record in found.methods
    }
    drawn["shapes"] = identified_shapes(found)
    return {name: figure for name, figure in drawn.items() if figure is not None}


def stabilisation(found: Any, record: str) -> "Figure | None":
    """Poles of all orders of a record; those of a mode are filled."""
    bands = [band for band in found.diagram if band["record"] == record]
    if not any(len(band["order"]) for band in bands):
        return None
    figure, (ax,) = _figure(1, height=3.4)
    for band in bands:
        hz, order = band["frequency_hz"], np.asarray(band["order"])
        of_mode = np.asarray(band["mode"]) >= 0
        ax.plot(hz[~of_mode], order[~of_mode], "o", ms=3, mfc="none", color="0.7")
        ax.errorbar(hz[of_mode], order[of_mode], xerr=1.96 * band["frequency_sigma"][of_mode],
                    fmt="o", ms=3, color=_BLUE)
    ax.set_xlabel("frequency (Hz)")
    ax.set_ylabel("model order")
    ax.set_title(record, loc="left")
    return figure


def identified_shapes(found: Any, *, most: int = 16) -> "Figure | None":
    """Real parts of the first shapes with 95 % intervals, place by place."""
    modes = list(found)[:most]
    if not modes:
        return None
    figure, axes = _figure(len(modes), height=1.5)
    for ax, mode in zip(axes, modes):
        ax.errorbar(range(len(found.places)), mode["shape"].real,
                    yerr=1.96 * mode["shape_sigma_real"], fmt="o", ms=3, color=_BLUE)
        ax.axhline(0.0, color=_GREY, lw=0.8)
        ax.set_ylabel(f"{mode['frequency_hz']:.4g} Hz")
        ax.set_xticks([])
    axes[-1].set_xticks(range(len(found.places)), found.places, rotation=90)
    return figure


def prediction(
    outcome: Any, record: str | None = None, *, most: int = 12
) -> "Figure | None":
    """Time histories of a record: measured, and the free run of the model with
    its 95 % band; of the `most` channels that are predicted worst."""
    result = outcome.record(record)
    if not result.predicted:
        return None
    error = {
        name: np.nanmean((result.measured[name] - values) ** 2)
        / max(np.nanvar(result.measured[name]), 1e-300)
        for name, values in result.predicted.items()
    }
    names = sorted(error, key=lambda name: -error[name])[:most]
    figure, axes = _figure(len(names))
    for ax, name in zip(axes, names):
        values = result.predicted[name]
        ax.plot(result.time, result.measured[name], color=_GREY, lw=1.2, label="measured")
        ax.plot(result.time, values, color=_BLUE, lw=0.9, label="model")
        band = result.deviation.get(name)
        if band is not None and np.isfinite(band).all():
            ax.fill_between(result.time, values - 1.96 * band, values + 1.96 * band,
                            color=_BLUE, alpha=0.2, lw=0)
        ax.set_ylabel(f"{name} ({result.units[name]})")
    axes[0].legend(loc="upper right")
    axes[-1].set_xlabel("time (s)")
    return figure


def parameters(outcome: Any) -> "Figure | None":
    """Changes of the free parameters with their 95 % intervals, each in units
    of its own value where that is not a fraction already."""
    free = [p for p in outcome.parameters.values() if p.free and np.isfinite(p.sigma)]
    if not free:
        return None
    figure, (ax,) = _figure(1, height=1.0 + 0.35 * len(free))
    scale = [1.0 if p.unit == "1" else abs(p.value) or 1.0 for p in free]
    value = np.array([p.value / s for p, s in zip(free, scale)])
    spread = np.array([[(p.value - p.lower95) / s, (p.upper95 - p.value) / s]
                       for p, s in zip(free, scale)]).T
    places = np.arange(len(free))
    ax.errorbar(value, places, xerr=np.maximum(spread, 0.0), fmt="o", color=_BLUE, capsize=3)
    ax.plot([p.initial / s for p, s in zip(free, scale)], places, "x", color=_GREY,
            label="before")
    ax.axvline(0.0, color="0.8", lw=0.8, zorder=0)
    ax.set_yticks(places, [p.name if s == 1.0 else f"{p.name} / {s:.3g} {p.unit}"
                           for p, s in zip(free, scale)])
    ax.invert_yaxis()
    ax.set_xlabel("value")
    ax.legend()
    return figure


def changes(outcome: Any) -> "Figure | None":
    """What has changed since the healthy records, with 95 % intervals."""
    groups = list(getattr(outcome, "groups", {}).values())
    groups = [g for g in groups if g["change"] is not None and g["lower95"] is not None]
    if not groups:
        return None
    figure, (ax,) = _figure(1, height=1.0 + 0.35 * len(groups))
    for place, group in enumerate(groups):
        low, high = group["lower95"], group["upper95"]
        ax.plot([100 * low, 100 * high], [place, place], lw=2,
                color=_RED if group["damaged"] else _BLUE)
        ax.plot(100 * group["change"], place, "o", color=_RED if group["damaged"] else _BLUE)
    ax.axvline(0.0, color="0.8", lw=0.8, zorder=0)
    ax.set_yticks(range(len(groups)), [g["name"] for g in groups])
    ax.invert_yaxis()
    ax.set_xlabel("change (%)")
    return figure


def modes(outcome: Any) -> "Figure | None":
    """Frequencies of the model before and after."""
    pairs = [m for m in outcome.modes if m["initial_hz"] and m["updated_hz"]]
    if not pairs:
        return None
    figure, (ax,) = _figure(1, height=2.8)
    places = np.arange(1, len(pairs) + 1)
    ax.bar(places - 0.2, [m["initial_hz"] for m in pairs], 0.4, color="0.7", label="before")
    ax.bar(places + 0.2, [m["updated_hz"] for m in pairs], 0.4, color=_BLUE, label="after")
    ax.set_xticks(places)
    ax.set_xlabel("mode")
    ax.set_ylabel("frequency (Hz)")
    ax.legend()
    return figure


def convergence(outcome: Any) -> "Figure | None":
    """The cost by iteration."""
    history = outcome.history
    if len(history["cost"]) == 0:
        return None
    figure, (ax,) = _figure(1)
    cost = history["cost"]
    ax.plot(np.arange(1, len(cost) + 1), cost, color=_BLUE, lw=1)
    if (cost > 0.0).all():
        ax.set_yscale("log")
    ax.set_xlabel("iteration")
    ax.set_ylabel("cost")
    return figure


def loops(outcome: Any) -> "Figure | None":
    """Forces of elements, libraries and networks over their deformation."""
    curves = outcome.loops
    if not curves:
        return None
    figure, axes = _figure(len(curves), width=5.0, height=3.2)
    for ax, loop in zip(axes, curves):
        ax.plot(loop["deformation"], loop["force"], color=_BLUE, lw=0.8)
        ax.set_title(" ".join(filter(None, [loop["term"], loop["output"]])))
        ax.set_xlabel(f"{loop['deformation_name']} ({loop['deformation_unit']})")
        what = "acceleration" if loop["is_acceleration"] else "force"
        ax.set_ylabel(f"{what} ({loop['force_unit']})")
    return figure


def forces(outcome: Any) -> "Figure | None":
    """Unknown forces with their 95 % bands."""
    found = outcome.forces
    if not found:
        return None
    figure, axes = _figure(len(found))
    for ax, (name, force) in zip(axes, found.items()):
        if np.isfinite(force["lower95"]).all() and np.isfinite(force["upper95"]).all():
            ax.fill_between(force["time"], force["lower95"], force["upper95"],
                            color=_BLUE, alpha=0.2, lw=0)
        ax.plot(force["time"], force["force"], color=_BLUE, lw=1)
        ax.set_ylabel(name)
    axes[-1].set_xlabel("time (s)")
    return figure


def profiles(outcome: Any) -> "Figure | None":
    """Profiles of the likelihood."""
    found = outcome.profiles
    if not found:
        return None
    figure, axes = _figure(len(found), width=5.0, height=2.6)
    for ax, (name, profile) in zip(axes, found.items()):
        ax.plot(profile["values"], profile["likelihood_ratios"], "o-", color=_BLUE, ms=3)
        ax.axhline(profile["threshold95"], color=_GREY, lw=0.8, ls="--")
        ax.set_xlabel(f"{name} ({profile['unit']})")
        ax.set_ylabel("likelihood ratio")
    return figure


def ambient(outcome: Any) -> "Figure | None":
    """Spectral densities of ambient records, measured and modelled."""
    panels = [
        (name, channel, score, row)
        for name, score in outcome.ambient.items()
        for row, channel in enumerate(score["channels"])
    ]
    if not panels:
        return None
    figure, axes = _figure(len(panels))
    for ax, (name, channel, score, row) in zip(axes, panels):
        ax.semilogy(score["frequencies_hz"], score["measured"][row], color=_GREY, lw=1,
                    label="measured")
        ax.semilogy(score["frequencies_hz"], score["modelled"][row], color=_BLUE, lw=1,
                    label="model")
        ax.set_ylabel(f"{name}, {channel}")
    axes[0].legend()
    axes[-1].set_xlabel("frequency (Hz)")
    return figure


def equations(outcome: Any) -> "Figure | None":
    """What each number of terms leaves of what was regressed."""
    curves = [e for e in getattr(outcome, "equations", []) if e["pareto"]]
    if not curves:
        return None
    figure, axes = _figure(len(curves), width=5.0)
    for ax, equation in zip(axes, curves):
        points = equation["pareto"]
        ax.semilogy([p["terms"] for p in points], [p["residual"] for p in points], "o-",
                    color=_BLUE, ms=4)
        ax.axvline(len(equation["terms"]), color=_RED, lw=0.8, ls="--")
        ax.set_xlabel("terms")
        ax.set_ylabel(f"residual, {equation['output']}")
    return figure
