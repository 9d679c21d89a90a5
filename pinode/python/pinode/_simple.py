"""One call for the simple case: from matrices and arrays to a fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ._arguments import (
    ANY,
    FLAG,
    LIST,
    MAPPING,
    MATRIX,
    NAMES,
    NOT_NEGATIVE,
    POSITIVE,
    TEXT,
    VALUES,
    Kind,
    check_kind,
    either,
    one_of,
    takes,
)
from ._arrays import as_array, is_frame
from ._part import ArrayLike, as_sequence
from ._pinode import Error
from .case import Case, Progress
from .measurements import INTERPOLATIONS, QUANTITIES, Record, channels
from .parts import Group, Model

if TYPE_CHECKING:
    from .result import Fit

# Damping that a search begins from: usual of steel and of cracked concrete.
_RATIO = 0.02
# Share of the largest stiffness below which a sum of entries is rounding.
_ROUNDING = 1e-9
_DAMPING = Kind("a ratio such as 0.02, an array, n x n, or {'ratios': [...]}",
                lambda v: MATRIX.fits(v) or (NOT_NEGATIVE.fits(v) and float(v) < 1.0))


@takes(mass=MATRIX, stiffness=MATRIX, response=ANY, ground=either(VALUES, MAPPING), force=MAPPING,
       step=ANY, fs=POSITIVE, sampling_rate_hz=POSITIVE, time=VALUES, groups=either(MAPPING, LIST),
       damping=_DAMPING, quantity=one_of(*QUANTITIES), dofs=NAMES, at=NAMES,
       interpolation=one_of(*INTERPOLATIONS), start=either(TEXT, MAPPING),
       sigma=NOT_NEGATIVE, units=MAPPING, options=MAPPING, progress=FLAG)
def identify(
    mass: ArrayLike,
    stiffness: ArrayLike,
    response: ArrayLike,
    *,
    ground: ArrayLike | Mapping[str, ArrayLike] | None = None,
    force: Mapping[str, ArrayLike] | None = None,
    step: float | None = None,
    fs: float | None = None,
    sampling_rate_hz: float | None = None,
    time: ArrayLike | None = None,
    groups: Mapping[str, ArrayLike] | Sequence[Group] | None = None,
    damping: float | ArrayLike | Mapping[str, Any] | None = None,
    quantity: str = "absolute_acceleration",
    dofs: Sequence[str] | None = None,
    at: Sequence[str] | None = None,
    interpolation: str = "linear",
    start: str | Mapping[str, ArrayLike] = "rest",
    sigma: float | None = None,
    units: Mapping[str, str] | None = None,
    options: Mapping[str, Any] | None = None,
    progress: bool | None = None,
    callback: Progress | None = None,
) -> "Fit":
    """Identifies the stiffness of a structure from one record. Returns a Fit.

        fit = pinode.identify(M, K, floors, ground=ag, fs=100)
        print(fit.sentence, fit["k_ground_u1"])

    mass, stiffness: n x n, in consistent units. These are N, m and s unless `units`
        is given.
    response: measured response, samples x channels, one channel per DOF, or per DOF
        of `at`.
    ground: acceleration of the ground, one value per sample, or {direction: values}.
    force: {dof: values}. One of ground and force is required, unless `start` is
        "free": the record is then a free decay.
    step: seconds between samples; or fs or sampling_rate_hz: samples per second; or
        time: times in seconds. One of them is required.
    groups: {name: matrix} or a list of Group: parts of the stiffness that may differ
        from the model. A value of -0.1 is a loss of 10 %. Default: each spring
        between two DOFs, or a DOF and the ground, is a group: "k_ground_u1",
        "k_u1_u2", ...
    damping: ratio of all modes as a fraction of critical; the fit finds a common
        factor of it, "damping". Default: 0.02. A matrix, or a dictionary as for
        Model, stays fixed.
    quantity: quantity of the response, see Channel.
    dofs: names of the DOFs. Default: u1, u2, ...
    at: DOFs of the channels. Default: all in order.
    interpolation: interpolation of ground and force between samples, see Record.
    start: initial state, see Record.
    sigma: standard deviation of the response's noise. Default: it is estimated.
    units: units of the model, see Case.
    options: options of the fit, see Case.
    progress, callback: see Case.identify.

    `fit.case` is the Case that was made. Use it if you need further keys.

    Raises pinode.Error, which names the argument, if a shape, a unit or a value is
    wrong.
    """
    columns = _response(response)
    if ground is None and force is None and start == "rest":
        raise Error(
            "identify: ground and force are both missing, expected one of them. For a free "
            "decay give start='free'; without a measured load use pinode.identify_modes"
        )
    is_ratio = damping is None or not MATRIX.fits(damping)
    ratio = _RATIO if damping is None else damping
    model = Model(mass, stiffness, {"ratios": [float(ratio)]} if is_ratio else damping, dofs=dofs)
    names = list(model["dofs"])
    if at is None:
        at = _places(response, columns.shape[1], names)
    at = as_sequence("at", at)
    if len(at) != columns.shape[1]:
        raise Error(f"identify: at has {len(at)} names and response {columns.shape[1]} channels, "
                    "expected one for each")
    found = _groups(groups, Case(model, units=units).stiffness, names)
    if is_ratio and float(ratio) > 0.0:
        found.append(Group("damping", Case(model, units=units).damping, adds_to="damping"))
    record = Record(
        "record",
        step=step,
        fs=fs,
        sampling_rate_hz=sampling_rate_hz,
        time=time,
        ground=ground if ground is None or isinstance(ground, Mapping) else {"x": ground},
        force=force,
        interpolation=None if ground is None and force is None else interpolation,
        start=start,
        channels=channels("y", columns, quantity, dofs=at, sigma=sigma),
    )
    case = Case(model, groups=found, records=[record], units=units, options=options)
    return case.identify(progress=progress, callback=callback)


def _response(response: Any) -> np.ndarray:
    """Returns the response as an array, samples x channels."""
    try:
        columns = as_array(response)
    except (TypeError, ValueError):
        columns = np.zeros(())
    if columns.ndim == 1:
        columns = columns[:, None]
    if columns.ndim != 2 or columns.dtype.kind not in "fiu":
        check_kind("identify", "response", response,
                   Kind("an array of numbers, samples x channels", lambda _: False))
    if columns.shape[0] < columns.shape[1]:
        raise Error(
            f"identify: response is {columns.shape[0]} x {columns.shape[1]}, expected samples x "
            "channels; if each row is a channel, pass its transpose, response.T"
        )
    return columns


def _places(response: Any, count: int, names: list[str]) -> list[str]:
    """Returns the DOFs of the channels: those that the columns of a frame name, or all
    in order.
    """
    if is_frame(response) and all(name in names for name in response.columns):
        return list(response.columns)
    if count != len(names):
        raise Error(
            f"identify: response has {count} channels and the model {len(names)} DOFs, expected "
            "at=[...], the DOF of each channel"
        )
    return names


def _groups(given: Any, stiffness: np.ndarray, names: list[str]) -> list[Any]:
    if given is None:
        return _springs(stiffness, names)
    if isinstance(given, Mapping):
        return [Group(name, matrix) for name, matrix in given.items()]
    return list(given)


def _springs(stiffness: np.ndarray, names: list[str]) -> list[Any]:
    """Returns the springs that a stiffness matrix consists of.

    The spring between DOFs i and j has -K_ij. The spring from DOF i to the ground has
    the sum of row i.
    """
    size = len(names)
    rounding = _ROUNDING * float(np.abs(stiffness).max(initial=0.0))
    springs: list[tuple[str, int, int, float]] = []
    for i in range(size):
        springs.append((f"k_ground_{names[i]}", i, i, float(stiffness[i].sum())))
        springs += [(f"k_{names[i]}_{names[j]}", i, j, float(-stiffness[i, j]))
                    for j in range(i + 1, size)]
    if any(value < -rounding for *_, value in springs):
        raise Error(
            "identify: groups is missing, expected {name: matrix}, the part of each member in "
            "stiffness, because this stiffness does not consist of springs between DOFs"
        )
    found = []
    for name, i, j, value in springs:
        if value <= rounding:
            continue
        matrix = np.zeros((size, size))
        matrix[i, i] = matrix[j, j] = value
        if i != j:
            matrix[i, j] = matrix[j, i] = -value
        found.append(Group(name, matrix))
    return found
