"""Further figures of identified modes: MAC, and frequency domain decomposition."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._drawing import BLUE, GREY, decibels, panels
from ._pinode import Error

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def mac(found: Any, other: Any = None) -> "Figure | None":
    """MAC of each mode with each other, or with those of another set at the same
    places.
    """
    columns = found if other is None else other
    values = found.mac(other)
    if values.size == 0:
        return None
    side = float(np.clip(0.45 * max(values.shape) + 1.5, 3.0, 9.0))
    figure, (ax,) = panels(width=side + 0.8, height=side)
    picture = ax.imshow(values, cmap="Blues", vmin=0.0, vmax=1.0)
    for (row, column), value in np.ndenumerate(values):
        if max(values.shape) <= 16:
            ax.text(column, row, f"{value:.2f}", ha="center", va="center", size="small",
                    color="white" if value > 0.6 else "black")
    for axis, modes, name in ((ax.yaxis, found, "mode"),
                              (ax.xaxis, columns, "mode" if other is None else "other mode")):
        axis.set_ticks(range(len(modes)), [f"{m['frequency_hz']:.3g} Hz" for m in modes])
        axis.set_label_text(name)
    ax.tick_params(axis="x", rotation=45)
    figure.colorbar(picture, ax=ax, label="MAC", shrink=0.8)
    return figure


def fdd(found: Any, record: str | None = None) -> "Figure | None":
    """Frequency domain decomposition: singular values of the spectra of all channels of
    a record, and the identified modes. Default: the first record.
    """
    if record is None:
        record = next(iter(found.spectra), None)
    if record not in found.spectra:
        raise Error(f"there is no record {record!r:.40} in the modes")
    spectra = found.spectra[record]
    hz = spectra["singular_hz"]
    if len(hz) < 2:
        return None
    figure, (ax,) = panels(height=3.4, width=9.0)
    for number, (values, shade) in enumerate(
            zip(spectra["singular_values"], (BLUE, "0.45", "0.7")), 1):
        ax.plot(hz[1:], decibels(values[1:]), color=shade, lw=0.9,
                label=f"singular value {number}")
    for mode in found:
        is_harmonic = mode.get("is_harmonic", False)
        ax.axvline(mode["frequency_hz"], color=GREY, lw=0.8, ls=":" if is_harmonic else "--")
        ax.annotate(f"{mode['frequency_hz']:.4g}" + (" (harmonic)" if is_harmonic else ""),
                    (mode["frequency_hz"], 0.98), xycoords=("data", "axes fraction"),
                    rotation=90, va="top", ha="right", size="small", color="0.33")
    ax.set_xlabel("frequency (Hz)")
    ax.set_ylabel("singular values (dB)")
    ax.set_title(record, loc="left")
    ax.margins(x=0.0)
    ax.legend(loc="upper right", fontsize="small")
    return figure
