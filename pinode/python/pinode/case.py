"""Cases: a model with its unknowns, and what was measured of it."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _html, _pinode
from ._arguments import ANY, FLAG, MAPPING, NUMBER, TEXT, WHOLE, takes, unknown_keyword
from ._case_tables import KEYS, check_parts, purpose_of, tables_of
from ._part import as_flag, as_folder, as_mapping, as_number, as_path, as_watcher
from ._pinode import Error
from ._words import speaks_python
from .progress import watched

if TYPE_CHECKING:
    from .forecast import Check, SensorPlan, Simulation
    from .result import Damage, Discovery, Fit
    from .result_folder import ResultFolder

Progress = Callable[[Mapping[str, Any]], Any]

# Further tables of a case file.
_TABLES = ("modal", "damage", "profiles", "discover", "simulate", "plan", "geometry")
_KEYWORDS = ("title", "units", "options", *KEYS, *_TABLES)


class Case:
    """What is to be identified from what.

    Everything is checked when a case is made: sizes, units, names, numbers, and
    the integration steps. A model alone is a case, of which `modes` and `check`
    can be asked; one whose channels have no values can be simulated.

    model: a Model, ShearBuilding or FiniteElementModel.
    groups, elements, libraries, networks, unknown_forces: its unknowns.
    records, modes: what was measured.
    units: {"force": "kN", "length": "mm"}; N, m and s unless given.
    options: of the fit, as [options] of a case file.
    reference_curves: known force curves, {"term": "damper", "deformation": values,
        "force": values}, drawn beside what is found.
    Further tables of a case file (`modal`, `damage`, `profiles`, `discover`,
        `simulate`, `plan`, `geometry`) by name. To plan sensors records need no
        channels.
    """

    @speaks_python
    @takes(model=MAPPING, units=MAPPING, options=MAPPING, reference_curves=ANY,
           **dict.fromkeys(_TABLES, MAPPING))
    def __init__(
        self,
        model: Mapping[str, Any],
        *,
        groups: Sequence[Mapping[str, Any]] | None = None,
        elements: Sequence[Mapping[str, Any]] | None = None,
        libraries: Sequence[Mapping[str, Any]] | None = None,
        networks: Sequence[Mapping[str, Any]] | None = None,
        unknown_forces: Sequence[Mapping[str, Any]] | None = None,
        records: Sequence[Mapping[str, Any]] | None = None,
        modes: Sequence[Mapping[str, Any]] | None = None,
        title: str | None = None,
        units: Mapping[str, str] | None = None,
        options: Mapping[str, Any] | None = None,
        **tables: Any,
    ) -> None:
        given = {
            "title": title,
            "units": units,
            "model": model,
            "groups": groups,
            "elements": elements,
            "libraries": libraries,
            "networks": networks,
            "unknown_forces": unknown_forces,
            "records": records,
            "modes": modes,
            "options": options,
            **tables,
        }
        self._parts = {k: v for k, v in given.items() if v is not None}
        check_parts(self._parts)
        tree = tables_of(self._parts)
        self._handle = _pinode.CaseHandle.from_tree(tree, "", purpose_of(tree))

    @classmethod
    def _of(cls, handle: Any, parts: dict[str, Any] | None = None) -> "Case":
        case = cls.__new__(cls)
        case._handle = handle
        case._parts = parts
        return case

    @classmethod
    def read(
        cls,
        path: str | os.PathLike[str],
        *,
        simulation: bool = False,
        planning: bool = False,
    ) -> "Case":
        """The case of a file.

        simulation: its responses are not read. planning: neither are they, and
        records need no channels, as for `pinode_check --plan`; a case with a record
        without channels is read so by itself.
        """
        for name, value in (("simulation", simulation), ("planning", planning)):
            as_flag(name, value)
        purpose = "planning" if planning else "simulation" if simulation else "any"
        return cls._of(_pinode.CaseHandle.read(as_path("path", path), purpose))

    @classmethod
    def from_dict(cls, tree: Mapping[str, Any], *, path: str = "") -> "Case":
        """The case of the tables of a case file, with arrays in place of files.

        path: where it would stand, for messages and relative paths.
        """
        tree = as_mapping("tree", tree)
        return cls._of(_pinode.CaseHandle.from_tree(tree, path, purpose_of(tree)))

    def replace(self, **parts: Any) -> "Case":
        """The same case with other parts, such as the records of another day."""
        if self._parts is None:
            tree = self._handle.tree()
            check_parts(parts)
            other = tables_of(parts)
            tree.update(other)
            purpose = purpose_of(tree)
            # What it was read for, its tables do not say.
            if "record" not in other and purpose != "planning":
                purpose = self._handle.purpose.replace("fit", "check")
            return Case._of(_pinode.CaseHandle.from_tree(tree, self.path, purpose))
        for name in parts:
            if name not in _KEYWORDS:
                raise unknown_keyword("Case.replace", name, _KEYWORDS)
        return Case(**{**self._parts, **parts})

    # What it is.

    @property
    def path(self) -> str:
        """Of its file; empty: from memory."""
        return self._handle.path

    @property
    def title(self) -> str:
        """As its file or its maker says; empty: nobody has."""
        return self._handle.title

    @property
    def dofs(self) -> list[str]:
        """Names of the degrees of freedom, in the order of the matrices."""
        return self._handle.dofs

    @property
    def mass(self) -> np.ndarray:
        """M, n x n, in the model's units."""
        return self._handle.mass

    @property
    def damping(self) -> np.ndarray:
        """C, n x n."""
        return self._handle.damping

    @property
    def stiffness(self) -> np.ndarray:
        """K, n x n."""
        return self._handle.stiffness

    @property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """Named parameters with their values before a fit, units and bounds."""
        return {p["name"]: p for p in self._handle.parameters()}

    @property
    def records(self) -> dict[str, dict[str, Any]]:
        """Of each record its role, samples, step (s) and channels."""
        return {r["name"]: r for r in self._handle.records()}

    def measured(self, record: str) -> dict[str, np.ndarray]:
        """The record's `time` and channels as they are fitted: cut, resampled
        and filtered as the case asks for, in the units of their file."""
        return self._handle.measured(record)

    def natural_modes(self) -> dict[str, Any]:
        """Modes of the model as it is, ascending.

        frequencies_hz: undamped, NaN where the stiffness is negative.
        damping_ratios: fractions of critical.
        shapes: n x modes, mass-normalised; dofs: of their rows.
        """
        return self._handle.modes()

    def full_matrices(self) -> dict[str, Any]:
        """Of a case with a finite-element model the matrices of all DOFs of the
        export, as SciPy's csc_array, where `mass` and the others are those of
        the coordinates to which it is reduced.

        dofs: names of the rows; mass, damping, stiffness: n x n in the model's
        units; groups: {name: matrix}. None where one is known for the
        coordinates alone.
        """
        matrices = self._handle.full_matrices()
        from scipy.sparse import csc_array

        def matrix(compressed: Any) -> Any:
            if compressed is None:
                return None
            parts, size = compressed
            return csc_array(parts, shape=(size, size))

        return {
            "dofs": matrices["dofs"],
            **{key: matrix(matrices[key]) for key in ("mass", "damping", "stiffness")},
            "groups": {name: matrix(parts) for name, parts in matrices["groups"].items()},
        }

    def to_dict(self) -> dict[str, Any]:
        """The tables of the case as a file has them, with arrays."""
        return self._handle.tree()

    def to_toml(self) -> str:
        """The text of a case file; arrays go by names in <...>."""
        return self._handle.toml()

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes case.toml, and files for its arrays, to `folder`. Files that it names
        stay where they are and are named as seen from there."""
        self._handle.save(as_path("folder", folder))

    # What can be done with it.

    @speaks_python
    @takes()
    def check(
        self,
        *,
        output: str | os.PathLike[str] = "",
        overwrite: bool = False,
        mat: bool = False,
    ) -> "Check":
        """What an identification could find, without one: a dictionary.

        expected: deviation of each free parameter, from the noise given or 5 %.
        undetermined: what the sensors and the loads cannot see; remarks, sizes,
        and the integration steps of each record.

        output: a folder with that and the model, its modes and matrices, as
            `pinode_check` writes it; `mat`: with results.mat.
        """
        from .forecast import Check

        output = as_folder(output, mat)
        return Check(self._handle.check(output, overwrite, mat))

    @speaks_python
    @takes(noise=TEXT, seed=WHOLE)
    def simulate(
        self,
        *,
        noise_percent: float | None = None,
        noise: str | None = None,
        seed: int | None = None,
    ) -> "Simulation":
        """The response of the model to the excitation of each record.

        noise_percent: of each channel's standard deviation, added to it; or
        noise: "sigma", each channel's own `sigma`; as the case says unless one
            is given. seed: of this noise.
        """
        from .forecast import Simulation

        wanted = {
            # Below zero: as the case says.
            "noise_percent": -1.0 if noise_percent is None else _percent(noise_percent),
            "seed": seed,
            "noise": noise,
        }
        return Simulation(_pinode.simulate(self._handle, **wanted), self, wanted)

    @speaks_python
    @takes(num_sensors=WHOLE, force_at=TEXT, overwrite=FLAG)
    def plan_sensors(
        self,
        num_sensors: int,
        *,
        force_at: str = "",
        output: str | os.PathLike[str] = "",
        overwrite: bool = False,
        mat: bool = False,
    ) -> "SensorPlan":
        """The sensors that tell most about the groups, for the loads of the
        training records; nothing need have been measured, nothing is fitted.

        Table `plan` of the case says what there is to choose from (places,
        their noise, criterion, durations); without it accelerometers anywhere.
        force_at: a DOF; the first force of each record acts there, and no other
            load does: where to hit. The DOFs of `excite` of that table are tried
            as well (SensorPlan.by_force_at).
        output: a folder with the plan as `pinode_check --plan` writes it, but for
            other places of the force; `mat`: with results.mat.
        """
        from .forecast import SensorPlan

        plan = _pinode.plan_sensors(
            self._handle,
            num_sensors,
            force_at,
            as_folder(output, mat),
            overwrite,
            mat,
        )
        places = () if force_at else plan["excite"]
        return SensorPlan(
            plan,
            {
                dof: SensorPlan(_pinode.plan_sensors(self._handle, num_sensors, dof))
                for dof in places
            },
        )

    @speaks_python
    @takes(profiles=FLAG, threads=WHOLE, overwrite=FLAG, resume=FLAG)
    def identify(
        self,
        *,
        begin_from: "Fit | None" = None,
        profiles: bool = False,
        threads: int = 0,
        progress: bool | None = None,
        callback: Progress | None = None,
        output: str | os.PathLike[str] = "",
        overwrite: bool = False,
        resume: bool = False,
        mat: bool = False,
    ) -> "Fit":
        """Finds the unknowns.

        begin_from: a fit whose values this one begins from.
        profiles: of the likelihood of each named free parameter, too.
        threads: as the case says unless given.
        progress: a bar; by default where there is a terminal or a notebook.
        callback: called after each iteration with a dictionary (stage,
            iteration, cost, free_run_error, ...); ends the fit where it returns
            False.
        output: a result folder, written as `pinode_update` does, with a
            checkpoint on the way from which `resume` goes on; `mat`: with
            results.mat, for MATLAB and Octave.

        Ctrl-C stops after the iteration and returns the best so far, whose
        `termination` is "interrupted". A second Ctrl-C, in this fit or within ten
        seconds, raises KeyboardInterrupt, so that it ends a loop of fits.
        """
        from .result import Fit

        with watched(*as_watcher(progress, callback)) as call:
            return Fit(
                _pinode.identify(
                    self._handle,
                    begin_from=_handle_of_fit(begin_from),
                    profiles=profiles,
                    threads=threads,
                    callback=call,
                    output=as_folder(output, mat),
                    overwrite=overwrite,
                    resume=resume,
                    mat=mat,
                )
            )

    @speaks_python
    @takes(threshold=NUMBER, false_alarm_rate=NUMBER, threads=WHOLE, overwrite=FLAG,
           resume=FLAG)
    def damage(
        self,
        baselines: "Sequence[Fit | ResultFolder | str | os.PathLike[str]]",
        *,
        threshold: float = 0.05,
        false_alarm_rate: float = 0.05,
        threads: int = 0,
        progress: bool | None = None,
        callback: Progress | None = None,
        output: str | os.PathLike[str] = "",
        overwrite: bool = False,
        resume: bool = False,
        mat: bool = False,
    ) -> "Damage":
        """Fits the case and says what has changed since healthy records.

        baselines: fits of these, or their result folders.
        threshold: loss of stiffness from which damage is called on one
            baseline, a fraction; with several a smaller one counts too where
            healthy records differ by less.
        false_alarm_rate: probability of calling a change where there is none.
        output: a result folder, written as `pinode_damage` does; see identify.
        """
        from .result import Damage, _baselines

        with watched(*as_watcher(progress, callback)) as call:
            return Damage(
                _pinode.damage(
                    self._handle,
                    None,
                    _baselines(baselines),
                    threshold=threshold,
                    false_alarm_rate=false_alarm_rate,
                    threads=threads,
                    callback=call,
                    output=as_folder(output, mat),
                    overwrite=overwrite,
                    resume=resume,
                    mat=mat,
                )
            )

    @speaks_python
    @takes(threads=WHOLE, overwrite=FLAG, resume=FLAG)
    def discover(
        self,
        *,
        model: "Fit | ResultFolder | str | os.PathLike[str] | None" = None,
        threads: int = 0,
        progress: bool | None = None,
        callback: Progress | None = None,
        output: str | os.PathLike[str] = "",
        overwrite: bool = False,
        resume: bool = False,
        mat: bool = False,
    ) -> "Discovery":
        """Closed-form equations in place of the networks of a model, as `discover`
        of the case says; or without one from the derivatives of smoothed records
        (`discover={"source": "derivatives"}`).

        model: a fit of this case, or the result folder of one.
        output: a result folder, written as `pinode_discover` does, with a
            checkpoint on the way from which `resume` goes on.
        """
        from .result import Discovery, _model

        output = as_folder(output, mat)
        handle = _model(self, model, output)
        with watched(*as_watcher(progress, callback)) as call:
            return Discovery(
                _pinode.discover(
                    self._handle,
                    handle,
                    threads=threads,
                    callback=call,
                    output=output,
                    overwrite=overwrite,
                    resume=resume,
                    mat=mat,
                )
            )

    def __repr__(self) -> str:
        return (
            f"Case({self.title or self.path or 'from memory'}: "
            f"{len(self.dofs)} DOFs, {len(self.records)} records, "
            f"{sum(p['free'] for p in self.parameters.values())} free parameters)"
        )

    def _repr_html_(self) -> str:
        rows = [
            [p["name"], p["value"], p["unit"], "free" if p["free"] else "fixed"]
            for p in self.parameters.values()
        ]
        records = [
            [r["name"], r["role"], r["num_samples"], r["step"], ", ".join(r["channels"])]
            for r in self.records.values()
        ]
        return _html.section(
            repr(self),
            _html.table(["parameter", "value", "unit", ""], rows),
            _html.table(["record", "role", "samples", "step", "channels"], records),
        )

    def __reduce__(self) -> tuple[Any, ...]:
        tree = self._handle.tree()
        return _restore, (tree, self.path, self._handle.purpose)


def _percent(noise: Any) -> float:
    percent = as_number("noise_percent", noise)
    if percent < 0.0:
        raise Error(f"noise_percent is {percent:g}, expected 0 or more")
    return percent


def _handle_of_fit(fit: Any) -> Any:
    if fit is None:
        return None
    handle = getattr(fit, "_handle", None)
    if not isinstance(handle, _pinode.FitHandle):
        raise Error(f"begin_from is a value of type {type(fit).__name__}, expected a fit")
    return handle


def _restore(tree: dict[str, Any], path: str, purpose: str) -> Case:
    return Case._of(_pinode.CaseHandle.from_tree(tree, path, purpose))


@takes()
def read_case(
    path: str | os.PathLike[str], *, simulation: bool = False, planning: bool = False
) -> Case:
    """The case of a file; see Case.read."""
    return Case.read(path, simulation=simulation, planning=planning)


__all__ = ["Case", "read_case"]
