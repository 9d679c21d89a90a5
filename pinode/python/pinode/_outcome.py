"""Common part of all results of a fit."""

from __future__ import annotations

import functools
import json
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _html, _pinode
from ._arguments import FLAG, takes, words_of
from ._part import as_path, as_text
from ._pinode import Error
from ._predicted import RecordResult, predicted
from ._result_tables import summary_lines, tables
from .case import Case
from .structure_view import StructureView

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from .measurements import Record


class Parameter(NamedTuple):
    """A named parameter in the model's units, with its 95 % interval.

    sigma and the interval are infinite if the data do not determine the parameter.
    They are NaN or infinite for a fixed parameter.

    If the model is incomplete (verdict "with_care"), lower95 and upper95 include the
    values under other explanations. half_width95 is that of the interval that assumes
    a complete model.

    tie is the name of the parameter that this one follows, with tie_factor; empty if
    it is not tied.
    """

    name: str
    unit: str
    initial: float
    value: float
    sigma: float
    lower95: float
    upper95: float
    half_width95: float
    free: bool
    at_bound: bool
    tie: str = ""
    tie_factor: float = 1.0


class Outcome:
    """Common part of fits, damage analyses and discoveries: a fit."""

    def __init__(self, handle: Any) -> None:
        self._handle = handle
        self._json: dict[str, Any] | None = None

    @property
    def usable(self) -> bool:
        """True if the result may be used. If not, `message` has the reason."""
        return self._handle.usable

    @property
    def verdict(self) -> str:
        """Grade of the fit: "good", "with_care" or "not_usable"."""
        return self._handle.verdict

    @property
    def sentence(self) -> str:
        """Grade of the fit in words, with the reason."""
        return self._handle.sentence

    @property
    def findings(self) -> list[dict[str, Any]]:
        """Failed checks, from which the verdict follows. Empty: the result is good.

        Each has `check`, `what`, `grade`, `number`, `limit` and `advice`.
        """
        return self._handle.findings

    @property
    def explanations(self) -> list[dict[str, Any]]:
        """Explanations of unexplained motion, best first: further unknowns with which
        the model was fitted again.

        Each is a dictionary:

        what, kind, place: description, kind for programs, and DOF, group or sensor.
        log_odds: natural logarithm of the odds relative to the present model.
        probability: probability among all explanations that were tried.
        value, lower95, upper95: the unknown with its 95 % interval.
        values: values of the named parameters under the explanation.
        removes: fraction of the squared error that it removes.
        leaves: remaining unexplained motion, as a fraction of the motion.
        moved, shift: parameter that changes most, and its change in half widths of
            its interval.
        """
        return self._handle.explanations

    @property
    def levels_of_motion(self) -> list[dict[str, Any]]:
        """Levels of motion in the training records, one dictionary per sensor.

        channel, dof, quantity, unit: sensor, its place, and the model's unit.
        lowest, mean, highest: RMS over four parts of a record with equal energy.

        If the verdict is "with_care", values may differ at other levels of motion.
        """
        return self._handle.levels_of_motion

    @property
    def message(self) -> str:
        """Result of the fit in a sentence."""
        return self._handle.message

    @property
    def termination(self) -> str:
        """Reason for the end of the fit: "converged", "no_convergence", "interrupted"
        or "failure".
        """
        return self._handle.termination

    @property
    def remarks(self) -> list[str]:
        """Remarks on data and result, one sentence each."""
        return self._handle.remarks + self._handle.troubles

    @property
    def seconds(self) -> float:
        """Duration of the fit in seconds."""
        return self._handle.seconds

    @property
    def case(self) -> Case:
        """Case as it was fitted, without terms that were left out."""
        return Case._of(self._handle.case())

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Named parameters with their identified values."""
        return {p["name"]: Parameter(**p) for p in self._handle.parameters()}

    def __getitem__(self, name: str) -> float:
        """Returns the value of a named parameter, in its unit."""
        try:
            return self.parameters[name].value
        except KeyError:
            raise KeyError(
                f"there is no parameter '{name}'; there are "
                + ", ".join(self.parameters)
            ) from None

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the free named parameters, square, in the order of
        covariance_names.
        """
        return self._handle.covariance

    @property
    def covariance_names(self) -> list[str]:
        """Names of the rows and columns of `covariance`."""
        return self._handle.covariance_names

    def record(self, name: str | None = None) -> RecordResult:
        """Returns a record of the case with its prediction. Default: the first
        record.
        """
        if name is None:
            records = self.json["records"]
            if not records:
                raise Error("the result has no record")
            name = records[0]["name"]
        return RecordResult(**self._handle.record(as_text("name", name)))

    @property
    def records(self) -> dict[str, dict[str, Any]]:
        """Errors of the simulations by record: role, nrmse, prior_nrmse (initial
        model), channels.

        nrmse is |y - simulation| / |y - mean(y)|.
        """
        return {r["name"]: r for r in self.json["records"]}

    @functools.cached_property
    def _before(self) -> dict[str, dict[str, np.ndarray]]:
        return self._handle.before()

    def before(self, record: str | None = None) -> dict[str, np.ndarray]:
        """Returns the simulation of a record with the initial model, by channel.

        It is the simulation of prior_nrmse, in the units of the record's file. If the
        record's start is free, the simulation begins with the start that fits best.
        Empty: it diverges.
        """
        if record is None:
            record = next(iter(self.records), None)
            if record is None:
                raise Error("the result has no record")
        if not isinstance(record, str):
            raise Error(f"record is a value of type {type(record).__name__}, expected a name")
        if record not in self._before:
            raise Error(f"there is no record '{record}' in the result")
        return self._before[record]

    @property
    def modes(self) -> list[dict[str, Any]]:
        """Modes of the initial and the updated model: initial_hz, updated_hz,
        initial_damping, updated_damping (fractions of critical), mac, and
        updated_mass_share: effective mass of the updated mode in parts of the
        moving mass, per direction of ground motion.
        """
        return self.json["modes"]

    @property
    def mass(self) -> np.ndarray:
        """Identified mass matrix M with its groups, n x n, in the model's units."""
        return self._handle.matrices()["mass"]

    @property
    def damping(self) -> np.ndarray:
        """Identified damping matrix C with its groups, n x n, in the model's units."""
        return self._handle.matrices()["damping"]

    @property
    def stiffness(self) -> np.ndarray:
        """Identified stiffness matrix K with its groups, n x n, in the model's units.
        """
        return self._handle.matrices()["stiffness"]

    @property
    def forces(self) -> dict[str, dict[str, Any]]:
        """Unknown forces by name: record, unit, time, force, lower95, upper95.

        `truth` has the time and force of the true force, if the case gives one.
        """
        return {f["name"]: f for f in self._handle.forces()}

    @property
    def profiles(self) -> dict[str, dict[str, Any]]:
        """Profiles of the likelihood by parameter, if they were requested."""
        return {p["name"]: p for p in self._handle.profiles()}

    @property
    def loops(self) -> list[dict[str, Any]]:
        """Forces of elements, libraries and networks along the predicted states.

        Each has term, deformation, rate, force and time, with their units. `known`
        has name, deformation and force of the term's reference curve.
        """
        return self._handle.loops()

    @property
    def ambient(self) -> dict[str, dict[str, Any]]:
        """Spectral densities of ambient records, measured and modelled.

        They are channels x frequencies, in the unit of the channel squared per Hz,
        without the response to measured loads. Measured values are means of `lines`
        lines. Each channel has the fraction of its power that is explained, in all
        and by measured loads.
        """
        return {a["name"]: a for a in self._handle.ambient()}

    @property
    def frfs(self) -> dict[str, dict[str, Any]]:
        """Frequency responses of each `[[frf]]`, measured and modelled.

        They are complex, pairs x lines, in the model's units. Each pair has its error
        and its unexplained part as fractions of the function, and the noise.
        """
        return {f["name"]: f for f in self._handle.frfs()}

    @property
    def history(self) -> dict[str, np.ndarray]:
        """Iterations, one row each: stage, iteration, cost, accepted, gradient_norm,
        largest_gap.
        """
        return {k: np.array(v) for k, v in self._handle.history().items()}

    @property
    def json(self) -> dict[str, Any]:
        """Content of result.json, "pinode-result-1"."""
        if self._json is None:
            self._json = json.loads(self._handle.json())
        return self._json

    def summary(self) -> str:
        """Returns the result on half a page: verdict, parameters with 95 % intervals,
        errors of the records. `report` is longer.
        """
        lines = summary_lines(self.parameters.values(), self.records.values())
        return "\n".join([self.sentence, "", *lines])

    def predict(self, record: "str | Record | None" = None) -> RecordResult:
        """Simulates the identified model.

        record: name of a record of the case, or a new Record, whose channels need no
            values. Default: the first record.

        A record of the case begins with its identified initial state. A new record
        begins with its own `start`, and has the gains and offsets that it gives. Its
        deviations are empty, because the noise of its sensors is unknown. Returns a
        RecordResult.
        """
        if isinstance(record, Mapping):
            return predicted(self, record)
        if record is not None and not isinstance(record, str):
            raise Error(f"record is {words_of(record)}, expected a name or a pinode.Record")
        return self.record(record)

    def plot(self, record: str | None = None) -> "Figure":
        """Returns the result as one figure: a record with the simulation of the model.

        record: name of the record. Default: the first hold-out record, else the
            first.

        Without records the figure shows the parameters. `figures` has all figures of
        the report.
        """
        from . import figures

        if record is not None and not isinstance(record, str):
            raise Error(f"record is {words_of(record)}, expected a name")
        if record is None:
            names = sorted(self.records, key=lambda n: self.records[n]["role"] != "holdout")
            record = names[0] if names else None
        drawn = None if record is None else figures.prediction(self, record, most=4)
        drawn = drawn or figures.parameters(self)
        if drawn is None:
            raise Error("the result has nothing to plot, expected a record or a free parameter")
        return drawn

    def report(self) -> str:
        """Returns the verdict and the tables, as the programs print them."""
        return self._handle.report()

    def structure(self) -> "StructureView | None":
        """View of the structure in 3-D, as in the report: changes in colour, sensors,
        forces and moving modes. A notebook shows it. None: the case has no
        `geometry`.
        """
        section = self._handle.structure()
        return StructureView(section) if section else None

    @takes(overwrite=FLAG, mat=FLAG)
    def save(
        self,
        folder: str | os.PathLike[str],
        *,
        overwrite: bool = False,
        mat: bool = False,
        deck: str | os.PathLike[str] = "",
    ) -> None:
        """Writes a result folder with the report, as the programs do.

        overwrite: True: an existing folder of results is replaced.
        mat: True: also writes results.mat, for MATLAB and Octave.
        deck: input deck of CalculiX or Abaqus from which the matrices come. The
            folder then has <name>_updated.inp with the identified properties.
        """
        try:
            self._handle.save(as_path("folder", folder), overwrite, mat, as_path("deck", deck))
        except Error as failure:
            if not str(failure).endswith("--deck needs it"):
                raise
            raise Error("deck is given, but the model does not come from a finite-element program, "
                        "expected a case with a FiniteElementModel") from None

    def to_pandas(self, what: str = "parameters") -> "DataFrame":
        """Returns a part of the result as a frame of pandas, see frames.frame.

        what: "parameters", "history", "stages", "modes", "mode_shapes", "forces",
            "loops", "profiles", "ambient"; "changes" of a damage analysis;
            "equations" or "pareto" of a discovery; or the name of a record.
        """
        from . import frames

        return frames.frame(self, what)

    def figures(self) -> "dict[str, Figure]":
        """Returns the figures of the report by name, drawn by matplotlib."""
        from . import figures

        return figures.all_figures(self)

    def __str__(self) -> str:
        return self.report()

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self._handle.brief()})"

    def _repr_html_(self) -> str:
        parameters = [p._asdict() for p in self.parameters.values()]
        return _html.section(self._handle.sentence, tables(parameters, self.records.values()),
                             verdict=self._handle.verdict)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (type(self), *self._handle.state())


def _restore(kind: type, tree: dict[str, Any], path: str, packed: bytes) -> Outcome:
    return kind(_pinode.FitHandle.from_state(tree, path, packed))
