"""Parts of a case: its model and its unknowns. Records and modes are in `measurements`.

Each part is a dictionary with the keys of `pinode/case/README.md`. Further keys of
that page may be given by name. None counts as absent.

The constructor refuses unknown keywords with pinode.KeywordError, and values of a
wrong kind with pinode.Error. The parts are checked against each other when they
become a `Case`.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ._arguments import (
    ANY,
    FLAG,
    LIST,
    MAPPING,
    MATRIX,
    NAMES,
    NUMBER,
    PATH,
    POSITIVE,
    TEXT,
    VALUES,
    WHOLE,
    Kind,
    either,
    one_of,
    takes,
)
from ._arrays import rows_of_file
from ._labels import (
    check_floors,
    check_influence,
    check_names_of_columns,
    default_names,
    names_of_columns,
)
from ._part import (
    ArrayLike,
    Part,
    as_list,
    as_mapping,
    as_matrix,
    as_names,
    as_path,
    as_sequence,
    as_strings,
)
from ._part_checks import (
    check_bounds,
    check_damping,
    check_dofs,
    check_functions,
    check_law,
    check_square,
    check_values,
    shape_words,
)
from ._pinode import Error


def _size_of(mass: Any) -> int:
    """Returns the number of rows of a mass matrix, in memory or in a file."""
    if isinstance(mass, (str, os.PathLike)):
        rows = rows_of_file(as_path("mass", mass))
        if rows:
            return rows
        raise Error(f"{mass}: the number of its rows is unknown, expected dofs=[...], a name for each")
    try:
        shape = mass.shape if hasattr(mass, "tocsc") else np.shape(as_matrix(mass))
    except ValueError:  # rows of different lengths
        shape = ()
    if len(shape) != 2:
        raise Error(f"mass is {shape_words(shape)}, expected n x n numbers")
    return shape[0]


_DAMPING = Kind(
    "an array, n x n, {'ratios': [0.02]} for 2 % of critical in every mode, "
    "{'rayleigh': [a0, a1]} or 'none'",
    lambda v: MATRIX.fits(v))
# Keys of a parameter that is searched for.
_PARAMETER = {"initial": NUMBER, "lower": NUMBER, "upper": NUMBER, "prior_mean": NUMBER,
              "prior_sigma": POSITIVE, "free": FLAG, "tie": TEXT, "tie_factor": NUMBER}
_MODEL = {"dofs": NAMES, "influence": MAPPING, "support_mass_coupling": MAPPING,
          "expected_hz": VALUES}
_ACTS_AS = one_of("acceleration", "force")


class Model(Part):
    """Matrices M, C and K of a structure with n degrees of freedom.

    mass, stiffness: n x n, symmetric, full or sparse, in consistent units. These are
        N, m and s unless the case has other `units`.
    damping: n x n; or {"ratios": [0.02]} (fractions of critical), {"rayleigh": [a0,
        a1]} or "none". Required if there are records.
    dofs: n names. Default: names of the columns of frames, else u1, u2, ...
    influence: {direction: n numbers}, the static displacement of each DOF for a unit
        displacement of the ground. Default: {"x": all ones}.
    """

    @takes(mass=MATRIX, stiffness=MATRIX, damping=_DAMPING, **_MODEL)
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
        # Names of the columns, which the case compares with those of its groups.
        self.columns = names_of_columns(mass=mass, stiffness=stiffness, damping=damping)
        if dofs is None:
            dofs = self.columns
        if dofs is None:
            dofs = default_names(_size_of(mass))
        check_square("Model", "mass", mass)
        size = None if isinstance(mass, (str, os.PathLike, Mapping)) else _size_of(mass)
        check_square("Model", "stiffness", stiffness, size)
        check_square("Model", "damping", damping, size)
        check_damping("Model", damping)
        dofs = as_names("dofs", dofs)
        check_dofs("Model", dofs, size, f"mass is {size} x {size}")
        for name, matrix in (("mass", mass), ("stiffness", stiffness), ("damping", damping)):
            check_names_of_columns(f"Model: {name}", names_of_columns(**{name: matrix}), dofs)
        check_influence("Model", influence, dofs)
        super().__init__(
            dofs=dofs,
            mass=as_matrix(mass),
            stiffness=as_matrix(stiffness),
            damping=as_matrix(damping),
            influence=influence,
            **keys,
        )


class ShearBuilding(Part):
    """A mass per floor and a stiffness per storey, from the ground up.

    masses, stiffnesses: one number per floor or storey, in consistent units.
    dampers: damping constant of each storey; or damping: as for Model.
    dofs: names of the floors. Default: u1, u2, ...
    """

    @takes(masses=VALUES, stiffnesses=VALUES, dampers=VALUES, damping=_DAMPING, **_MODEL)
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
        of_floors = as_list(masses)
        of_storeys = as_list(stiffnesses)
        check_values("ShearBuilding", "masses", of_floors, len(of_floors))
        check_values("ShearBuilding", "stiffnesses", of_storeys, len(of_floors))
        if dampers is not None:
            check_values("ShearBuilding", "dampers", as_list(dampers), len(of_floors), zero=True)
        dofs = as_names("dofs", dofs)
        check_dofs("ShearBuilding", dofs, len(of_floors), f"masses {len(of_floors)}")
        check_floors(dofs or default_names(len(of_floors)), keys.get("influence"), masses=masses,
                     stiffnesses=stiffnesses, dampers=dampers)
        check_damping("ShearBuilding", damping)
        super().__init__(
            shear_building=Part(
                masses=of_floors,
                stiffnesses=of_storeys,
                dampers=as_list(dampers),
            ),
            damping=damping,
            dofs=dofs,
            **keys,
        )


class FiniteElementModel(Part):
    """Matrices that a finite-element program has exported, and their reduction.

    mass, stiffness, exported_damping: sparse matrices of SciPy, full ones, or files.
    dofs: names of all DOFs, or the file that lists them. Default: as for Model.
    remove_dofs: names of DOFs that are fixed.
    ground_directions: {name: direction number of the DOFs, 1 to 3}. With {"x": 1} the
        motion "x" moves all DOFs "<node>.1".
    expected_frequencies: frequencies in Hz that the program has found. The case is
        refused if one differs by more than the fraction `frequency_tolerance`.
    reduction: such as {"method": "craig_bampton", "modes": 4}. Required above 100
        DOFs.
    damping: damping of the reduced model, such as {"ratios": [0.02]}, see Model.
    """

    @takes(mass=MATRIX, stiffness=MATRIX, exported_damping=MATRIX, remove_dofs=NAMES,
           ground_directions=MAPPING, expected_frequencies=VALUES, reduction=MAPPING,
           frequency_tolerance=POSITIVE, damping=_DAMPING, **{**_MODEL, "dofs": either(NAMES, PATH)})
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
        frequency_tolerance: float | None = None,
        reduction: Mapping[str, Any] | None = None,
        damping: Mapping[str, Any] | str | None = None,
        **keys: Any,
    ) -> None:
        size = None
        for name, matrix in (("mass", mass), ("stiffness", stiffness),
                             ("exported_damping", exported_damping)):
            check_square("FiniteElementModel", name, matrix, size)
            if name == "mass" and not isinstance(mass, (str, os.PathLike, Mapping)):
                size = _size_of(mass)
        self.columns = names_of_columns(mass=mass, stiffness=stiffness,
                                        exported_damping=exported_damping)
        if isinstance(dofs, os.PathLike):
            dofs = as_path("dofs", dofs)
        dofs = as_strings("dofs", self.columns if dofs is None else dofs)
        if not isinstance(dofs, str):
            check_dofs("FiniteElementModel", dofs, size, f"mass is {size} x {size}")
            known = dofs if dofs is not None or size is None else default_names(size)
            check_names_of_columns("FiniteElementModel: mass", self.columns, known)
        check_damping("FiniteElementModel", damping)
        super().__init__(
            finite_element=Part(
                mass=as_matrix(mass),
                stiffness=as_matrix(stiffness),
                damping=as_matrix(exported_damping),
                dofs=dofs,
                remove_dofs=as_names("remove_dofs", remove_dofs),
                ground_directions=ground_directions,
                expected_frequencies=as_list(expected_frequencies),
                frequency_tolerance=frequency_tolerance,
            ),
            reduction=reduction,
            damping=damping,
            **keys,
        )


class Unknown(Part):
    """An unknown parameter of an element, a sensor or a force.

    A bare number in its place is a fixed value. All numbers are in the parameter's
    unit.

    initial: value with which the fit begins.
    lower, upper: bounds. Default: none.
    prior_mean, prior_sigma: Gaussian prior. Default: `initial`, no prior.
    free: False: the parameter is fixed.
    tie: name of another unknown that this one follows, such as "link1.k3". It takes
        the place of the arguments above.
    tie_factor: multiple of the other unknown. Default: 1.
    """

    @takes(**_PARAMETER)
    def __init__(
        self,
        initial: float | None = None,
        *,
        lower: float | None = None,
        upper: float | None = None,
        prior_mean: float | None = None,
        prior_sigma: float | None = None,
        free: bool | None = None,
        tie: str | None = None,
        tie_factor: float | None = None,
        **keys: Any,
    ) -> None:
        check_bounds("Unknown", lower, upper)
        if tie is None:
            initial = 0.0 if initial is None else initial
            free = True if free is None else free
        super().__init__(
            initial=initial,
            lower=lower,
            upper=upper,
            prior_mean=prior_mean,
            prior_sigma=prior_sigma,
            free=free,
            tie=tie,
            tie_factor=tie_factor,
            **keys,
        )


class Group(Part):
    """A correction alpha * matrix of K, C or M, with the dimensionless unknown alpha.

    name: name of the group and of alpha.
    matrix: n x n, symmetric, in the model's units. Over the DOFs of the model, or over
        all DOFs of a FiniteElementModel with a reduction.
    adds_to: "stiffness", "damping" or "mass".
    between: two DOFs, or a DOF and "ground", joined by a spring with the stiffness
        `scale`, in place of `matrix`.
    storey: number of a storey of a shear building, in place of `matrix`.
    changed_export: matrix that was exported with an element set's property times
        `factor`, for a finite-element model. alpha = -0.1 then is a loss of 10 %.
    mode, ratio: a mode's number and damping ratio, with adds_to="damping": alpha = 0.5
        adds half of the ratio. modes_from in place of mode: all modes from this one.
    initial, lower, upper, prior_sigma: as for Unknown, of alpha.
    """

    @takes(name=TEXT, matrix=MATRIX, adds_to=one_of("stiffness", "damping", "mass"),
           between=NAMES, storey=WHOLE, scale=NUMBER, changed_export=MATRIX, set_export=MATRIX,
           factor=NUMBER, follows=MAPPING, present=NUMBER, proportional_to=TEXT,
           mode=WHOLE, modes_from=WHOLE, ratio=NUMBER, **_PARAMETER)
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
        check_square(f"Group({name!r})", "matrix", matrix)
        check_bounds(f"Group({name!r})", lower, upper)
        # Names of the columns, which the case compares with the DOFs of its model.
        self.columns = names_of_columns(matrix=matrix)
        self.columns_of_changed_export = names_of_columns(changed_export=changed_export)
        self.columns_of_set_export = names_of_columns(set_export=keys.get("set_export"))
        super().__init__(
            name=name,
            adds_to=adds_to,
            matrix=as_matrix(matrix),
            between=as_names("between", between),
            storey=storey,
            scale=scale,
            changed_export=as_matrix(changed_export),
            factor=factor,
            initial=initial,
            lower=lower,
            upper=upper,
            prior_sigma=prior_sigma,
            **keys,
        )


class Element(Part):
    """A force law between two DOFs, or a DOF and the "ground".

    type: "linear", "cubic", "bilinear", "coulomb", "power_damper", "bouc_wen", ...;
        see "Element types" in `pinode/case/README.md`.
    between: names of the two DOFs.
    parameters: {name: number or Unknown}. A number is fixed.
    file: shared library that has the type, see pinode.elements.
    optional: True: the element stays only if the records support it.
    """

    @takes(name=TEXT, type=TEXT, between=NAMES, parameters=MAPPING, file=PATH, optional=FLAG)
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
        values = None if parameters is None else as_mapping("parameters", parameters)
        if file is None:  # the types of a file are known when it is loaded
            check_law(f"Element({name!r})", type, values)
        super().__init__(
            name=name,
            type=type,
            file=None if file is None else as_path("file", file),
            between=as_names("between", between),
            parameters=values,
            optional=optional,
            **keys,
        )


class Library(Part):
    """A sum of functions with unknown coefficients, such as "x[u1]^3".

    inputs: arguments of the functions: "x[u1]" (displacement), "v[u1]" (velocity),
        "d[ground,u1]" (relative displacement), ...
    output: a DOF, or a pair "u1-u2".
    terms: functions, or {"basis": function, "initial": ...}.
    acts_as: "acceleration" (added to dv/dt, default) or "force" (resists).
    select: True: terms that the records do not support are left out.
    """

    @takes(name=TEXT, inputs=NAMES, output=TEXT, terms=LIST, acts_as=_ACTS_AS, select=FLAG)
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
        names = as_names("inputs", inputs)
        functions = as_sequence("terms", terms)
        check_functions(f"Library({name!r})", names, functions)
        super().__init__(
            name=name,
            inputs=names,
            output=output,
            terms=functions,
            acts_as=acts_as,
            select=select,
            **keys,
        )


class Network(Part):
    """A network in place of an unknown force law: feed-forward, or with memory.

    inputs, outputs: as for Library, several of each. With memory: a deformation and its rate,
        and the DOF of the deformation.
    layers: widths of the hidden layers. Default: [20], with memory [6]. [] is a linear map.
    activation: "tanh" (default), "sigmoid", "relu", "softplus", "sine", ... Not with memory.
    acts_as: as for Library. With memory: "force".
    memory: number of sliders with a state of their own, 1 to 4, for a device with hysteresis.
    values: weights of a network with memory, as model.toml has them. They need input_scale
        and output_scale.
    decay: weight decay. Default: by the evidence, with memory 0.1.
    seed: seed of the initial weights.
    """

    @takes(name=TEXT, inputs=NAMES, outputs=NAMES, layers=VALUES, activation=TEXT,
           acts_as=_ACTS_AS, memory=WHOLE, values=VALUES, seed=WHOLE, input_scale=VALUES,
           output_scale=VALUES, bias=FLAG,
           skip=either(FLAG, TEXT), gauge=ANY, decay=NUMBER, weights=ANY, free=FLAG, truth=ANY)
    def __init__(
        self,
        name: str,
        inputs: Sequence[str],
        outputs: Sequence[str],
        *,
        layers: Sequence[int] | None = None,
        activation: str | None = None,
        acts_as: str | None = None,
        memory: int | None = None,
        seed: int | None = None,
        **keys: Any,
    ) -> None:
        super().__init__(
            name=name,
            inputs=as_names("inputs", inputs),
            outputs=as_names("outputs", outputs),
            layers=as_list(layers),
            activation=activation,
            acts_as=acts_as,
            memory=memory,
            seed=seed,
            **keys,
        )


class UnknownForce(Part):
    """History of an unmeasured force at a DOF.

    dof: name of the DOF.
    shape: "cubic" or "linear": a spline in time; "half_sine": a blow.
    record: name of the record in which the force acts.
    window: first and last time of the spline in s.
    knot_spacing: time between its knots in s.
    scale: approximate size of the force, in the model's unit of force.
    parameters: of a half sine: start, duration and amplitude, numbers or Unknown.
    """

    @takes(name=TEXT, dof=TEXT, shape=TEXT, record=TEXT, window=VALUES, knot_spacing=POSITIVE,
           scale=POSITIVE, parameters=MAPPING, neighbourhood=NUMBER, relaxation=NUMBER,
           band_hz=either(NUMBER, VALUES), values=VALUES, free=FLAG, truth=ANY)
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
            window=as_list(window),
            knot_spacing=knot_spacing,
            scale=scale,
            parameters=parameters,
            **keys,
        )
