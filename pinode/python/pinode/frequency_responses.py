"""Frequency response functions from records of forces and responses."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np

from . import _pinode
from ._arguments import ANY, NOT_NEGATIVE, POSITIVE, TEXT, takes
from ._arrays import as_array
from ._labels import check_places, check_rows, labels_of
from ._part import as_path, as_sequence, counted
from ._pinode import Error
from .measurements import rate_from

_DERIVATIVES = {"displacement": 0, "velocity": 1, "acceleration": 2}


class FrequencyResponses:
    """Frequency response functions: motion of places per force at places.

    responses, references: names of the places of the motions and of the forces.
    frequencies_hz: lines.
    values: complex, lines x responses x references.
    coherence: partial coherence of each value; with one force the ordinary one.
        Empty if there is one block alone.
    variances: variance E|error|^2 of each complex value, due to noise. Empty if there are
        not more blocks than forces.
    num_blocks, num_averages: blocks, and how many independent ones they count as.
    decay_rate: one over the time constant of the exponential window, in 1 / s. The
        values are (i w)^d times the receptance at i w + decay_rate.
    remarks: what was left out or is uncertain, one sentence each.
    """

    def __init__(self, handle: Any) -> None:
        self._handle = handle
        self.responses: list[str] = handle.responses
        self.references: list[str] = handle.references
        self.frequencies_hz: np.ndarray = handle.frequencies_hz
        self.values: np.ndarray = handle.values
        self.coherence: np.ndarray = handle.coherence
        self.variances: np.ndarray = handle.variances
        self.num_blocks: int = handle.num_blocks
        self.num_averages: float = handle.num_averages
        self.decay_rate: float = handle.decay_rate
        self.remarks: list[str] = handle.remarks

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_handle": None}

    def save(self, path: str | os.PathLike[str]) -> str:
        """Writes a universal file, for `frfs` of a Case or for `pinode_modes`. Returns
        its path. The coherence is in it if there are at least 8 independent blocks.
        """
        if self._handle is None:
            raise Error("functions from a pickle cannot be saved; save them before pickling")
        path = as_path("path", path)
        if not path.endswith((".uff", ".unv")):
            raise Error(f"path is {path!r:.60}, expected a universal file (.uff)")
        self._handle.save(path)
        return path

    def __repr__(self) -> str:
        return (f"FrequencyResponses({len(self.responses)} x {len(self.references)}, "
                f"{counted(len(self.frequencies_hz), 'line')}, "
                f"{counted(self.num_blocks, 'block')})")


@takes(force=ANY, responses=ANY, estimator=TEXT, excitation=TEXT, block=POSITIVE, overlap=NOT_NEGATIVE,
       force_window=POSITIVE, exponential_window=POSITIVE)
def estimate_frfs(
    force: Any,
    responses: Any,
    *,
    step: float | None = None,
    fs: float | None = None,
    sampling_rate_hz: float | None = None,
    names: Sequence[str] | None = None,
    references: Sequence[str] | None = None,
    quantity: str = "acceleration",
    estimator: str = "h1",
    excitation: str = "automatic",
    block: float | None = None,
    overlap: float = 0.5,
    force_window: float | None = None,
    exponential_window: float | None = None,
) -> FrequencyResponses:
    """Estimates frequency response functions by averages over blocks.

    force: samples of one force, or samples x forces. A list of arrays: one for each
        record of the same test, as with a file per blow.
    responses: samples x channels, or samples of one channel; a list beside a list.
    step: seconds between samples; or fs or sampling_rate_hz: samples per second.
    names: names of the channels, which are places. Default: names of the columns of a
        frame, else a1, a2, ...
    references: names of the forces' places. Default: likewise, else f1, f2, ...
    quantity: "acceleration", "velocity" or "displacement" of all channels.
    estimator: "h1" (noise in the responses), "h2" (in the force), "hv" (in both).
    excitation: "blows" of a hammer, "random" or "periodic". Default: "automatic".
    block: length of the blocks in s; the period of a periodic force.
    overlap: overlap of the blocks of a random force.
    force_window: time in s after which the force of a blow is set to zero.
    exponential_window: time constant in s of an exponential window on blows.

    Raises pinode.Error if arguments are not valid or no blow is usable.
    """
    if not isinstance(quantity, str) or quantity not in _DERIVATIVES:
        raise Error(f"quantity is {quantity!r:.40}, expected acceleration, velocity or "
                    "displacement")
    rate = rate_from("estimate_frfs", step, fs, sampling_rate_hz)
    if rate is None:
        raise Error("estimate_frfs: 'step' is missing, expected step=seconds or fs=samples a second")
    several = isinstance(force, (list, tuple)) and len(force) > 0 and np.ndim(force[0]) > 0
    if several and (not isinstance(responses, (list, tuple)) or len(responses) != len(force)):
        raise Error(f"force has {len(force)} records, expected as many responses")
    pairs = list(zip(force, responses)) if several else [(force, responses)]
    records = [(_columns("force", one), _columns("responses", other)) for one, other in pairs]
    for i, (one, other) in enumerate(records):
        if len(one) != len(other):
            place = f"[{i}]" if several else ""
            turned = other.shape[1] == len(one)
            raise Error(f"responses{place} is {other.shape[0]} x {other.shape[1]} and force{place} "
                        f"has {counted(len(one), 'sample')}, expected samples x channels"
                        + ("; if each row is a channel, pass its transpose, responses.T"
                           if turned else ", as many samples for both"))
    for one, other in pairs:
        check_rows("estimate_frfs", {"force": one, "responses": other})
    named = [_named("force", [one for one, _ in pairs]),
             _named("responses", [other for _, other in pairs])]
    check_places("responses", named[1], names, "names")
    check_places("force", named[0], references, "references")
    names = named[1] if names is None else names
    references = named[0] if references is None else references
    width = [records[0][0].shape[1], records[0][1].shape[1]]
    handle = _pinode.estimate_frfs(
        records, 1.0 / rate,
        _names("names", names, "a", width[1]), _names("references", references, "f", width[0]),
        _DERIVATIVES[quantity], estimator, excitation, block or 0.0, overlap, force_window or 0.0,
        exponential_window or 0.0)
    return FrequencyResponses(handle)


def _named(name: str, frames: list[Any]) -> list[str] | None:
    """Returns the names of the columns, which all frames must have in the same order.
    None: they are unnamed.
    """
    first = labels_of(frames[0])
    for i, frame in enumerate(frames):
        labels = labels_of(frame)
        if None not in (first, labels) and labels != first:
            raise Error(f"{name}[{i}] has the columns {', '.join(labels or ()):.60}, expected those "
                        f"of {name}[0] in their order: {', '.join(first or ()):.60}")
    return first


def _columns(name: str, values: Any) -> np.ndarray:
    """Samples x channels."""
    array = _as_numbers(name, values)
    if array.ndim == 1:
        array = array[:, None]
    if array.ndim != 2 or array.shape[1] == 0 or array.shape[0] < 2:
        raise Error(f"{name} has the shape {array.shape}, expected samples x channels")
    return array


def _as_numbers(name: str, values: Any) -> np.ndarray:
    try:
        array = as_array(values)
        if np.iscomplexobj(array):
            raise Error(f"{name} is complex, expected samples over time")
        return np.asarray(array, dtype=float)
    except Error:
        raise
    except (TypeError, ValueError) as error:
        raise Error(f"{name} is no array of numbers: {error}") from None


def _names(key: str, names: Sequence[str] | None, letter: str, count: int) -> list[str]:
    if names is None:
        return [f"{letter}{i + 1}" for i in range(count)]
    listed = [str(name) for name in as_sequence(key, names)]
    if len(listed) != count:
        raise Error(f"{key} has {len(listed)} entries, expected {count}")
    return listed
