"""Common parts of figures: colours and lines of the report, panels, labels, bands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ._pinode import Error

# Measured is broad and grey, the updated model blue, the one before it orange
# and dashed: told apart with any colour vision (M. Okabe and K. Ito, "Color
# Universal Design" (2008)) and on paper without colour.
BLUE, GREY, MARK = "#0072B2", "0.6", "#D55E00"
MEASURED: Mapping[str, Any] = {"color": "0.67", "lw": 2.4}
UPDATED: Mapping[str, Any] = {"color": BLUE, "lw": 1.0}
PRIOR: Mapping[str, Any] = {"color": "#E69F00", "lw": 1.0, "ls": "--"}
TRUE: Mapping[str, Any] = {"color": "0.2", "lw": 1.0, "ls": ":"}
FAINT: Mapping[str, Any] = {"color": GREY, "lw": 0.8}
BAND: Mapping[str, Any] = {"color": BLUE, "alpha": 0.2, "lw": 0}


def blank(width: float, height: float) -> Any:
    """Returns an empty figure; sizes in inches."""
    try:
        from ._figure import Figure
    except ImportError:
        raise Error("matplotlib is missing, and figures need it: python3 -m pip install "
                    "matplotlib") from None

    return Figure(figsize=(width, height), layout="constrained")


def panels(
    count: int = 1, columns: int = 1, *, width: float = 7.0, height: float = 2.4
) -> tuple[Any, Sequence[Any]]:
    """Returns a figure of `count` panels, row by row. `height` is that of a row in
    inches.
    """
    columns = max(1, min(columns, count))
    rows = max(1, -(-count // columns))
    figure = blank(width, rows * height)
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for ax in axes[count:]:
        ax.remove()
    return figure, axes[:count]


def label(quantity: str, unit: str) -> str:
    """Returns "a1 (m/s^2)", or the quantity alone if it has no unit."""
    return quantity if unit in ("", "1") else f"{quantity} ({unit})"


def decibels(density: np.ndarray) -> np.ndarray:
    """Returns 10 log10(density), with NaN if the density is not positive."""
    density = np.asarray(density)
    return 10.0 * np.log10(np.where(density > 0.0, density, np.nan))


def band(ax: Any, x: np.ndarray, low: np.ndarray, high: np.ndarray, **more: Any) -> None:
    """Fills the area between two curves, where both are finite."""
    there = np.isfinite(low) & np.isfinite(high)
    if there.any():
        ax.fill_between(x, low, high, where=there, **{**BAND, **more})


def bars(ax: Any, names: Sequence[str], changes: Any, lows: Any, highs: Any,
         colours: Sequence[Any]) -> None:
    """Draws changes in per cent with their intervals, from top to bottom."""
    changes, lows, highs = (np.asarray(v, dtype=float) for v in (changes, lows, highs))
    places = np.arange(len(names))
    ax.barh(places, changes, 0.55, color=colours, zorder=1)
    ax.errorbar(changes, places, xerr=np.maximum([changes - lows, highs - changes], 0.0),
                fmt="o", ms=4, color="0.13", lw=1.2, capsize=3, zorder=2)
    ax.axvline(0.0, color="0.13", lw=0.8)
    # Intervals of what is hardly known may be cut, changes may not.
    least, most = min(0.0, changes.min()), max(0.0, changes.max())
    room = max(2.0 * (most - least), 1e-9)
    least = min(least, np.maximum(lows, least - room).min())
    most = max(most, np.minimum(highs, most + room).max())
    margin = max(0.08 * (most - least), 1e-9)
    ax.set_xlim(least - margin, most + margin)
    ax.set_yticks(places, names)
    ax.invert_yaxis()
    ax.set_xlabel("change (%)")
