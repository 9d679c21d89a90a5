"""Preparation of arrays before their modes are identified: detrending and filtering."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ._arguments import words_of
from ._part import as_number, as_sequence
from ._pinode import Error

# Order of the filter in one direction. It runs in both, so that no phase is shifted.
_ORDER = 4
_KINDS = ("constant", "linear")


def check_trend(detrend: Any) -> str | None:
    """Returns the kind of trend to subtract. None: none."""
    if detrend is None or detrend is False:
        return None
    if detrend is True:
        return "linear"
    if not isinstance(detrend, str) or detrend not in _KINDS:
        raise Error(f"detrend is {words_of(detrend)}, expected True, 'linear', 'constant' or None")
    return detrend


def check_band(filter_hz: Any) -> tuple[float | None, float | None] | None:
    """Returns the ends of the filter's pass band. None stands for an open end."""
    if filter_hz is None:
        return None
    ends = as_sequence("filter_hz", filter_hz)
    if len(ends) != 2 or all(end is None for end in ends):
        raise Error("filter_hz is not a pair, expected (lowest, highest) in Hz, None for an open "
                    "end")
    low, high = (None if end is None else as_number("filter_hz", end) for end in ends)
    if not 0.0 < (low if low is not None else 1.0) < (high if high is not None else np.inf):
        raise Error(f"filter_hz is ({low}, {high}), expected 0 < lowest < highest in Hz")
    return low, high


def conditioned(
    where: str,
    values: np.ndarray,
    step: float,
    detrend: str | None,
    band: tuple[float | None, float | None] | None,
) -> np.ndarray:
    """Returns samples x channels without trend, filtered by a zero-phase Butterworth
    filter with this pass band. `where` is for messages.
    """
    if detrend is None and band is None:
        return values
    if values.dtype.kind not in "fiu":
        raise Error(f"{where}: the values have entries of type {values.dtype}, expected numbers")
    values = values.astype(float)
    if detrend is not None:
        values = _without_trend(values, detrend)
    return values if band is None else _filtered(where, values, step, band)


def _without_trend(values: np.ndarray, kind: str) -> np.ndarray:
    """Subtracts a line, or a constant, that is fitted to the samples that are not
    missing.
    """
    time = np.linspace(-1.0, 1.0, len(values))
    terms = np.vander(time, 2 if kind == "linear" else 1)
    rest = values.copy()
    for column in rest.T:
        there = np.isfinite(column)
        if there.sum() >= terms.shape[1]:
            column -= terms @ np.linalg.lstsq(terms[there], column[there], rcond=None)[0]
    return rest


def _filtered(
    where: str, values: np.ndarray, step: float, band: Sequence[float | None]
) -> np.ndarray:
    try:
        from scipy import signal
    except ImportError:
        raise Error("SciPy is missing, and filter_hz needs it: python3 -m pip install "
                    "scipy") from None
    low, high = band
    half = 0.5 / step
    for end in band:
        if end is not None and end >= half:
            raise Error(f"{where}: filter_hz has {end:g} Hz, expected less than half the sampling "
                        f"rate, {half:g} Hz")
    if not np.isfinite(values).all():
        raise Error(f"{where}: samples are missing, and a filter needs all of them; leave out "
                    "filter_hz")
    ends = [end for end in band if end is not None]
    kind = "bandpass" if len(ends) == 2 else "lowpass" if low is None else "highpass"
    sections = signal.butter(_ORDER, ends if len(ends) == 2 else ends[0], kind, fs=1.0 / step,
                             output="sos")
    try:
        return signal.sosfiltfilt(sections, values, axis=0)
    except ValueError:  # shorter than what is added at both ends
        raise Error(f"{where}: {len(values)} samples are too few for a filter") from None
