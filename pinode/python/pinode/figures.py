"""Figures of the report, drawn by matplotlib.

Each function takes a result and returns a `matplotlib.figure.Figure`, or None if
there is nothing to draw.
"""

from __future__ import annotations

import functools
import numbers
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ._drawing import (
    BLUE,
    FAINT,
    GREY,
    MARK,
    PRIOR,
    UPDATED,
    band,
    bars,
    decibels,
    label,
    panels,
)
from ._arguments import words_of
from ._forecast_figures import planned, simulated
from ._histories import forces, loops, prediction
from ._modal_figures import fdd, mac
from ._mode_shapes import shape_pairs
from ._pinode import Error

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "all_figures",
    "ambient",
    "changes",
    "convergence",
    "equation_features",
    "equations",
    "fdd",
    "forces",
    "identified_shapes",
    "loops",
    "mac",
    "modal_spectra",
    "mode_shapes",
    "modes",
    "of_modes",
    "parameters",
    "planned",
    "prediction",
    "profiles",
    "simulated",
    "stabilisation",
]

_MOST_BARS = 40


def all_figures(outcome: Any) -> "dict[str, Figure]":
    """Returns all figures of the result, by name."""
    drawn = {
        "changes": changes(outcome),
        "parameters": parameters(outcome),
        "forces": forces(outcome),
        "profiles": profiles(outcome),
        "ambient": ambient(outcome),
        "modes": modes(outcome),
        "mode_shapes": mode_shapes(outcome),
        "convergence": convergence(outcome),
        "loops": loops(outcome),
        "equation_features": equation_features(outcome),
        "equations": equations(outcome),
    }
    records = outcome.records
    # Records that were not fitted come first.
    for name in sorted(records, key=lambda name: records[name]["role"] != "holdout"):
        drawn[f"prediction_{name}"] = prediction(outcome, name)
    return {name: figure for name, figure in drawn.items() if figure is not None}


def of_modes(found: Any) -> "dict[str, Figure]":
    """Returns the figures of identified modes by name: stabilisation diagrams, spectra,
    singular values, shapes and MAC.
    """
    drawn = {}
    for record in found.methods:
        drawn[f"stabilisation_{record}"] = stabilisation(found, record)
        drawn[f"spectra_{record}"] = modal_spectra(found, record)
        drawn[f"fdd_{record}"] = fdd(found, record)
    drawn["shapes"] = identified_shapes(found)
    drawn["mac"] = mac(found)
    return {name: figure for name, figure in drawn.items() if figure is not None}


def stabilisation(found: Any, record: str) -> "Figure | None":
    """Stabilisation diagram of a record: poles of all orders, over the singular values
    of the spectra of all channels. Filled poles belong to a mode and have 95 %
    intervals.
    """
    bands = [analysed for analysed in found.diagram if analysed["record"] == record]
    if not any(len(analysed["order"]) for analysed in bands):
        return None
    figure, (ax,) = panels(height=3.4)
    for number, analysed in enumerate(bands):
        hz, order = analysed["frequency_hz"], np.asarray(analysed["order"])
        of_mode = np.asarray(analysed["mode"]) >= 0
        ax.plot(hz[~of_mode], order[~of_mode], "x", ms=3, color=PRIOR["color"],
                label="" if number else "other poles")
        ax.errorbar(hz[of_mode], order[of_mode], xerr=1.96 * analysed["frequency_sigma"][of_mode],
                    fmt="o", ms=3, color=BLUE, label="" if number else "poles of a mode")
    low, high = _frequency_range(found, bands)
    spectra = found.spectra[record]
    behind = ax.twinx()
    inside = (spectra["singular_hz"] >= low) & (spectra["singular_hz"] <= high)
    for values, shade in zip(spectra["singular_values"], ("0.53", "0.73", "0.87")):
        behind.plot(spectra["singular_hz"][inside], decibels(values[inside]), color=shade,
                    lw=0.8, zorder=0)
    behind.set_ylabel("singular values of the spectra (dB)")
    ax.set_zorder(behind.get_zorder() + 1)
    ax.patch.set_visible(False)
    ax.set_xlim(low, high)
    ax.set_ylim(bottom=0.0)
    ax.set_xlabel("frequency (Hz)")
    ax.set_ylabel("model order")
    ax.set_title(record, loc="left")
    ax.legend(loc="upper right", fontsize="small")
    return figure


def _frequency_range(found: Any, bands: Any) -> tuple[float, float]:
    """Returns a range around the modes, or the analysed range if there are none."""
    low = min(band["lowest_hz"] for band in bands)
    high = max(band["highest_hz"] for band in bands)
    hz = found.frequencies_hz
    hz = hz[(hz >= low) & (hz <= high)]
    if len(hz) == 0:
        return low, high
    return max(0.0, min(0.5 * hz.min(), hz.min() - 1.0)), min(high, 1.25 * hz.max())


def modal_spectra(found: Any, record: str, *, most: int = 6) -> "Figure | None":
    """Spectral densities of the first `most` channels of a record, and those of its
    modes with noise, in dB of the channel's unit squared per Hz.
    """
    spectra = found.spectra[record]
    hz = spectra["frequency_hz"]
    channels = spectra["channels"][:most]
    if len(hz) < 2 or not channels:
        return None
    figure, axes = panels(len(channels), min(2, len(channels)), width=9.0, height=2.4)
    for row, (ax, channel) in enumerate(zip(axes, channels)):
        ax.plot(hz, decibels(spectra["measured"][row]), label="measured", **FAINT)
        ax.plot(hz, decibels(spectra["modelled"][row]), label="modes", **UPDATED)
        ax.set_title(f"{channel}, {100.0 * spectra['explained'][row]:.3g} % explained",
                     loc="left", size="medium")
        ax.set_xlabel("frequency (Hz)")
        ax.set_ylabel("density (dB)")
        ax.margins(x=0.0)
        if row == 0:
            ax.legend(fontsize="small")
    return figure


def identified_shapes(found: Any, *, most: int = 16) -> "Figure | None":
    """Real parts of the first `most` shapes with 95 % intervals, place by place."""
    modes = list(found)[:most]
    if not modes or len(found.places) < 2:
        return None
    count = len(found.places)
    figure, axes = panels(len(modes), 4, width=2.2 * min(len(modes), 4) + 0.8,
                          height=float(np.clip(1.0 + 0.15 * count, 1.6, 3.4)))
    for number, (ax, mode) in enumerate(zip(axes, modes), 1):
        # Student's: an interval's half-width over its sigma.
        sigma = mode["frequency_sigma"]
        t = (mode["frequency_upper95"] - mode["frequency_hz"]) / sigma if sigma else 1.96
        ax.errorbar(mode["shape"].real, np.arange(count), xerr=t * mode["shape_sigma_real"],
                    fmt="o", ms=3, color=BLUE)
        ax.axvline(0.0, color=GREY, lw=0.8)
        ax.set_xlim(-1.25, 1.25)
        ax.set_title(f"{number}: {mode['frequency_hz']:.4g} Hz", size="medium")
        _name_places(ax, found.places, 20)
    return figure


def _name_places(ax: Any, names: Any, most: int) -> None:
    every = -(-len(names) // most)
    ax.set_yticks(range(0, len(names), every), names[::every])
    ax.set_ylim(-0.5, len(names) - 0.5)


def parameters(outcome: Any) -> "Figure | None":
    """Changes of the free parameters with 95 % intervals, in per cent of the initial
    value.

    Changes of groups are in per cent of the group's own matrix. Other parameters with
    an initial value of zero have no such change; the title names them.
    """
    groups = {group.get("name") for group in outcome.case.to_dict().get("group", [])}
    rows, left_out = [], []
    for p in outcome.parameters.values():
        if not p.free:
            continue
        scale = 1.0 if p.name in groups else abs(p.initial)
        if not scale > 0.0 or not np.isfinite(p.value):
            left_out.append(p.name)
            continue
        change, low, high = (100.0 * (v - p.initial) / scale
                             for v in (p.value, p.lower95, p.upper95))
        # Without an interval there is a point and no bar.
        rows.append((p.name, change, low if np.isfinite(low) else change,
                     high if np.isfinite(high) else change))
    if not rows:
        return None
    rows = rows[:_MOST_BARS]
    figure, (ax,) = panels(height=1.2 + 0.28 * len(rows))
    names, changes, lows, highs = zip(*rows)
    bars(ax, names, changes, lows, highs, ["#9cc7e0"] * len(rows))
    if left_out:
        ax.set_title("zero initially, not drawn: " + ", ".join(left_out), loc="left",
                     size="small", wrap=True)
    return figure


def changes(outcome: Any) -> "Figure | None":
    """Changes relative to the baselines, with 95 % intervals.

    The colour shows the probability of a loss above the threshold (dashed line): grey
    is 0, orange 50 %, red 100 %. Masses and nonlinear forces are shown if they were
    found.
    """
    rows = getattr(outcome, "changes", [])
    # If the data do not determine a change, its numbers are rounding errors.
    rows = [row for row in rows
            if None not in (row["change"], row["lower95"], row["upper95"])
            and row["upper95"] - row["lower95"] < 20.0][:_MOST_BARS]
    if not rows:
        return None
    figure, (ax,) = panels(height=1.2 + 0.28 * len(rows))
    bars(ax, [row["name"] for row in rows],
         *([100.0 * row[key] for row in rows] for key in ("change", "lower95", "upper95")),
         [_colour(row["probability"] if row["target"] == "stiffness" else 0.0) for row in rows])
    ax.axvline(-100.0 * outcome.damage_json["threshold"], color="0.53", lw=0.8, ls="--")
    return figure


def _colour(probability: "float | None") -> Any:
    stops = np.array([[190.0, 190.0, 190.0], [240.0, 180.0, 60.0], [213.0, 40.0, 0.0]]) / 255.0
    return [np.interp(probability or 0.0, (0.0, 0.5, 1.0), stops[:, k]) for k in range(3)]


def modes(outcome: Any) -> "Figure | None":
    """Frequencies of the initial and the updated model."""
    pairs = [m for m in outcome.modes if m["initial_hz"] and m["updated_hz"]]
    if not pairs:
        return None
    figure, (ax,) = panels(height=2.8)
    places = np.arange(1, len(pairs) + 1)
    ax.bar(places - 0.2, [m["initial_hz"] for m in pairs], 0.4, color=PRIOR["color"],
           label="initial")
    ax.bar(places + 0.2, [m["updated_hz"] for m in pairs], 0.4, color=BLUE, label="updated")
    ax.set_xticks(places)
    ax.set_xlabel("mode")
    ax.set_ylabel("frequency (Hz)")
    ax.legend()
    return figure


def mode_shapes(outcome: Any, *, most: int = 6) -> "Figure | None":
    """First `most` mode shapes of the linear part, initial and updated, over the DOFs
    in the model's order. The largest entry is 1.
    """
    dofs, pairs = shape_pairs(outcome, most)
    if len(dofs) < 2 or not pairs:
        return None
    figure, axes = panels(len(pairs), 3, width=2.8 * min(len(pairs), 3) + 0.8, height=2.6)
    for number, (ax, pair) in enumerate(zip(axes, pairs)):
        places = np.arange(len(dofs))
        ax.plot(pair.initial, places, "o", ls=PRIOR["ls"], color=PRIOR["color"], ms=5,
                mfc="none", lw=1.0, label="initial")
        ax.plot(pair.updated, places, "o-", color=BLUE, ms=3.5, lw=1.0, label="updated")
        ax.axvline(0.0, color=GREY, lw=0.8, zorder=0)
        ax.set_xlim(-1.15, 1.15)
        _name_places(ax, dofs, 12)
        ax.set_title(f"mode {pair.number}: {pair.initial_hz:.4g} \u2192 {pair.updated_hz:.4g} Hz",
                     size="medium")
        if number == 0:
            ax.legend(fontsize="small")
    return figure


def convergence(outcome: Any) -> "Figure | None":
    """Cost by iteration, also of rejected steps. Vertical lines separate the stages;
    the number above each stage is the length of its longest segment in samples.

    The lower panel shows the error of the simulations of the training records after
    each stage.
    """
    history = outcome.history
    cost, stage = history["cost"], history["stage"]
    if len(cost) < 2:
        return None
    ends = np.append(np.flatnonzero(np.diff(stage)) + 0.5, len(cost) - 0.5)
    solver = outcome.json["solver"]
    stages = solver["stages"]
    after = [(end, 100.0 * s["free_run_error"]) for end, s in zip(ends, stages)
             if s["free_run_error"]]
    figure, axes = panels(2 if after else 1)
    ax = axes[0]
    drawn = np.where(cost > 0.0, cost, np.nan)
    taken = np.asarray(history["accepted"], dtype=bool)
    number = np.arange(len(cost))
    if np.isfinite(drawn[taken]).any():
        ax.semilogy(number[taken], drawn[taken], "o-", ms=2.5, label="accepted", **UPDATED)
        if not taken.all():
            # Of a step that is not taken the cost may be any number.
            most = 10.0 * np.nanmax(drawn[taken])
            ax.semilogy(number[~taken], np.minimum(drawn[~taken], most), "x", ms=4, color=MARK,
                        label="rejected")
            ax.legend(fontsize="small")
    for end in ends[:-1]:
        ax.axvline(end, **FAINT)
    for begin, end, s in zip(np.append(-0.5, ends), ends, stages):
        # Short stages have no room for words.
        if s["segment_samples"] and end - begin > 0.05 * len(cost):
            ax.annotate(str(s["segment_samples"]), (0.5 * (begin + end), 1.02),
                        xycoords=("data", "axes fraction"), ha="center", size="small",
                        color="0.33")
    ax.set_ylabel("cost")
    if after:
        axes[1].semilogy(*zip(*after), "o-", ms=4, clip_on=False, **UPDATED)
        for end, error in after:
            axes[1].annotate(f"{error:.3g}", (end, error), xytext=(-2, 5),
                             textcoords="offset points", ha="right", size="small")
        axes[1].margins(y=0.3)
        axes[1].set_ylabel("simulation error (%)")
    for ax in axes:
        ax.set_xlim(-0.5, len(cost) - 0.5)
    axes[-1].set_xlabel("iteration")
    return figure


def profiles(outcome: Any) -> "Figure | None":
    """Profiles of the likelihood with the thresholds of 95 and 99 %. The grey parabola
    is that of the linear interval.
    """
    found = {name: p for name, p in outcome.profiles.items() if len(p["values"]) > 2}
    if not found:
        return None
    about = {p["name"]: p for p in outcome.json["profiles"]}
    linear = outcome.parameters
    figure, axes = panels(len(found), 2, width=4.5 * min(len(found), 2), height=3.0)
    for ax, (name, profile) in zip(axes, found.items()):
        values, ratios = profile["values"], profile["likelihood_ratios"]
        best = about[name]["value"]
        top95, top99 = profile["threshold95"], profile["threshold99"]
        top = 1.6 * top99
        half = 0.5 * (linear[name].upper95 - linear[name].lower95)
        if np.isfinite(half) and half > 0.0:
            x = best + half * np.sqrt(top / top95) * np.linspace(-1.0, 1.0, 61)
            ax.plot(x, top95 * ((x - best) / half) ** 2, **FAINT)
        # The root is a straight line on either side of a parabola, and is taken as
        # one from point to point.
        roots = np.sqrt(np.maximum(ratios, 0.0))
        x = np.interp(np.arange(0.0, len(values) - 1 + 1e-9, 1 / 12), np.arange(len(values)),
                      values)
        ax.plot(x, np.interp(x, values, roots) ** 2, color=BLUE, lw=1.4)
        ax.plot(values, ratios, "o", color=BLUE, ms=3)
        for level, words in ((top95, "95 %"), (top99, "99 %")):
            ax.axhline(level, ls="--", **FAINT)
            ax.annotate(words, (0.99, level), xycoords=("axes fraction", "data"), ha="right",
                        va="bottom", size="small", color="0.4")
        ends = [about[name][end] for end in ("lower99", "upper99")]
        shown = np.concatenate([values[ratios < top],
                                [end for end in ends if end is not None]])
        if len(shown) and np.ptp(shown) > 0.0:
            margin = 0.05 * np.ptp(shown)
            ax.set_xlim(shown.min() - margin, shown.max() + margin)
        ax.set_ylim(0.0, top)
        ax.locator_params(axis="x", nbins=4)
        ax.set_xlabel(label(name, profile["unit"]))
        ax.set_ylabel("likelihood ratio")
        ax.set_title(profile["determination"], loc="left", size="medium")
    return figure


def ambient(outcome: Any, *, most: int = 6) -> "Figure | None":
    """Spectral densities of the first `most` channels of each ambient record, measured
    (without the response to measured loads) and modelled.

    If the model is right, 95 % of the measured values lie in the band. Unit: dB of
    the channel's unit squared per Hz.
    """
    found = [
        (name, channel, score, row)
        for name, score in outcome.ambient.items()
        for row, channel in enumerate(score["channels"][:most])
        if len(score["frequencies_hz"]) > 1
    ]
    if not found:
        return None
    figure, axes = panels(len(found), min(2, len(found)), width=9.0, height=2.6)
    for number, (ax, (name, channel, score, row)) in enumerate(zip(axes, found)):
        hz = score["frequencies_hz"]
        modelled = decibels(score["modelled"][row])
        ax.plot(hz, decibels(score["measured"][row]), label="measured", **FAINT)
        ax.plot(hz, modelled, label="model", **UPDATED)
        # The mean of n squares of complex normal numbers fluctuates by 1 / sqrt(n).
        width = 1.96 / np.sqrt(np.maximum(score["lines"], 1.0))
        band(ax, hz, modelled + decibels(np.maximum(1.0 - width, 0.05)),
             modelled + decibels(1.0 + width), label="95 %")
        if np.isfinite(modelled).any():
            ax.set_ylim(np.nanmin(modelled) - 12.0, np.nanmax(modelled) + 8.0)
        ax.set_title(f"{name}, {channel}", loc="left", size="medium")
        ax.set_xlabel("frequency (Hz)")
        ax.set_ylabel("density (dB)")
        ax.margins(x=0.0)
        if number == 0:
            ax.legend(fontsize="small")
    return figure


def equations(outcome: Any) -> "Figure | None":
    """Error of the regression by number of terms: RMS divided by the RMS of the
    output's acceleration (or force). The circle is the chosen equation.
    """
    curves = [(e, [p for p in e["pareto"] if p["residual"]])
              for e in getattr(outcome, "equations", [])]
    curves = [(e, points) for e, points in curves if len(points) > 1]
    if not curves:
        return None
    figure, axes = panels(len(curves), 2, width=4.5 * min(len(curves), 2), height=2.8)
    for ax, (equation, points) in zip(axes, curves):
        ax.semilogy([p["terms"] for p in points], [p["residual"] for p in points], "o-",
                    ms=4, **UPDATED)
        # The terms of the equation itself may be others: the refit drops and adds.
        chosen = [p for p in points if p["residual"] == equation["residual"]]
        ax.plot([p["terms"] for p in chosen], [p["residual"] for p in chosen], "o", ms=10,
                mfc="none", mew=1.6, color=MARK)
        ax.set_xlabel("number of terms")
        ax.set_ylabel(f"residual, share of the {equation['acts_as']}")
        ax.set_title(f"{equation['output']}, {equation['candidates']} candidates", loc="left",
                     size="medium")
    return figure


def equation_features(outcome: Any, *, most: int = 6) -> "Figure | None":
    """Terms of an equation over each of its features along the training records (blue),
    and the regressed values minus the other terms (grey).
    """
    found = getattr(outcome, "samples", [])[:most]
    if not found:
        return None
    figure, axes = panels(len(found), 2, width=4.5 * min(len(found), 2), height=2.8)
    for ax, samples in zip(axes, found):
        ax.plot(samples["at"], samples["regressed"], ".", ms=3, color="0.67")
        ax.plot(samples["at"], samples["terms"], ".", ms=2, color=BLUE)
        ax.set_xlabel(label(samples["feature"], samples["feature_unit"]))
        ax.set_ylabel(label(samples["output"], samples["unit"]))
    return figure


def _of_results(draw: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(draw)
    def call(outcome: Any, *args: Any, **kwargs: Any) -> Any:
        if outcome is None or isinstance(outcome, (numbers.Number, str)) or type(outcome) is dict:
            raise Error(f"figures of a {type(outcome).__name__}, expected a result")
        most = kwargs.get("most", 1)
        if not isinstance(most, numbers.Integral) or isinstance(most, bool) or most < 1:
            raise Error(f"most is {words_of(most)}, expected a whole number from 1")
        try:
            return draw(outcome, *args, **kwargs)
        except AttributeError as failure:
            # Python 3.9 does not say whose attribute is missing.
            if getattr(failure, "obj", outcome) is not outcome:
                raise
        raise Error(f"figures of a {type(outcome).__name__}, expected a result")

    return call


for _name in __all__:
    globals()[_name] = _of_results(globals()[_name])
