"""Measurements: records with their channels, and modes.

Like the parts in `parts`, each is a table of a case, with arrays or the columns of a
file.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ._arguments import (
    ANY,
    FLAG,
    LIST,
    MAPPING,
    NAMES,
    NOT_NEGATIVE,
    NUMBER,
    PATH,
    POSITIVE,
    TEXT,
    VALUES,
    WHOLE,
    Kind,
    either,
    hint,
    one_of,
    takes,
    words_of,
)
from ._arrays import as_array, is_frame, plain
from ._case_tables import is_for_simulation
from ._columns import Columns
from ._labels import (
    are_numbered,
    are_whole,
    check_places,
    check_rows,
    default_names,
    labels_of,
    names_of,
    names_of_values,
)
from ._part import ArrayLike, Part, as_list, as_names, as_path, as_sequence, as_text
from ._pinode import Error


QUANTITIES = ("displacement", "velocity", "relative_acceleration", "absolute_acceleration",
              "absolute_displacement", "force", "strain")
INTERPOLATIONS = ("held", "linear", "cubic", "band_limited")
ROLES = ("train", "holdout")
_CORRECTION = either(NUMBER, MAPPING)
_FILE = either(PATH, Kind("a frame", is_frame), MAPPING)
_CHANNEL = {
    "dof": TEXT, "combination": MAPPING, "unit": TEXT, "sigma": NOT_NEGATIVE,
    "sigma_percent": NOT_NEGATIVE, "fit": FLAG, "column": TEXT, "file": ANY,
    "gauge_length": POSITIVE, "distance": NUMBER, "sign": NUMBER, "scale": NUMBER,
    "remove_offset": FLAG, "gain": _CORRECTION, "offset": _CORRECTION, "delay": _CORRECTION,
    "time": ANY,
}


class Channel(Part):
    """A measured response.

    values: one value per sample, NaN or masked if missing. Or the name of a column of
        the record's file. None in a case that is simulated.
    quantity: "absolute_acceleration" (the usual accelerometer),
        "relative_acceleration", "displacement", "velocity" (relative to the ground),
        "absolute_displacement" or "strain"; "force" is the force of an actuator that
        moves a DOF.
    dof: measured DOF.
    combination: {dof: weight} in place of `dof`.
    unit: unit of the values. Default: the model's unit for arrays.
    sigma: standard deviation of the noise, in `unit`. Default: it is estimated.
    sigma_percent: sigma in per cent of the channel's standard deviation.
    fit: False: the channel is predicted and scored, but not fitted.
    gain, offset, delay: corrections of the sensor. An Unknown is searched for, and a
        number is fixed.
    sign: -1 if the sensor is mounted upside down. Default: 1.
    scale, gauge_length, distance: see the table [[record.channel]] in the reference of
        case files.
    """

    @takes(name=TEXT, values=either(VALUES, TEXT), quantity=TEXT, **_CHANNEL)
    def __init__(
        self,
        name: str,
        values: ArrayLike | str | None = None,
        quantity: str = "absolute_acceleration",
        *,
        dof: str | None = None,
        combination: Mapping[str, float] | None = None,
        unit: str | None = None,
        sigma: float | None = None,
        sigma_percent: float | None = None,
        fit: bool | None = None,
        **keys: Any,
    ) -> None:
        _check_quantity(name, quantity)
        if _dimensions(values) > 1:
            raise Error(f"Channel({name!r}): values is {words_of(values)}, expected one number a "
                        "sample; pinode.channels makes a channel of each column")
        # A number is a fixed value.
        keys |= {key: {"initial": float(keys[key]), "free": False}
                 for key in ("gain", "offset", "delay") if NUMBER.fits(keys.get(key))}
        super().__init__(
            name=name,
            values=values,
            quantity=quantity,
            dof=dof,
            combination=combination,
            unit=unit,
            sigma=sigma,
            sigma_percent=sigma_percent,
            fit=fit,
            **keys,
        )


@takes(prefix=TEXT, values=ANY, quantity=TEXT, dofs=NAMES,
       **{key: kind for key, kind in _CHANNEL.items() if key != "dof"})
def channels(
    prefix: str,
    values: ArrayLike,
    quantity: str,
    *,
    dofs: Sequence[str] | None = None,
    **keys: Any,
) -> list[Channel]:
    """Returns a channel for each column of `values`, samples x channels.

    prefix: the channels are named prefix + "1", prefix + "2", ...
    dofs: their DOFs. Default: u1, u2, ..., which the columns of a frame may have in
        another order.
    keys: further arguments of Channel.
    """
    try:
        array = as_array(values)
    except (TypeError, ValueError):
        raise Error(
            f"channels '{prefix}': the values are not an array, expected samples x channels"
        ) from None
    if array.ndim != 2:
        raise Error(
            f"channels '{prefix}': values of {array.ndim} dimensions, expected "
            "two: samples x channels"
        )
    if array.shape[0] < array.shape[1]:
        raise Error(
            f"channels({prefix!r}): values is {array.shape[0]} x {array.shape[1]}, expected "
            "samples x channels; if each row is a channel, pass its transpose, values.T"
        )
    if dofs is None:
        named = _named_columns(f"channels({prefix!r})", values)
        dofs = default_names(array.shape[1]) if named is None else named
    dofs = as_names("dofs", dofs)
    if len(dofs) != array.shape[1]:
        raise Error(
            f"channels '{prefix}': values has {array.shape[1]} columns and dofs "
            f"{len(dofs)} names, expected one for each"
        )
    check_places(f"channels({prefix!r}): values", labels_of(values), dofs)
    return [
        Channel(f"{prefix}{i + 1}", array[:, i], quantity, dof=dof, **keys)
        for i, dof in enumerate(dofs)
    ]


def _named_columns(where: str, values: Any) -> list[str] | None:
    """Returns the DOFs that the columns of a frame name: u1, u2, ..., in any order. None:
    they have names of their own.
    """
    labels = list(values.columns) if is_frame(values) else []
    if are_numbered(labels):
        return None
    found = names_of(f"{where}: values has the column", labels,
                     "or dofs=[...], the DOF of each column")
    known = [bool(re.fullmatch("u[1-9][0-9]*", name)) for name in found or ()]
    if not any(known) and not are_whole(labels):
        return None
    if not all(known):
        raise Error(f"{where}: values has the columns {', '.join(found or ()):.60}, expected "
                    "dofs=[...], the DOF of each column")
    return found


def _check_quantity(name: str, quantity: str) -> None:
    if quantity == "acceleration":
        raise Error(
            f"Channel({name!r}): quantity 'acceleration' is ambiguous, expected "
            "'absolute_acceleration' (of accelerometers) or 'relative_acceleration' "
            "(to the ground)"
        )
    if quantity not in QUANTITIES:
        raise Error(f"Channel({name!r}): quantity is {words_of(quantity)}; "
                    f"{hint(str(quantity), QUANTITIES)}")


def _dimensions(values: Any) -> int:
    """Returns the number of dimensions of an array.

    It is 2 for rows of different lengths.
    """
    try:
        return np.ndim(values)
    except ValueError:
        return 2


class Record(Part):
    """A record: inputs and responses on a uniform grid of samples.

    channels: list of the responses. Empty to plan sensors.
    step: seconds between samples; or fs or sampling_rate_hz: samples per second; or
        time: array of times in seconds, or the column of the file with them. Dates
        count from the first one.
    ground: {direction: accelerations}.
    force: {dof: forces}.
    motion: {dof: displacements} that an actuator prescribes. A list of dictionaries
        gives the velocity or acceleration as well, each with its `quantity`.
    covariate: {name: values}, or one number for the whole record.
    interpolation: interpolation of inputs between samples: "held", "linear", "cubic"
        or "band_limited". Required if there are inputs.
    start: initial state: "rest", "free" (it is estimated), or {"x": [...], "v":
        [...]} in the model's units. Default: "free".
    role: "train" or "holdout" (predicted only). Default: "train".
    file: a CSV file or a file of another supported format; or a dictionary of
        columns; or a pandas frame. A named index of a frame is a column too.

    Values of inputs are arrays with one value per sample, names of columns of the
    file, or dictionaries with `values` or `column` and further keys such as `unit`.
    If there is a `file`, arrays have the record's `step`, or their dictionary has a
    `time`.

    Raises pinode.Error if arrays have different lengths or if there is no rate.
    """

    @takes(name=TEXT, file=_FILE, channels=LIST, step=ANY, sampling_rate_hz=POSITIVE, fs=POSITIVE, ground=MAPPING,
           force=MAPPING, motion=MAPPING, covariate=MAPPING, interpolation=one_of(*INTERPOLATIONS),
           start=either(TEXT, MAPPING), role=one_of(*ROLES), time_unit=TEXT, time_format=TEXT,
           header_lines=WHOLE, delimiter=TEXT, decimal=TEXT, encoding=TEXT, duration=POSITIVE,
           window=VALUES, resample_hz=POSITIVE, periodic=FLAG, start_samples=WHOLE,
           substeps=WHOLE, integrator=TEXT, filter=MAPPING, excitation=TEXT,
           ambient=either(MAPPING, LIST))
    def __init__(
        self,
        name: str,
        *,
        channels: Sequence[Channel | Mapping[str, Any]] = (),
        step: float | None = None,
        fs: float | None = None,
        sampling_rate_hz: float | None = None,
        time: ArrayLike | str | None = None,
        ground: Mapping[str, Any] | None = None,
        force: Mapping[str, Any] | None = None,
        motion: Mapping[str, Any] | None = None,
        covariate: Mapping[str, Any] | None = None,
        interpolation: str | None = None,
        start: str | Mapping[str, ArrayLike] | None = None,
        role: str | None = None,
        file: Any = None,
        **keys: Any,
    ) -> None:
        columns = Columns(name, as_path("file", file) if PATH.fits(file) else file)
        sampling_rate_hz = rate_from(f"record '{name}'", step, fs, sampling_rate_hz)
        if sampling_rate_hz is None and time is None and (
                file is None or columns.file() is not file):
            raise Error(f"record '{name}': 'step' is missing, expected step=seconds, "
                        "fs=samples a second or time=times")
        if sampling_rate_hz is not None and time is not None:
            raise Error(f"record '{name}': time and a sampling rate are given, expected one of them")
        channels = as_sequence("channels", channels)
        rows = {"file": file, "time": time}
        rows |= {f"channel {c.get('name')!r:.40}": c.get("values") for c in channels
                 if isinstance(c, Mapping) and "time" not in c}
        time = columns.time(time)
        if columns.has_dates and keys.get("time_unit", "s") != "s":
            raise Error(
                f"record '{name}': 'time_unit' is given, but dates need none; leave it out"
            )
        signals: dict[str, list[dict[str, Any]]] = {}
        for key, place, given in (
            ("ground", "direction", ground),
            ("force", "dof", force),
            ("motion", "dof", motion),
            ("covariate", "name", covariate),
        ):
            if not given:
                continue
            for at, values in given.items():
                if values is None or len(getattr(values, "shape", ())) > 1:
                    raise Error(f"record '{name}': {key}[{at!r}] is {words_of(values)}, expected "
                                "one number a sample")
                rows |= {f"{key}[{at!r:.40}]": one.get("values") if isinstance(one, Mapping) else one
                         for one in _tables(values)
                         if not isinstance(one, Mapping) or "time" not in one}
            signals[key] = [
                columns.signal(value, f"{key}_{at}", {place: at})
                for at, values in given.items()
                for value in _tables(values)
            ]
        tables = [_channel_table(name, columns, place, channel)
                  for place, channel in enumerate(channels)]
        check_rows(f"record '{name}'", rows)
        _check_lengths(name, columns.file())
        super().__init__(
            name=name,
            file=columns.file(),
            time=time,
            sampling_rate_hz=sampling_rate_hz,
            interpolation=interpolation,
            start=start,
            role=role,
            channel=tables or None,
            **signals,
            **keys,
        )

    @property
    def is_for_simulation(self) -> bool:
        """True if a channel has no values."""
        return is_for_simulation(self)


class Mode(Part):
    """A measured mode.

    frequency_hz: frequency in Hz.
    frequency_sigma: its standard deviation in Hz; required if there are also records.
    shape: {dof: value}, a column of pandas with the DOFs as index, or an array with its
        `dofs`. NaN or masked: not measured.
    shape_sigma: standard deviation of every entry, in the unit of `shape`, or
        {dof: standard deviation}, one per DOF.
    name: name in reports.
    """

    @takes(frequency_hz=POSITIVE, frequency_sigma=POSITIVE, dofs=NAMES,
           shape_sigma=either(POSITIVE, MAPPING), name=TEXT, frequency_weight=NUMBER,
           shape_row=NUMBER, shape_weight=NUMBER, shape_covariance=ANY,
           frequency_shape_covariance=ANY, residual_weight=NUMBER)
    def __init__(
        self,
        frequency_hz: float,
        *,
        frequency_sigma: float | None = None,
        shape: Mapping[str, float] | ArrayLike | None = None,
        dofs: Sequence[str] | None = None,
        shape_sigma: float | Mapping[str, float] | None = None,
        name: str | None = None,
        **keys: Any,
    ) -> None:
        if shape is not None and not isinstance(shape, Mapping):
            if is_frame(shape):
                raise Error(f"Mode: shape is {words_of(shape)}, expected one value for each DOF")
            named = names_of_values(shape)
            shape = as_list(shape)
            if dofs is not None:
                dofs = [as_text("dofs", name) for name in as_names("dofs", dofs)]
            check_places("Mode: shape", named, dofs)
            dofs = named if dofs is None else dofs
            if dofs is None or not isinstance(shape, (list, tuple)) or len(dofs) != len(shape):
                raise Error(
                    "the shape of a mode is an array, expected 'dofs' with a "
                    "name for each of its entries"
                )
            shape = {dof: value for dof, value in zip(dofs, shape)
                     if not (isinstance(value, float) and np.isnan(value))}
        elif shape is None and dofs is not None:
            raise Error("Mode: dofs is given without shape, expected both")
        super().__init__(
            name=name,
            frequency=frequency_hz,
            frequency_sigma=frequency_sigma,
            shape=shape,
            shape_sigma=shape_sigma,
            **keys,
        )


def _tables(values: Any) -> list[Any]:
    """Returns the inputs of one place as a list: its values, or one dictionary for each
    measured quantity.
    """
    several = isinstance(values, (list, tuple)) and len(values) > 0
    return list(values) if several and all(isinstance(v, Mapping) for v in values) else [values]


def _check_lengths(record: str, table: Any) -> None:
    """Raises an Error if the arrays of a record have different lengths."""
    if not isinstance(table, Mapping):
        return
    first: tuple[str, int] | None = None
    for column, values in table.items():
        if not isinstance(values, np.ndarray) or values.ndim != 1:
            continue
        if first is None:
            first = (column, values.size)
        elif values.size != first[1]:
            raise Error(
                f"record '{record}': {_argument(column)} has {values.size} values and "
                f"{_argument(first[0])} {first[1]}, expected one for each sample"
            )


def _argument(column: str) -> str:
    """Returns the argument by which the array of a column was passed."""
    key, _, place = column.partition("_")
    is_input = key in ("ground", "force", "motion", "covariate") and place
    return f"{key}[{place!r}]" if is_input else f"'{column}'"


def _channel_table(
    record: str, columns: Columns, place: int, channel: Mapping[str, Any]
) -> dict[str, Any]:
    if not isinstance(channel, Mapping):
        raise Error(
            f"record '{record}': channels[{place}] is {words_of(channel)}, expected a "
            "pinode.Channel"
        )
    return columns.signal(channel, str(channel.get("name", "")), {})


def rate_from(
    where: str, step: Any, fs: Any = None, sampling_rate_hz: Any = None
) -> float | None:
    """Returns samples per second from the one of `step` (seconds), `fs` and
    `sampling_rate_hz` that is given; None if none is given. `where` is for messages.
    """
    given = {"step": step, "fs": fs, "sampling_rate_hz": sampling_rate_hz}
    given = {key: value for key, value in given.items() if value is not None}
    if len(given) > 1:
        names = " and ".join(f"'{key}'" for key in given)
        raise Error(f"{where}: {names} are given, expected one of them")
    for key, value in given.items():
        try:
            number = float(plain(value)) if not isinstance(value, (bool, str)) else float("nan")
            rate = 1.0 / number if key == "step" else number
        except (TypeError, ValueError, ZeroDivisionError, OverflowError):
            rate = float("nan")
        if not 0.0 < rate < float("inf"):
            unit = "seconds" if key == "step" else "samples a second"
            raise Error(f"{where}: '{key}' is {words_of(value)}, expected a positive number of "
                        f"{unit}")
        return rate
    return None
