"""Cases: a model with its unknowns, and the measurements."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _html, _pinode
from ._arguments import (ANY, COUNT, FLAG, MAPPING, NUMBER, POSITIVE, TEXT, WHOLE, takes,
                         unknown_keyword)
from ._case_tables import KEYS, check_order, check_parts, purpose_of, tables_of
from ._part import as_flag, as_folder, as_mapping, as_number, as_path, as_watcher, counted
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
    """A case: a model with its unknowns, and the measurements.

    A new case is checked: sizes, units, names, numbers and integration steps. A model
    without records has `natural_modes` and `check`. A case whose channels have no
    values can be simulated.

    model: a Model, ShearBuilding or FiniteElementModel.
    groups, elements, libraries, networks, unknown_forces: lists of the unknowns.
    records, modes: lists of the measurements.
    frfs: list of frequency response functions, each a dictionary with the keys of
        `[[frf]]` in a case file, such as {"files": [...], "dofs": {...}}.
    title: a text for reports.
    units: units of the model, such as {"force": "kN", "length": "mm"}. Default: N, m,
        s.
    options: options of the fit, with the keys of [options] in a case file.
    reference_curves: known force curves that figures show for comparison, such as
        {"term": "damper", "deformation": values, "force": values}.
    tables: further tables of a case file by name: `modal`, `damage`, `profiles`,
        `discover`, `simulate`, `plan`, `geometry`.

    Raises pinode.Error with a sentence if a part is not valid or does not fit the
    others, and pinode.KeywordError for an unknown keyword.
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
        frfs: Sequence[Mapping[str, Any]] | None = None,
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
            "frfs": frfs,
            "options": options,
            **tables,
        }
        self._parts = {k: v for k, v in given.items() if v is not None}
        check_parts(self._parts)
        tree = tables_of(self._parts)
        self._handle = _pinode.CaseHandle.from_tree(tree, "", purpose_of(tree))
        check_order(self._parts, tree, self._handle.dofs)

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
        """Reads a case file and the files that it names.

        simulation: True: measured responses are not read, as for `pinode_simulate`.
        planning: True: records also need no channels, as for `pinode_check --plan`.
            This is the default if a record has no channels.

        Raises pinode.Error, which names the line of the file.
        """
        for name, value in (("simulation", simulation), ("planning", planning)):
            as_flag(name, value)
        purpose = "planning" if planning else "simulation" if simulation else "any"
        return cls._of(_pinode.CaseHandle.read(as_path("path", path), purpose))

    @classmethod
    def from_dict(cls, tree: Mapping[str, Any], *, path: str = "") -> "Case":
        """Makes a case from the tables of a case file, with arrays in place of files.

        path: path of the case for messages and for relative paths.
        """
        tree, path = as_mapping("tree", tree), as_path("path", path)
        return cls._of(_pinode.CaseHandle.from_tree(tree, path, purpose_of(tree)))

    def replace(self, **parts: Any) -> "Case":
        """Returns the same case with other parts, such as the records of another day.
        """
        if self._parts is None:
            tree = self._handle.tree()
            check_parts(parts)
            other = tables_of(parts, tree.get("model"))
            tree.update(other)
            purpose = purpose_of(tree)
            # The tables do not state the purpose for which the case was read.
            if "record" not in other and purpose != "planning":
                purpose = self._handle.purpose.replace("fit", "check")
            handle = _pinode.CaseHandle.from_tree(tree, self.path, purpose)
            check_order(parts, other, handle.dofs)
            return Case._of(handle)
        for name in parts:
            if name not in _KEYWORDS:
                raise unknown_keyword("Case.replace", name, _KEYWORDS)
        return Case(**{**self._parts, **parts})

    # Contents of the case.

    @property
    def path(self) -> str:
        """Path of the case file. Empty: the case is from memory."""
        return self._handle.path

    @property
    def title(self) -> str:
        """Title of the case. Empty: none was given."""
        return self._handle.title

    @property
    def dofs(self) -> list[str]:
        """Names of the degrees of freedom, in the order of the matrices."""
        return self._handle.dofs

    @property
    def mass(self) -> np.ndarray:
        """Mass matrix M, n x n, in the model's units."""
        return self._handle.mass

    @property
    def damping(self) -> np.ndarray:
        """Damping matrix C, n x n, in the model's units."""
        return self._handle.damping

    @property
    def stiffness(self) -> np.ndarray:
        """Stiffness matrix K, n x n, in the model's units."""
        return self._handle.stiffness

    @property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """Named parameters with their initial values, units and bounds."""
        return {p["name"]: p for p in self._handle.parameters()}

    @property
    def records(self) -> dict[str, dict[str, Any]]:
        """Records: role, number of samples, step (s) and channels of each."""
        return {r["name"]: r for r in self._handle.records()}

    def measured(self, record: str) -> dict[str, np.ndarray]:
        """Returns `time` and the channels of a record as the fit uses them.

        They are cut, resampled and filtered as the case requires. Each is an array
        with one value per sample, in the units of the record's file.
        """
        return self._handle.measured(record)

    def natural_modes(self) -> dict[str, Any]:
        """Modes of the initial model, ascending by frequency.

        frequencies_hz: without damping, in Hz; NaN for negative stiffness.
        damping_ratios: fractions of critical.
        shapes: n x modes, mass-normalised.
        dofs: names of the rows of `shapes`.
        directions: names of the directions of ground motion.
        participation: modes x directions, phi' (M r + M_fs).
        effective_masses: their squares, in units of mass.
        moving_masses: sum of the effective masses of all modes, per direction.
        """
        return self._handle.modes()

    def full_matrices(self) -> dict[str, Any]:
        """Matrices of a finite-element model over all its DOFs, as SciPy's csc_array.

        `mass`, `damping` and `stiffness` of the case are over the coordinates of the
        reduction; these are over all n DOFs of the export.

        dofs: names of the rows.
        mass, damping, stiffness: n x n, in the model's units.
        groups: {name: matrix}, n x n.

        A matrix is None if it is known only over the coordinates.
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
        """Returns the tables of a case file, with arrays in place of files."""
        return self._handle.tree()

    def to_toml(self) -> str:
        """Returns the text of a case file. Arrays are replaced by their names in
        <...>.
        """
        return self._handle.toml()

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes case.toml, and files for its arrays, to `folder`.

        Files that the case names stay at their place. Their paths are then relative
        to `folder`.
        """
        self._handle.save(as_path("folder", folder))

    # Actions.

    @speaks_python
    @takes(overwrite=FLAG)
    def check(
        self,
        *,
        output: str | os.PathLike[str] = "",
        overwrite: bool = False,
        mat: bool = False,
    ) -> "Check":
        """Predicts the result of an identification, without a fit. Returns a
        dictionary.

        expected: standard deviation of each free parameter that a fit would have. The
            noise of a channel is the given one, or 5 % of its standard deviation.
        undetermined: combinations of parameters that sensors and loads do not
            determine.
        remarks, assessment_remarks: sentences on the case, and on units and signs of its
            records.
        steps: integrator and steps per sample of each record.
        num_free, num_residuals, num_starts: numbers of free parameters, residuals and
            unknown initial states.
        not_assessed: reason why there is no prediction. Without measurements or a
            prediction there are only `steps` and `remarks` beside it.

        Arguments:

        output: folder for these results, the model, its modes and matrices, as
            `pinode_check` writes them. Empty: nothing is written.
        overwrite: True: an existing folder of results is replaced.
        mat: True: also writes results.mat.
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
        """Simulates the response of the model to the excitation of each record.

        noise_percent: noise to be added, in per cent of each channel's standard
            deviation.
        noise: "sigma": the noise of each channel is its own `sigma`.
        seed: seed of the noise.

        Without these arguments the table `simulate` of the case decides.
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
    @takes(load=TEXT, from_hz=POSITIVE, to_hz=POSITIVE, amplitude=POSITIVE, points=WHOLE)
    def sweep(
        self,
        load: str,
        from_hz: float,
        to_hz: float,
        *,
        amplitude: float = 1.0,
        points: int = 200,
    ) -> dict[str, Any]:
        """Follows the periodic responses to a harmonic load over its frequency, also where
        several belong to one frequency. See "Periodic responses" in the theory.

        load: name of a measured force or ground motion, "force_<dof>" or "ground_<direction>".
        from_hz, to_hz: first and last frequency, Hz.
        amplitude: amplitude of the load, in the model's units.
        points: number of points if the curve does not turn back, at least 2.

        Returns a dictionary of arrays with an entry per point of the curve, and two more:

        frequency_hz: frequency of the load.
        channels: by name, with `half_range` (half of the range), and `amplitude` and `phase`
            (rad) at the load's frequency, in the units of the first record's file.
        largest_multiplier: above 1 the response is not stable; 1 without damping; NaN:
            unknown.
        num_harmonics, neglected: harmonics in use, and relative size of the others. Points
            with `neglected` above 1e-3 are of no use.
        finished, remark: False if the curve could not be followed to its end, and the reason.

        Raises pinode.Error if the load is unknown, or if the model has a network or follows the time.
        """
        return _pinode.sweep(self._handle, load, float(from_hz), float(to_hz),
                             float(amplitude), points)

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
        """Finds the sensors with the most information about the groups.

        The loads are those of the training records. No measured response and no fit
        is needed. The table `plan` of the case lists places, their noise, criterion
        and durations. Without it, accelerometers may be at all DOFs.

        num_sensors: number of sensors to choose.
        force_at: DOF at which the first force of each record acts. No other load acts
            then. Empty: loads act as in the records. The DOFs of `excite` in the
            table are tried as well (SensorPlan.by_force_at).
        output: folder for the plan, as `pinode_check --plan` writes it, without other
            places of the force.
        overwrite: True: an existing folder of results is replaced.
        mat: True: also writes results.mat.
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
    @takes(profiles=FLAG, threads=COUNT, overwrite=FLAG, resume=FLAG)
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
        """Finds the unknowns. Returns a Fit.

        begin_from: a fit with whose values this one begins.
        profiles: True: also computes the likelihood profile of each named free
            parameter.
        threads: number of threads. 0: as the case says.
        progress: True shows a progress bar. Default: in a terminal or a notebook.
        callback: function that is called after each iteration with a dictionary
            (stage, iteration, cost, free_run_error, ...). The fit stops if it returns
            False.
        output: result folder, as `pinode_update` writes it, with checkpoints during
            the fit. Empty: nothing is written.
        overwrite: True: an existing folder of results is replaced.
        resume: True: continues from the checkpoint in `output`.
        mat: True: also writes results.mat, for MATLAB and Octave.

        Ctrl-C stops the fit after the current iteration and returns the best result
        so far, with the `termination` "interrupted". A second Ctrl-C, in this fit or
        within ten seconds, raises KeyboardInterrupt, so that it ends a loop of fits.

        Raises pinode.Error if an argument is not valid. A fit that fails raises
        nothing: see Fit.usable and Fit.sentence.
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
    @takes(threshold=NUMBER, false_alarm_rate=NUMBER, threads=COUNT, overwrite=FLAG,
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
        """Fits the case and finds the changes relative to baselines. Returns a Damage.

        baselines: fits of earlier records, or their result folders.
        threshold: loss of stiffness that counts as damage, as a fraction. With
            several baselines a smaller loss also counts if the baselines differ less.
        false_alarm_rate: probability of reporting a change if there is none.
        output: result folder, as `pinode_damage` writes it.

        The other arguments are those of identify.
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
    @takes(threads=COUNT, overwrite=FLAG, resume=FLAG)
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
        """Finds closed-form equations that replace the networks of a model.

        The table `discover` of the case has the options. With
        `discover={"source": "derivatives"}` no trained network is needed: the
        equations come from the derivatives of smoothed records.

        model: a fit of this case, or its result folder.
        output: result folder, as `pinode_discover` writes it, with checkpoints.

        The other arguments are those of identify. Returns a Discovery.
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
            f"{counted(len(self.dofs), 'DOF')}, {counted(len(self.records), 'record')}, "
            f"{counted(sum(p['free'] for p in self.parameters.values()), 'free parameter')})"
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
    """Reads a case file, see Case.read."""
    return Case.read(path, simulation=simulation, planning=planning)


__all__ = ["Case", "read_case"]
