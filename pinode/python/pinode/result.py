"""What came out of a case."""

from __future__ import annotations

import functools
import json
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _html, _pinode
from ._part import as_folder, as_mapping, as_path, as_sequence, as_watcher
from ._pinode import Error
from ._result_tables import CHANGE_HEADER, change_row, tables
from .case import Case, Progress
from .progress import watched
from .result_folder import ResultFolder
from .structure_view import StructureView

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame


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


class RecordResult(NamedTuple):
    """A record beside what the model predicts for it, in a free run.

    time (s, or the unit of the record's file), and by channel the measured
    values, the predicted ones and the standard deviation of what the sensor
    reads about these (empty where it is not known), in `units`, those of the
    record's file. states: [x; v; z] of the model in its units, states x
    samples; start: the first of them.
    """

    time: np.ndarray
    measured: dict[str, np.ndarray]
    predicted: dict[str, np.ndarray]
    deviation: dict[str, np.ndarray]
    units: dict[str, str]
    states: np.ndarray
    start: np.ndarray


class _Outcome:
    """What fits, verdicts and equations have in common: a fit."""

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

    def report(self) -> str:
        """Verdict and tables, as the programs print them."""
        return self._handle.report()

    def structure(self) -> "StructureView | None":
        """The structure in 3-D, as in the report: what changed in colour, sensors
        and forces where they are, modes moving. A notebook shows it. None: the
        case has no `geometry`."""
        section = self._handle.structure()
        return StructureView(section) if section else None

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
        return _html.section(self._handle.sentence, tables(parameters, self.records.values()))

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (type(self), *self._handle.state())


class Fit(_Outcome):
    """An identified model."""

    def discover(
        self,
        *,
        options: Mapping[str, Any] | None = None,
        threads: int = 0,
        progress: bool | None = None,
        callback: Progress | None = None,
        output: str | os.PathLike[str] = "",
        overwrite: bool = False,
        resume: bool = False,
        mat: bool = False,
    ) -> "Discovery":
        """Closed-form equations in place of the networks of the model.

        options: as [discover] of a case file; those of the case unless given.
        output: a result folder, written as `pinode_discover` does, with a
            checkpoint on the way from which `resume` goes on.
        """
        case = self.case if options is None else self.case.replace(discover=as_mapping("options", options))
        with watched(*as_watcher(progress, callback)) as call:
            return Discovery(
                _pinode.discover(
                    case._handle,
                    self._handle,
                    threads=threads,
                    callback=call,
                    output=as_folder(output, mat),
                    overwrite=overwrite,
                    resume=resume,
                    mat=mat,
                )
            )

    def damage(
        self,
        baselines: "Sequence[Fit | ResultFolder | str | os.PathLike[str]]",
        *,
        threshold: float = 0.05,
        false_alarm_rate: float = 0.05,
        threads: int = 0,
        progress: bool | None = None,
        callback: Progress | None = None,
    ) -> "Damage":
        """What has changed since healthy records; see Case.damage, which begins
        the fit from the first of these, and holds what these alone tell of how
        the structure follows a covariate."""
        with watched(*as_watcher(progress, callback)) as call:
            return Damage(
                _pinode.damage(
                    self.case._handle,
                    self._handle,
                    _baselines(baselines),
                    threshold=threshold,
                    false_alarm_rate=false_alarm_rate,
                    threads=threads,
                    callback=call,
                )
            )


class Damage(_Outcome):
    """A fit of new records beside healthy ones, and what has changed."""

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        self._found: dict[str, Any] | None = json.loads(_pinode.damage_json(handle))

    @property
    def verdict(self) -> str:
        """Verdict on the change: "no_damage", "damage", "nonlinear", "other_change"
        or "cannot_tell"."""
        return "cannot_tell" if self._found is None else self._found["verdict"]

    @property
    def fit_verdict(self) -> str:
        """Verdict on the fit: "good", "with_care" or "not_usable"."""
        return self._handle.verdict

    @property
    def fit_sentence(self) -> str:
        """The verdict on the fit in words."""
        return self._handle.sentence

    @property
    def sentence(self) -> str:
        """The verdict on the change in words."""
        if self._found is None:
            # The first trouble says just this.
            why = "; ".join(self._handle.troubles) or (
                "nothing can be said about changes: " + self.message
            )
            return why[0].upper() + why[1:]
        return self._found["message"]

    @property
    def groups(self) -> dict[str, dict[str, Any]]:
        """By group its change (-0.1: a tenth lost), lower95, upper95, the
        probability of a loss beyond the threshold, damaged, reason."""
        return {} if self._found is None else {g["name"]: g for g in self._found["groups"]}

    @property
    def changes(self) -> list[dict[str, Any]]:
        """What a verdict looks at: name, target ("stiffness", "damping", "mass",
        "nonlinear"), change, lower95, upper95 and probability of each group, and
        then of the masses, dampings and nonlinear forces found beside them."""
        if self._found is None:
            return []
        keys = ("name", "target", "change", "lower95", "upper95", "probability", "reason")
        found = [
            *self._found["groups"],
            *({**m, "name": f"mass at {m['place']}", "target": "mass"}
              for m in self._found["masses"]),
            *({**d, "name": f"damping of {d['place']}", "target": "damping"}
              for d in self._found.get("dampings", [])),
            *({**n, "change": n["share"], "target": "nonlinear"}
              for n in self._found["nonlinearity"].get("terms", [])),
        ]
        return [{key: row.get(key) for key in keys} for row in found]

    @property
    def damage_json(self) -> dict[str, Any] | None:
        """The content of damage.json; None where nothing could be said."""
        return self._found

    @property
    def remarks(self) -> list[str]:
        """Sentences on the fit, and on what was compared."""
        compared = [] if self._found is None else self._found.get("remarks", [])
        of_fit = super().remarks
        return of_fit + [remark for remark in compared if remark not in of_fit]

    def __repr__(self) -> str:
        return f"Damage({self.sentence})"

    def __str__(self) -> str:
        compared = [] if self._found is None else self._found.get("remarks", [])
        return "\n\n".join([self.sentence, *compared, self.report()])

    def _repr_html_(self) -> str:
        rows = [change_row(g) for g in self.groups.values()]
        table = _html.table(CHANGE_HEADER, rows)
        return _html.section(self.sentence, table) + super()._repr_html_()


class Discovery(_Outcome):
    """A model with equations in place of its networks."""

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        self._found: dict[str, Any] = json.loads(_pinode.discovery_json(handle))
        self._text: str = _pinode.equations_text(handle)

    @property
    def samples(self) -> list[dict[str, Any]]:
        """Of each equation and feature that its terms look at, along the training
        records: output, unit, feature, feature_unit, `at` (the feature), `terms`
        in it, `regressed` (what they stand for, less the other terms)."""
        return _pinode.equation_samples(self._handle)

    @property
    def equations(self) -> list[dict[str, Any]]:
        """By output the terms with basis, coefficient, lower95, upper95, unit."""
        return self._found["equations"]

    @property
    def discovery_json(self) -> dict[str, Any]:
        """The content of discover.json."""
        return self._found

    @property
    def terms(self) -> dict[str, dict[str, float]]:
        """Coefficients by output and basis."""
        return {
            e["output"]: {t["basis"]: t["coefficient"] for t in e["terms"]}
            for e in self.equations
        }

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"Discovery({' '.join(self._text.split())})"

    def _repr_html_(self) -> str:
        rows = [
            [e["output"], t["basis"], t["coefficient"], t["lower95"], t["upper95"], t["unit"]]
            for e in self.equations
            for t in e["terms"]
        ]
        header = ["output", "term", "coefficient", "from", "to (95 %)", "unit"]
        return _html.section(self.message, _html.table(header, rows))


def _restore(kind: type, tree: dict[str, Any], path: str, packed: bytes) -> _Outcome:
    return kind(_pinode.FitHandle.from_state(tree, path, packed))


def _model(case: Case, given: Any, output: str) -> Any:
    """The handle of a model to discover equations from: of a fit, or of what a
    folder holds of one for this case. None: there is none."""
    if given is None:
        return None
    if isinstance(given, _Outcome):
        return given._handle
    if isinstance(given, ResultFolder):
        given = given.path
    folder = as_path("model", given)
    if output and os.path.realpath(output) == os.path.realpath(folder):
        raise Error("output is the folder of the model, expected another one")
    return _pinode.fit_of_folder(case._handle, folder)


def _baselines(given: Any) -> list[Any]:
    """Handles of fits, and paths."""
    if isinstance(given, (str, os.PathLike, _Outcome, ResultFolder)):
        given = [given]
    result: list[Any] = []
    for entry in as_sequence("baselines", given):
        if isinstance(entry, _Outcome):
            result.append(entry._handle)
        elif isinstance(entry, ResultFolder):
            result.append(str(entry.path))
        elif isinstance(entry, (str, os.PathLike)):
            result.append(as_path("a baseline", entry))
        else:
            raise Error(
                f"a baseline is a value of type {type(entry).__name__}, expected "
                "a Fit or a result folder"
            )
    return result
