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
from ._labels import are_whole, check_places, check_rows, labels_of, names_of
from ._part import ArrayLike, as_names
from ._pinode import Error
from .case import Case, Progress
from .measurements import INTERPOLATIONS, QUANTITIES, Record, channels
from .parts import Group, Model

if TYPE_CHECKING:
    from .result import Fit

# Damping that a search begins from: usual of steel and of cracked concrete.
_RATIO = 0.02
# Largest expected standard deviation of a factor on damping that is left free.
_LARGEST_SIGMA = 0.5
# Error of a cubic, over that of a line, below which a load is smooth.
_SMOOTH_RATIO = 0.7
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
    interpolation: str | None = None,
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
    damping: ratio as a fraction of critical, a first guess. Default: 0.02. The fit
        finds a factor on the damping of each spring, "c_ground_u1", "c_u1_u2", ...,
        and one on damping in proportion to mass, "c_mass". Given `groups`, or sensors
        that do not show these factors, it finds one common factor, "damping". A
        matrix, or a dictionary as for Model, stays fixed.
    quantity: quantity of the response, see Channel.
    dofs: names of the DOFs. Default: u1, u2, ...
    at: DOFs of the channels. Default: all in order.
    interpolation: interpolation of ground and force between samples, see Record.
        Default: "cubic" if a cubic predicts samples that are left out much better
        than a line does, else "linear".
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
    rows = {"response": response, "time": time}
    for key, load in (("ground", ground), ("force", force)):
        rows |= ({f"{key}[{at!r:.40}]": values for at, values in load.items()}
                 if isinstance(load, Mapping) else {key: load})
    check_rows("identify", rows)
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
    at = as_names("at", at)
    if len(at) != columns.shape[1]:
        raise Error(f"identify: at has {len(at)} names and response {columns.shape[1]} channels, "
                    "expected one for each")
    check_places("identify: response", labels_of(response), at, "at")
    plain = Case(model, units=units)
    springs = _springs(plain.stiffness, names) if groups is None else None
    found = (_groups(groups) if springs is None
             else [Group("k_" + name, matrix) for name, matrix in springs.items()])
    loads = _loads(ground) + _loads(force)
    if interpolation is None:
        interpolation = _interpolation(loads)
    record = Record(
        "record",
        step=step,
        fs=fs,
        sampling_rate_hz=sampling_rate_hz,
        time=time,
        ground=ground if ground is None or isinstance(ground, Mapping) else {"x": ground},
        force=force,
        interpolation=interpolation if loads else None,
        start=start,
        channels=channels("y", columns, quantity, dofs=at, sigma=sigma),
    )
    keys = {"records": [record], "units": units, "options": options}
    case = None
    if is_ratio and float(ratio) > 0.0:
        if springs is not None:
            case = _with_dampers(plain, float(ratio), springs, found, names, keys)
        found.append(Group("damping", plain.damping, adds_to="damping"))
    if case is None:
        case = Case(model, groups=found, **keys)
    return case.identify(progress=progress, callback=callback)


def _with_dampers(plain: Case, ratio: float, springs: dict[str, np.ndarray], groups: list[Any],
                  dofs: Sequence[str] | None, keys: dict[str, Any]) -> Case | None:
    """Returns the case with a factor on the damping of each spring and one on damping
    in proportion to mass. None, if the record does not show one of them.

    The damping of modes belongs to the stiffness of the model, not to the one that the
    fit finds. Measured for four storeys of which three differ by 10 to 15 %: it left
    12 % of the motion unexplained.
    """
    frequencies = np.asarray(plain.natural_modes()["frequencies_hz"], dtype=float)
    if len(frequencies) < 2 or not frequencies[0] > 0.0:
        return None
    # Rayleigh's coefficients with the ratio in the first and third mode.
    first, last = 2.0 * np.pi * frequencies[0], 2.0 * np.pi * frequencies[:3][-1]
    if not last > first * (1.0 + _ROUNDING):
        return None
    by_mass = 2.0 * ratio * first * last / (first + last) * plain.mass
    by_stiffness = 2.0 * ratio / (first + last)
    dampers = {"c_" + name: by_stiffness * matrix for name, matrix in springs.items()}
    dampers["c_mass"] = by_mass
    model = Model(plain.mass, plain.stiffness, by_mass + by_stiffness * plain.stiffness, dofs=dofs)
    case = Case(model, groups=groups + [Group(name, matrix, adds_to="damping", lower=-1.0)
                                        for name, matrix in dampers.items()], **keys)
    expected = case.check().get("expected", [])
    shown = {e["name"] for e in expected if (e["sigma"] or 0.0) > 0.0
             and e["sigma"] <= _LARGEST_SIGMA}
    return case if shown.issuperset(dampers) else None


def _loads(loads: ArrayLike | Mapping[str, ArrayLike] | None) -> list[Any]:
    if loads is None:
        return []
    return list(loads.values()) if isinstance(loads, Mapping) else [loads]


def _interpolation(loads: list[Any]) -> str:
    """Returns "cubic" for loads that are smooth between samples, else "linear": the rule
    of pinode_new (pinode/case/draft/load_interpolation.h).
    """
    errors = np.zeros(2)
    for load in loads:
        try:
            u = np.ma.filled(np.ma.asarray(load, dtype=float), np.nan)
        except (TypeError, ValueError):
            return "linear"
        if u.ndim != 1 or len(u) < 8:
            return "linear"
        near, far = u[2:-4] + u[4:-2], u[:-6] + u[6:]
        motion = np.nansum((u[3:-3] - np.nanmean(u)) ** 2)
        if motion > 0.0:
            by_line, by_cubic = u[3:-3] - near / 2.0, u[3:-3] - (9.0 * near - far) / 16.0
            errors += np.array([np.nansum(by_line**2), np.nansum(by_cubic**2)]) / motion
    return "cubic" if errors[1] < _SMOOTH_RATIO**2 * errors[0] else "linear"


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
    given = list(response.columns) if is_frame(response) else []
    found = names_of("identify: response has the column", given, "or at=[...], the DOF of each "
                     "channel")
    # Numbers that pandas has not given are meant as names.
    if found is not None and (set(found) & set(names) or are_whole(given)):
        for name in found:
            if name not in names:
                raise Error(f"identify: response has the column {name!r:.40}, which is no DOF of the "
                            f"model ({', '.join(names):.60}), expected at=[...], the DOF of each "
                            "channel")
        return found
    near = {name.strip().casefold(): name for name in names}
    for name in found or ():
        if name.strip().casefold() in near:
            raise Error(f"identify: response has the column {name!r:.40}, which is no DOF of the "
                        f"model, did you mean {near[name.strip().casefold()]!r:.40}? Expected its "
                        "DOFs, or at=[...], the DOF of each channel")
    # Columns 0, 1, 2, ... are all in order, which DOFs of these names may not be.
    check_places("identify: response", list(map(str, given)) if are_whole(given)
                 and set(map(str, given)) == set(names) else None, names)
    if count != len(names):
        raise Error(
            f"identify: response has {count} channels and the model {len(names)} DOFs, expected "
            "at=[...], the DOF of each channel"
        )
    return names


def _groups(given: Any) -> list[Any]:
    if isinstance(given, Mapping):
        return [Group(name, matrix) for name, matrix in given.items()]
    return list(given)


def _springs(stiffness: np.ndarray, names: list[str]) -> dict[str, np.ndarray]:
    """Returns the springs that a stiffness matrix consists of, by their ends.

    The spring between DOFs i and j has -K_ij. The spring from DOF i to the ground has
    the sum of row i.
    """
    size = len(names)
    rounding = _ROUNDING * float(np.abs(stiffness).max(initial=0.0))
    springs: list[tuple[str, int, int, float]] = []
    for i in range(size):
        springs.append((f"ground_{names[i]}", i, i, float(stiffness[i].sum())))
        springs += [(f"{names[i]}_{names[j]}", i, j, float(-stiffness[i, j]))
                    for j in range(i + 1, size)]
    if any(value < -rounding for *_, value in springs):
        raise Error(
            "identify: groups is missing, expected {name: matrix}, the part of each member in "
            "stiffness, because this stiffness does not consist of springs between DOFs"
        )
    found = {}
    for name, i, j, value in springs:
        if value <= rounding:
            continue
        matrix = np.zeros((size, size))
        matrix[i, i] = matrix[j, j] = value
        if i != j:
            matrix[i, j] = matrix[j, i] = -value
        found[name] = matrix
    return found
