"""What was measured: records with their channels, and modes.

Tables of a case as those of `parts` are, with arrays or the columns of a file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ._arrays import as_array, plain
from ._case_tables import is_for_simulation
from ._columns import Columns
from ._part import ArrayLike, Part, as_list, as_sequence, as_text
from ._pinode import Error


class Channel(Part):
    """A measured response.

    values: one a sample, NaN (or masked) where missing; or the name of a column of the
        record's file; None in a case that is simulated.
    quantity: "absolute_acceleration", what accelerometers show,
        "relative_acceleration", "displacement" and "velocity" (these relative to
        the ground), "absolute_displacement", "strain", or "force", of the actuator
        that moves a DOF.
    dof: where; or `combination`, {dof: weight}.
    unit: of the values; the model's own for arrays unless given.
    sigma: standard deviation of its noise, in `unit`; estimated unless given.
    """

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
        if isinstance(quantity, str) and quantity == "acceleration":
            raise Error(
                f"channel '{name}': quantity 'acceleration' does not say of what, expected "
                "'absolute_acceleration', as accelerometers show it, or 'relative_acceleration', "
                "to the ground"
            )
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


def channels(
    prefix: str,
    values: ArrayLike,
    quantity: str,
    *,
    dofs: Sequence[str] | None = None,
    **keys: Any,
) -> list[Channel]:
    """A channel for each column of `values`, samples x channels.

    They are called prefix + "1", ... and are at u1, u2, ... unless `dofs` names
    others. Further keys are those of Channel.
    """
    try:
        array = as_array(values)
    except (TypeError, ValueError):
        raise Error(
            f"channels '{prefix}': the values are no array, expected samples x channels"
        ) from None
    if array.ndim != 2:
        raise Error(
            f"channels '{prefix}': values of {array.ndim} dimensions, expected "
            "two: samples x channels"
        )
    if dofs is None:
        dofs = [f"u{i + 1}" for i in range(array.shape[1])]
    dofs = as_sequence("dofs", dofs)
    if len(dofs) != array.shape[1]:
        raise Error(
            f"channels '{prefix}': {array.shape[1]} columns and {len(dofs)} "
            "DOFs, expected one for each"
        )
    return [
        Channel(f"{prefix}{i + 1}", array[:, i], quantity, dof=dof, **keys)
        for i, dof in enumerate(dofs)
    ]


class Record(Part):
    """What was measured at one go, on a uniform grid of samples.

    step: seconds between samples; or `sampling_rate_hz`, or `time`: an array of
        times in seconds, or the column of the file that has them; dates count from
        the first.
    channels: the responses; none to plan sensors.
    ground: {direction: accelerations}; force, motion: {dof: values};
        covariate: {name: values}. In place of the values may stand the name of
        a column of the file, or a dictionary with `values` (or `column`) and
        further keys such as `unit`; of a covariate one number as well. A motion
        takes a list of dictionaries, where its displacement was measured and its
        velocity (`quantity`) too. Beside a file arrays have the record's `step`, or
        a `time` of their own in their dictionary.
    interpolation: of these between samples: "held", "linear", "cubic" or
        "band_limited". Needed where there are any.
    start: "rest", "free", or {"x": [...], "v": [...]}.
    role: "train" or "holdout".
    file: a CSV file or another; or a dictionary of columns, or a pandas frame, whose
        index is a column too where it has a name.
    """

    def __init__(
        self,
        name: str,
        *,
        channels: Sequence[Channel | Mapping[str, Any]] = (),
        step: float | None = None,
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
        columns = Columns(name, file)
        if step is not None:
            if sampling_rate_hz is not None:
                raise Error(
                    f"record '{name}': 'step' beside 'sampling_rate_hz', "
                    "expected one of the two"
                )
            sampling_rate_hz = rate_of(name, step)
        time = columns.time(time)
        if columns.has_dates and keys.get("time_unit", "s") != "s":
            raise Error(
                f"record '{name}': 'time_unit' of dates, which are read in seconds, expected none"
            )
        signals: dict[str, list[dict[str, Any]]] = {}
        for key, place, given in (
            ("ground", "direction", ground),
            ("force", "dof", force),
            ("motion", "dof", motion),
            ("covariate", "name", covariate),
        ):
            if given is None:
                continue
            if not isinstance(given, Mapping):
                raise Error(
                    f"record '{name}': '{key}' is a value of type "
                    f"{type(given).__name__}, expected {{{place}: values}}"
                )
            signals[key] = [
                columns.signal(value, f"{key}_{at}", {place: at})
                for at, values in given.items()
                for value in _tables(values)
            ]
        tables = [_channel_table(name, columns, channel) for channel in as_sequence("channels", channels)]
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
        """Whether it has a channel without values."""
        return is_for_simulation(self)


class Mode(Part):
    """A measured mode.

    frequency_hz: with `frequency_sigma` (Hz) where there are records too.
    shape: {dof: value}, or an array and the `dofs` of its entries, NaN or masked
        where nobody measured.
    """

    def __init__(
        self,
        frequency_hz: float,
        *,
        frequency_sigma: float | None = None,
        shape: Mapping[str, float] | ArrayLike | None = None,
        dofs: Sequence[str] | None = None,
        shape_sigma: float | None = None,
        name: str | None = None,
        **keys: Any,
    ) -> None:
        if shape is not None and not isinstance(shape, Mapping):
            shape = as_list(shape)
            if dofs is not None:
                dofs = [as_text("dofs", name) for name in as_sequence("dofs", dofs)]
            if dofs is None or not isinstance(shape, (list, tuple)) or len(dofs) != len(shape):
                raise Error(
                    "the shape of a mode is an array, expected 'dofs' with a "
                    "name for each of its entries"
                )
            shape = {dof: value for dof, value in zip(dofs, shape)
                     if not (isinstance(value, float) and np.isnan(value))}
        super().__init__(
            name=name,
            frequency=frequency_hz,
            frequency_sigma=frequency_sigma,
            shape=shape,
            shape_sigma=shape_sigma,
            **keys,
        )


def _tables(values: Any) -> list[Any]:
    """Of one place: its values, or what was measured of it, a dictionary each."""
    several = isinstance(values, (list, tuple)) and len(values) > 0
    return list(values) if several and all(isinstance(v, Mapping) for v in values) else [values]


def _channel_table(
    record: str, columns: Columns, channel: Mapping[str, Any]
) -> dict[str, Any]:
    if not isinstance(channel, Mapping):
        raise Error(
            f"record '{record}': a channel is a value of type "
            f"{type(channel).__name__}, expected a pinode.Channel"
        )
    return columns.signal(channel, str(channel.get("name", "")), {})


def rate_of(record: str, step: Any) -> float:
    """Samples a second of a `step` in seconds; the record's name is for messages."""
    try:
        rate = 1.0 / float(plain(step))
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        rate = float("nan")
    if not 0.0 < rate < float("inf"):
        raise Error(
            f"record '{record}': 'step' is {step!r}, expected a positive number "
            "of seconds"
        )
    return rate
