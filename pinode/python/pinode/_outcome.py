"""The common part of all results of a fit."""

from __future__ import annotations

import functools
import json
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _html, _pinode
from ._arguments import FLAG, takes, words_of
from ._part import as_path
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
    """A named parameter: in the model's units, with its 95 % interval.

    sigma is infinite, and the interval without ends, where the data do not say;
    both are NaN or infinite of fixed ones. Where the model lacks something (verdict
    "with_care"), the interval reaches as far as other explanations do, and
    half_width95 is that of the interval that presumes that it lacks nothing.
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


class Outcome:
    """The common part of fits, verdicts and equations: a fit."""

    def __init__(self, handle: Any) -> None:
        self._handle = handle
        self._json: dict[str, Any] | None = None

    @property
    def usable(self) -> bool:
        """Whether the result may be used; `message` says why not."""
        return self._handle.usable

    @property
    def verdict(self) -> str:
        """Verdict on the fit: "good", "with_care" or "not_usable"."""
        return self._handle.verdict

    @property
    def sentence(self) -> str:
        """The verdict in words, with its reason."""
        return self._handle.sentence

    @property
    def findings(self) -> list[dict[str, Any]]:
        """Failed checks, each with `check`, `what`, `grade`, `number`, `limit` and
        `advice`; the verdict follows from them. Empty: the result is good."""
        return self._handle.findings

    @property
    def explanations(self) -> list[dict[str, Any]]:
        """What the model may lack, best first: unknowns that it does not have, with
        which it was fitted again. Each has `what`, `kind`, `place`, `log_odds`
        (natural logarithm, against the model as it is), `probability` among all that
        were tried, `values` of the named parameters under it, `value` with `lower95` and
        `upper95`, `removes` (a share of the squared error), `leaves` (unexplained motion
        under it, a fraction), and the named parameter that it moves most, `moved`, by
        `shift` half-widths of its interval."""
        return self._handle.explanations

    @property
    def message(self) -> str:
        """What came of the fit, in a sentence."""
        return self._handle.message

    @property
    def termination(self) -> str:
        """"converged", "no_convergence", "interrupted" or "failure"."""
        return self._handle.termination

    @property
    def remarks(self) -> list[str]:
        """What one should know of data and outcome, a sentence each."""
        return self._handle.remarks + self._handle.troubles

    @property
    def seconds(self) -> float:
        """How long it took, on the clock."""
        return self._handle.seconds

    @property
    def case(self) -> Case:
        """The case as it was fitted: without terms that were left out."""
        return Case._of(self._handle.case())

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Named parameters as they were found."""
        return {p["name"]: Parameter(**p) for p in self._handle.parameters()}

    def __getitem__(self, name: str) -> float:
        """The value of a named parameter."""
        try:
            return self.parameters[name].value
        except KeyError:
            raise KeyError(
                f"there is no parameter '{name}'; there are "
                + ", ".join(self.parameters)
            ) from None

    @property
    def covariance(self) -> np.ndarray:
        """Of the free named parameters, in the order of covariance_names."""
        return self._handle.covariance

    @property
    def covariance_names(self) -> list[str]:
        """Of the rows and columns of `covariance`."""
        return self._handle.covariance_names

    def record(self, name: str | None = None) -> RecordResult:
        """A record of the case, the first unless it is named."""
        if name is None:
            records = self.json["records"]
            if not records:
                raise Error("the result has no record")
            name = records[0]["name"]
        return RecordResult(**self._handle.record(name))

    @property
    def records(self) -> dict[str, dict[str, Any]]:
        """Scores of the free runs by record: role, nrmse, prior_nrmse,
        channels."""
        return {r["name"]: r for r in self.json["records"]}

    @functools.cached_property
    def _before(self) -> dict[str, dict[str, np.ndarray]]:
        return self._handle.before()

    def before(self, record: str | None = None) -> dict[str, np.ndarray]:
        """By channel the free run of the model before the fit, with which
        prior_nrmse compares, in the units of the record's file. Of a record whose
        start is free it begins where that model's run fits best. Empty where it
        does not stay finite."""
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
        """The model's modes before and after: initial_hz, updated_hz,
        initial_damping, updated_damping, mac."""
        return self.json["modes"]

    @property
    def mass(self) -> np.ndarray:
        """M with the groups as they were found, n x n."""
        return self._handle.matrices()["mass"]

    @property
    def damping(self) -> np.ndarray:
        """C likewise."""
        return self._handle.matrices()["damping"]

    @property
    def stiffness(self) -> np.ndarray:
        """K likewise."""
        return self._handle.matrices()["stiffness"]

    @property
    def forces(self) -> dict[str, dict[str, Any]]:
        """Unknown forces by name: record, unit (of the force), time, force, lower95,
        upper95; and `truth`, its time and force, where the case gives one."""
        return {f["name"]: f for f in self._handle.forces()}

    @property
    def profiles(self) -> dict[str, dict[str, Any]]:
        """Profiles of the likelihood by parameter, where they were asked for."""
        return {p["name"]: p for p in self._handle.profiles()}

    @property
    def loops(self) -> list[dict[str, Any]]:
        """What elements, libraries and networks did along the predicted states:
        term, deformation, rate, force, time, with their units; and `known`, name,
        deformation and force of a reference curve of the term."""
        return self._handle.loops()

    @property
    def ambient(self) -> dict[str, dict[str, Any]]:
        """Of ambient records the spectral densities, measured and modelled
        (channels x frequencies, unit of the channel squared per Hz; without the
        response to measured loads), means of so many `lines`, and what part of
        each channel is explained, by measured loads too where there are some."""
        return {a["name"]: a for a in self._handle.ambient()}

    @property
    def history(self) -> dict[str, np.ndarray]:
        """A row an iteration: stage, iteration, cost, accepted, gradient_norm,
        largest_gap."""
        return {k: np.array(v) for k, v in self._handle.history().items()}

    @property
    def json(self) -> dict[str, Any]:
        """The content of result.json, "pinode-result-1"."""
        if self._json is None:
            self._json = json.loads(self._handle.json())
        return self._json

    def summary(self) -> str:
        """The result on half a page: the verdict in words, parameters with their
        95 % intervals, errors of the records. `report` says more."""
        lines = summary_lines(self.parameters.values(), self.records.values())
        return "\n".join([self.sentence, "", *lines])

    def predict(self, record: "str | Record | None" = None) -> RecordResult:
        """The motion of the model as it was found: in a record of the case, the first
        unless it is named, or in another Record, whose channels need no values.

        A record of the case is predicted from the start that was found. Another one
        is simulated from its own `start`, with the gains and offsets that it gives;
        its deviations are empty, since nothing says how noisy its sensors are.
        """
        if isinstance(record, Mapping):
            return predicted(self, record)
        if record is not None and not isinstance(record, str):
            raise Error(f"record is {words_of(record)}, expected a name or a pinode.Record")
        return self.record(record)

    def plot(self, record: str | None = None) -> "Figure":
        """The result in one figure: a record beside the model's free run, the first
        hold-out unless it is named; where there is no record, the parameters.
        `figures` has all that the report draws."""
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
        """Verdict and tables, as the programs print them."""
        return self._handle.report()

    def structure(self) -> "StructureView | None":
        """The structure in 3-D, as in the report: what changed in colour, sensors
        and forces where they are, modes moving. A notebook shows it. None: the
        case has no `geometry`."""
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
        """Writes a result folder as the programs do, with the report.

        mat: with results.mat, for MATLAB and Octave.
        deck: the input deck of CalculiX or Abaqus that the matrices came from;
            the folder has it as <name>_updated.inp, with what was found.
        """
        self._handle.save(as_path("folder", folder), overwrite, mat, as_path("deck", deck))

    def to_pandas(self, what: str = "parameters") -> "DataFrame":
        """A frame of pandas: "parameters", "history", "stages", "modes",
        "mode_shapes", "forces", "loops", "profiles", "ambient"; of a verdict
        "changes", of a discovery "equations" and "pareto"; or a record. See
        frames.frame."""
        from . import frames

        return frames.frame(self, what)

    def figures(self) -> "dict[str, Figure]":
        """The figures of the report, drawn by matplotlib."""
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
