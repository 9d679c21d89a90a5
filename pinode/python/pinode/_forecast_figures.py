"""Figures of simulations and of sensor plans."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._drawing import BLUE, FAINT, GREY, UPDATED, panels
from ._pinode import Error

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def simulated(simulation: Any, record: str | None = None, *, most: int = 8) -> "Figure | None":
    """First `most` channels of a simulated record. Default: the first record."""
    names = list(simulation.keys())
    if record is None and names:
        record = names[0]
    if not isinstance(record, str) or record not in names:
        raise Error(f"there is no record {record!r:.40} in the simulation")
    response = simulation[record]
    shown = list(response["channels"].items())[:most]
    if not shown:
        return None
    figure, axes = panels(len(shown), width=9.0, height=1.8)
    for ax, (name, values) in zip(axes, shown):
        ax.plot(response["time"], values, **UPDATED)
        ax.set_ylabel(name)
        ax.margins(x=0.0)
    axes[0].set_title(f"{record}, simulated", loc="left")
    axes[-1].set_xlabel("time")
    return figure


def planned(plan: Any) -> "Figure | None":
    """Typical and worst standard deviation of the targets with each sensor and all
    previous ones, and with the case's own sensors.
    """
    names, steps = plan.names, list(plan)
    if not steps:
        return None
    figure, (ax,) = panels(height=3.4)
    places = np.arange(len(steps))
    for key, colour, words in (("worst", GREY, "worst"), ("typical", BLUE, "typical")):
        # Infinite where sensors do not see all targets yet.
        values = np.array([step[key] for step in steps], dtype=float)
        values[~np.isfinite(values)] = np.nan
        ax.plot(places, values, "o-", color=colour, label=words)
        if plan.own is not None and np.isfinite(plan.own[key]):
            ax.axhline(plan.own[key], **{**FAINT, "color": colour, "ls": "--"})
            ax.annotate(f"{words} with the case's own", (0.0, plan.own[key]), size="small",
                        color=colour, va="bottom")
    ax.set_xticks(places, [f"{i + 1}: {name}" for i, name in enumerate(names)],
                  rotation=30 if len(names) > 6 else 0)
    ax.set_yscale("log")
    ax.set_xlabel("sensors, each with those before it")
    ax.set_ylabel("standard deviation")
    ax.set_title(f"of {', '.join(plan.targets[:6])}" + (", ..." if plan.targets[6:] else ""),
                 loc="left")
    ax.legend()
    return figure
