"""Results of a case: fits, damage analyses and discoveries."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from . import _html, _pinode
from ._arguments import COUNT, FLAG, NUMBER, takes
from ._outcome import Outcome, Parameter
from ._part import as_folder, as_mapping, as_path, as_sequence, as_watcher
from ._pinode import Error
from ._predicted import RecordResult
from ._result_tables import CHANGE_HEADER, change_row, summary_lines
from .case import Case, Progress
from .progress import watched
from .result_folder import ResultFolder

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Fit(Outcome):
    """Result of Case.identify: an identified model.

    fit["k1"] is the value of a parameter, and fit.parameters["k1"] also has its interval.
    Look at fit.verdict and fit.sentence first.
    """

    @takes(threads=COUNT, overwrite=FLAG, resume=FLAG)
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
        """Finds closed-form equations that replace the networks of the model.

        options: with the keys of [discover] in a case file. Default: those of the
            case.

        The other arguments are those of Case.discover. Returns a Discovery.
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

    @takes(threshold=NUMBER, false_alarm_rate=NUMBER, threads=COUNT)
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
        """Finds the changes relative to baselines, see Case.damage.

        Case.damage also begins its fit from the first baseline. It also fixes the
        parameters by which the structure follows covariates if only the baselines
        determine them.
        """
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


class Damage(Outcome):
    """A fit of new records, with the changes relative to baselines."""

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        self._found: dict[str, Any] | None = json.loads(_pinode.damage_json(handle))

    @property
    def verdict(self) -> str:
        """Verdict on the change: "no_damage", "damage", "nonlinear", "other_change" or
        "cannot_tell".
        """
        return "cannot_tell" if self._found is None else self._found["verdict"]

    @property
    def fit_verdict(self) -> str:
        """Grade of the fit: "good", "with_care" or "not_usable"."""
        return self._handle.verdict

    @property
    def fit_sentence(self) -> str:
        """Grade of the fit in words."""
        return self._handle.sentence

    @property
    def sentence(self) -> str:
        """Verdict on the change in words."""
        if self._found is None:
            # The first trouble says just this.
            why = "; ".join(self._handle.troubles) or (
                "nothing can be said about changes: " + self.message
            )
            return why[0].upper() + why[1:]
        return self._found["message"]

    def plot(self, record: str | None = None) -> "Figure":
        """Returns a figure with the changes of the groups, or of a record if it is
        named.
        """
        from . import figures

        drawn = None if record is not None else figures.changes(self)
        return super().plot(record) if drawn is None else drawn

    def summary(self) -> str:
        """Returns the verdict in words, the changes with their 95 % intervals, and the
        summary of the fit.
        """
        changes = _html.plain_table(CHANGE_HEADER, [change_row(g) for g in self.groups.values()])
        lines = summary_lines(self.parameters.values(), self.records.values())
        blank = [""] if changes else []
        return "\n".join([self.sentence, "", *changes, *blank, self.fit_sentence, "", *lines])

    @property
    def groups(self) -> dict[str, dict[str, Any]]:
        """Changes of the groups, by name.

        Each has its change as a fraction (-0.1: a loss of 10 %), lower95, upper95,
        the probability of a loss above the threshold, damaged, and reason.
        """
        return {} if self._found is None else {g["name"]: g for g in self._found["groups"]}

    @property
    def changes(self) -> list[dict[str, Any]]:
        """Changes on which the verdict is based: those of groups, then those of masses,
        dampings and nonlinear forces that were found.

        Each has name, target ("stiffness", "damping", "mass", "nonlinear"), change,
        lower95, upper95 and probability.
        """
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
        """Content of damage.json. None if there is no result."""
        return self._found

    @property
    def remarks(self) -> list[str]:
        """Remarks on the fit and on the comparison, one sentence each."""
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
        return (_html.section(self.sentence, table, verdict=self.verdict)
                + super()._repr_html_())


class Discovery(Outcome):
    """A model with equations in place of its networks."""

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        self._found: dict[str, Any] = json.loads(_pinode.discovery_json(handle))
        self._text: str = _pinode.equations_text(handle)

    @property
    def samples(self) -> list[dict[str, Any]]:
        """Regressed values along the training records, one entry per equation and
        feature.

        Each has output, unit, feature, feature_unit, `at` (values of the feature),
        `terms` (values of the terms in this feature) and `regressed` (the regressed
        values minus the other terms).
        """
        return _pinode.equation_samples(self._handle)

    @property
    def equations(self) -> list[dict[str, Any]]:
        """Terms of the equations by output: basis, coefficient, lower95, upper95,
        unit, probability.
        """
        return self._found["equations"]

    @property
    def rivals(self) -> list[dict[str, Any]]:
        """Other sets of terms that describe the records about as well, most likely
        first: `without` and `with` (terms that leave and enter), `log_odds` relative
        to the chosen terms, and `fitted`.
        """
        return self._found["rivals"]

    @property
    def discovery_json(self) -> dict[str, Any]:
        """Content of discover.json."""
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


def _model(case: Case, given: Any, output: str) -> Any:
    """Returns the handle of the model to discover equations from: from a fit, or from
    the result folder of a fit of this case. None: there is none.
    """
    if given is None:
        return None
    if isinstance(given, Outcome):
        return given._handle
    if isinstance(given, ResultFolder):
        given = given.path
    folder = as_path("model", given)
    if output and os.path.realpath(output) == os.path.realpath(folder):
        raise Error("output is the folder of the model, expected another folder")
    return _pinode.fit_of_folder(case._handle, folder)


def _baselines(given: Any) -> list[Any]:
    """Returns handles of fits, and paths."""
    if isinstance(given, (str, os.PathLike, Outcome, ResultFolder)):
        given = [given]
    result: list[Any] = []
    for entry in as_sequence("baselines", given):
        if isinstance(entry, Outcome):
            result.append(entry._handle)
        elif isinstance(entry, ResultFolder):
            result.append(str(entry.path))
        elif isinstance(entry, (str, os.PathLike)):
            result.append(as_path("baselines: a baseline", entry))
        else:
            raise Error(
                f"baselines: a baseline is a value of type {type(entry).__name__}, expected "
                "a Fit or a result folder"
            )
    return result


__all__ = ["Damage", "Discovery", "Fit", "Parameter", "RecordResult"]
