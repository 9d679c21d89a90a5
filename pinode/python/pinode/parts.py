"""The parts of a case: what a case file has as tables.

Each is a dictionary with the keys of `pinode/case/README.md`; further keys of
that page may be given by name. None counts as absent. What does not fit is
refused when the parts become a `Case`.
"""

from __future__ import annotations

import numbers
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ._pinode import Error

ArrayLike = Any  # of numbers: a NumPy array, or what becomes one


class Part(dict):
    """A table of a case."""

    def __init__(self, **keys: Any) -> None:
        super().__init__((k, v) for k, v in keys.items() if v is not None)

    def __repr__(self) -> str:
        words = []
        for key, value in self.items():
            shape = getattr(value, "shape", None)
            if shape is not None and shape != ():
                text = "array of " + " x ".join(str(n) for n in shape)
            else:
                text = repr(value)
            words.append(f"{key}={text if len(text) < 60 else '...'}")
        return f"{type(self).__name__}({', '.join(words)})"


class Model(Part):
    """M, C and K of a structure with n degrees of freedom.

    mass, stiffness: n x n, full or sparse, in consistent units (N, m, s unless
        the case's `units` say otherwise).
    damping: n x n; or {"ratios": [0.02]}, {"rayleigh": [a0, a1]} or "none".
        Needed where there are records.
    dofs: n names; u1, u2, ... unless given.
    influence: {direction: n numbers}, what an acceleration of the ground does
        at each DOF; {"x": all ones} unless given.
    """

    def __init__(
        self,
        mass: ArrayLike,
        stiffness: ArrayLike,
        damping: ArrayLike | Mapping[str, Any] | str | None = None,
        *,
        dofs: Sequence[str] | None = None,
        influence: Mapping[str, ArrayLike] | None = None,
        **keys: Any,
    ) -> None:
        if dofs is None:
            shape = np.shape(mass) if not hasattr(mass, "tocsc") else mass.shape
            dofs = [f"u{i + 1}" for i in range(shape[0] if shape else 0)]
        super().__init__(
            dofs=_strings(dofs),
            mass=_matrix(mass),
            stiffness=_matrix(stiffness),
            damping=_matrix(damping),
            influence=influence,
            **keys,
        )


class ShearBuilding(Part):
    """A mass per floor and a stiffness per storey, from the ground up.

    dampers: one a storey; or `damping` as for Model. DOFs are called u1, u2,
    ... unless given.
    """

    def __init__(
        self,
        masses: ArrayLike,
        stiffnesses: ArrayLike,
        *,
        dampers: ArrayLike | None = None,
        damping: Mapping[str, Any] | str | None = None,
        dofs: Sequence[str] | None = None,
        **keys: Any,
    ) -> None:
        super().__init__(
            shear_building=Part(
                masses=_list(masses),
                stiffnesses=_list(stiffnesses),
                dampers=_list(dampers),
            ),
            damping=damping,
            dofs=_strings(dofs),
            **keys,
        )


class FiniteElementModel(Part):
    """The export of a finite-element program, and how it is made small.

    mass, stiffness, damping: sparse matrices of SciPy, full ones, or files.
    dofs: names of all DOFs, or the file that lists them.
    remove_dofs: those that stand still.
    reduction: such as {"method": "craig_bampton", "modes": 4}; needed above 100
        DOFs. `damping` of the reduced model as for Model, as {"ratios": ...}.
    """

    def __init__(
        self,
        mass: Any,
        stiffness: Any,
        *,
        exported_damping: Any = None,
        dofs: Sequence[str] | str | None = None,
        remove_dofs: Sequence[str] | None = None,
        ground_directions: Mapping[str, int] | None = None,
        expected_frequencies: ArrayLike | None = None,
        reduction: Mapping[str, Any] | None = None,
        damping: Mapping[str, Any] | str | None = None,
        **keys: Any,
    ) -> None:
        super().__init__(
            finite_element=Part(
                mass=_matrix(mass),
                stiffness=_matrix(stiffness),
                damping=_matrix(exported_damping),
                dofs=dofs if isinstance(dofs, str) else _strings(dofs),
                remove_dofs=_strings(remove_dofs),
                ground_directions=ground_directions,
                expected_frequencies=_list(expected_frequencies),
            ),
            reduction=reduction,
            damping=damping,
            **keys,
        )


class Unknown(Part):
    """A parameter that is looked for: of an element, a sensor, a force.

    A bare number in its place is fixed.
    """

    def __init__(
        self,
        initial: float = 0.0,
        *,
        lower: float | None = None,
        upper: float | None = None,
        prior_mean: float | None = None,
        prior_sigma: float | None = None,
        free: bool = True,
        **keys: Any,
    ) -> None:
        super().__init__(
            initial=initial,
            lower=lower,
            upper=upper,
            prior_mean=prior_mean,
            prior_sigma=prior_sigma,
            free=free,
            **keys,
        )


class Group(Part):
    """A correction alpha K_j (C_j, M_j) with the unknown fraction alpha.

    matrix: n x n, symmetric; or `between` two DOFs (with `scale`), or a
        `storey` of a shear building, or the `changed_export` of a
        finite-element model with its `factor`.
    adds_to: "stiffness", "damping" or "mass".
    """

    def __init__(
        self,
        name: str,
        matrix: ArrayLike | None = None,
        *,
        adds_to: str = "stiffness",
        between: Sequence[str] | None = None,
        storey: int | None = None,
        scale: float | None = None,
        changed_export: Any = None,
        factor: float | None = None,
        initial: float | None = None,
        lower: float | None = None,
        upper: float | None = None,
        prior_sigma: float | None = None,
        **keys: Any,
    ) -> None:
        super().__init__(
            name=name,
            adds_to=adds_to,
            matrix=_matrix(matrix),
            between=_strings(between),
            storey=storey,
            scale=scale,
            changed_export=_matrix(changed_export),
            factor=factor,
            initial=initial,
            lower=lower,
            upper=upper,
            prior_sigma=prior_sigma,
            **keys,
        )


class Element(Part):
    """A named force law between two DOFs, or a DOF and the "ground".

    type: "linear", "cubic", "bilinear", "coulomb", "power_damper", "bouc_wen",
        ...; see "Element types" of the case files.
    parameters: by name, each a number (fixed) or an Unknown.
    file: the shared library that has the type, see pinode.elements.
    """

    def __init__(
        self,
        name: str,
        type: str,
        between: Sequence[str],
        parameters: Mapping[str, float | Unknown] | None = None,
        *,
        file: str | os.PathLike[str] | None = None,
        optional: bool | None = None,
        **keys: Any,
    ) -> None:
        super().__init__(
            name=name,
            type=type,
            file=None if file is None else os.fspath(file),
            between=_strings(between),
            parameters=dict(parameters) if parameters is not None else None,
            optional=optional,
            **keys,
        )


class Library(Part):
    """A sum of functions with unknown coefficients, such as "x[u1]^3".

    inputs: what they look at, "x[u1]", "v[u1]", "d[ground,u1]", ...
    output: a DOF, or a pair "u1-u2".
    acts_as: "acceleration" or "force".
    terms: functions, or {"basis": function, "initial": ...}.
    """

    def __init__(
        self,
        name: str,
        inputs: Sequence[str],
        output: str,
        terms: Sequence[str | Mapping[str, Any]],
        *,
        acts_as: str | None = None,
        select: bool | None = None,
        **keys: Any,
    ) -> None:
        super().__init__(
            name=name,
            inputs=_strings(inputs),
            output=output,
            terms=list(terms),
            acts_as=acts_as,
            select=select,
            **keys,
        )


class Network(Part):
    """A feed-forward network for what nobody wrote down.

    inputs, outputs: as for Library, several of each.
    layers: widths of the hidden layers; [] makes it linear.
    """

    def __init__(
        self,
        name: str,
        inputs: Sequence[str],
        outputs: Sequence[str],
        *,
        layers: Sequence[int] | None = None,
        activation: str | None = None,
        acts_as: str | None = None,
        seed: int | None = None,
        **keys: Any,
    ) -> None:
        super().__init__(
            name=name,
            inputs=_strings(inputs),
            outputs=_strings(outputs),
            layers=_list(layers),
            activation=activation,
            acts_as=acts_as,
            seed=seed,
            **keys,
        )


class UnknownForce(Part):
    """The history of a force at `dof` that nobody measured.

    shape: "cubic" or "linear", a spline with knots `knot_spacing` (s) apart in
        `window` (s); or "half_sine" with `parameters`.
    scale: about its size, in the model's unit of force.
    """

    def __init__(
        self,
        name: str,
        dof: str,
        *,
        shape: str | None = None,
        record: str | None = None,
        window: Sequence[float] | None = None,
        knot_spacing: float | None = None,
        scale: float | None = None,
        parameters: Mapping[str, float | Unknown] | None = None,
        **keys: Any,
    ) -> None:
        super().__init__(
            name=name,
            dof=dof,
            shape=shape,
            record=record,
            window=_list(window),
            knot_spacing=knot_spacing,
            scale=scale,
            parameters=parameters,
            **keys,
        )


class Channel(Part):
    """A measured response.

    values: one a sample, NaN where missing; or the name of a column of the
        record's file; None in a case that is simulated.
    quantity: "displacement", "velocity", "acceleration" (relative to the
        ground), "absolute_acceleration", "absolute_displacement", "strain".
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
    array = np.asarray(values)
    if array.ndim != 2:
        raise Error(
            f"channels '{prefix}': values of {array.ndim} dimensions, expected "
            "two: samples x channels"
        )
    if dofs is None:
        dofs = [f"u{i + 1}" for i in range(array.shape[1])]
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
        times in seconds, or the column of the file that has them.
    channels: the responses.
    ground: {direction: accelerations}; force, motion: {dof: values};
        covariate: {name: values}. In place of the values may stand the name of
        a column of the file, or a dictionary with `values` (or `column`) and
        further keys such as `unit`; of a covariate one number as well.
    interpolation: of these between samples: "held", "linear", "cubic" or
        "band_limited". Needed where there are any.
    start: "rest", "free", or {"x": [...], "v": [...]}.
    role: "train" or "holdout".
    file: a CSV file or another; or a dictionary of columns, or a pandas frame.
    """

    def __init__(
        self,
        name: str,
        *,
        channels: Sequence[Channel | Mapping[str, Any]],
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
        columns = _Columns(name, file)
        if step is not None:
            if sampling_rate_hz is not None:
                raise Error(
                    f"record '{name}': 'step' beside 'sampling_rate_hz', "
                    "expected one of the two"
                )
            sampling_rate_hz = _rate(name, step)
        if time is not None and not isinstance(time, str):
            time = columns.add("t", time)
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
                for at, value in given.items()
            ]
        tables = [_channel_table(name, columns, channel) for channel in channels]
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
        return any("column" not in c and "file" not in c for c in self.get("channel", ()))


class Mode(Part):
    """A measured mode.

    frequency_hz: with `frequency_sigma` (Hz) where there are records too.
    shape: {dof: value}, or an array and the `dofs` of its entries.
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
            if dofs is None or len(dofs) != len(shape):
                raise Error(
                    "the shape of a mode is an array, expected 'dofs' with a "
                    "name for each of its entries"
                )
            shape = dict(zip(dofs, _list(shape)))
        super().__init__(
            name=name,
            frequency=frequency_hz,
            frequency_sigma=frequency_sigma,
            shape=shape,
            shape_sigma=shape_sigma,
            **keys,
        )


class _Columns:
    """The table that stands in for a record's file."""

    def __init__(self, record: str, file: Any) -> None:
        self._record = record
        self._path = None
        self._columns: dict[str, Any] = {}
        if file is None:
            return
        if hasattr(file, "columns") and hasattr(file, "to_numpy"):
            self._columns = {str(c): file[c].to_numpy() for c in file.columns}
        elif isinstance(file, Mapping):
            self._columns = dict(file)
        else:
            self._path = file

    def file(self) -> Any:
        return self._path if self._path is not None else self._columns or None

    def add(self, name: str, values: Any) -> str:
        if self._path is not None:
            raise Error(
                f"record '{self._record}': an array for '{name}' beside a file, "
                "expected the name of a column"
            )
        if name in self._columns:
            raise Error(
                f"record '{self._record}': two columns are called '{name}', "
                "expected different names"
            )
        self._columns[name] = _vector(values)
        return name

    def signal(
        self, value: Any, name: str, table: dict[str, Any]
    ) -> dict[str, Any]:
        """The table of an input: its values, or keys with them among these."""
        keys = dict(value) if isinstance(value, Mapping) else {"values": value}
        values = keys.pop("values", None)
        is_covariate = "name" in table
        if isinstance(values, str):
            keys["column"] = values
        elif is_covariate and isinstance(values, numbers.Real):
            keys["value"] = float(values)
        elif values is not None:
            keys["column"] = self.add(name, values)
        # A covariate is a number of any kind.
        if self._path is None and not is_covariate:
            keys.setdefault("unit", "model")
        return {**table, **keys}


def _channel_table(
    record: str, columns: _Columns, channel: Mapping[str, Any]
) -> dict[str, Any]:
    if not isinstance(channel, Mapping):
        raise Error(
            f"record '{record}': a channel is a value of type "
            f"{type(channel).__name__}, expected a pinode.Channel"
        )
    return columns.signal(channel, str(channel.get("name", "")), {})


def _rate(record: str, step: Any) -> float:
    try:
        rate = 1.0 / float(step)
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        rate = float("nan")
    if not 0.0 < rate < float("inf"):
        raise Error(
            f"record '{record}': 'step' is {step!r}, expected a positive number "
            "of seconds"
        )
    return rate


def _vector(values: Any) -> Any:
    """Arrays as they are; lists of numbers as arrays, where they are one."""
    return _matrix(values)


def _matrix(value: Any) -> Any:
    """Rows in lists as an array, where they are one."""
    if not isinstance(value, (list, tuple)):
        return value
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):
        return value
    # Others are refused by name when the case is made.
    return array.astype(float) if array.dtype.kind in "biuf" else value


def _list(values: Any) -> Any:
    return values.tolist() if hasattr(values, "tolist") else values


def _strings(names: Any) -> Any:
    if names is None or isinstance(names, str):
        return names
    return [str(name) if isinstance(name, np.str_) else name for name in names]
