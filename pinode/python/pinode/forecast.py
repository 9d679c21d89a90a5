"""Results of a case without a fit: checks, simulations, and plans of sensors."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _html, _pinode
from ._arguments import FLAG, takes
from ._part import as_path, counted

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from .case import Case


class Check(dict):
    """Prediction of an identification; a dictionary that a notebook shows as tables.
    See Case.check.
    """

    def to_pandas(self, what: str = "expected") -> "DataFrame":
        """Returns a frame of pandas: "expected" (one row per free parameter) or "steps"
        (one row per record).
        """
        from . import frames

        return frames.of_check(self, what)

    @property
    def _title(self) -> str:
        if "not_assessed" in self:
            return f"Not assessed: {self['not_assessed']}"
        if "num_free" in self:
            return (f"{counted(self['num_free'], 'free parameter')}, "
                    f"{counted(self['num_residuals'], 'residual')}")
        return "Nothing was measured"

    def __repr__(self) -> str:
        expected = ", ".join(f"{e['name']} +- {_html.text(e['sigma'])}"
                             for e in self.get("expected", [])[:4])
        count = len(self.get("undetermined", []))
        parts = [self._title, expected, f"{count} undetermined" if count else ""]
        return f"Check({'; '.join(part for part in parts if part)})"

    def __str__(self) -> str:
        lines = [self._title]
        for title, key in (("Cannot be determined:", "undetermined"), ("Remarks:", "remarks"),
                           ("", "assessment_remarks")):
            found = [f"- {sentence}" for sentence in self.get(key, [])]
            lines += [*([title] if found and title else []), *found]
        expected = _html.plain_table(
            ["parameter", "initial", "expected deviation", "unit"],
            [[e["name"], e["initial"], e["sigma"], e["unit"]] for e in self.get("expected", [])])
        steps = _html.plain_table(
            ["record", "integrator", "steps a sample"],
            [[s["record"], s["integrator"], s["substeps"]] for s in self.get("steps", [])])
        return "\n".join([*lines, *([""] if expected else []), *expected,
                          *([""] if steps else []), *steps])

    def _repr_html_(self) -> str:
        title = self._title
        expected = [
            [e["name"], e["initial"], e["sigma"], e["unit"]] for e in self.get("expected", [])
        ]
        steps = [[s["record"], s["integrator"], s["substeps"]] for s in self.get("steps", [])]
        return _html.section(
            title,
            _html.sentences("Cannot be determined:", self.get("undetermined", [])),
            _html.table(["parameter", "initial", "expected deviation", "unit"], expected),
            _html.table(["record", "integrator", "steps a sample"], steps),
            _html.sentences(
                "Remarks:", [*self.get("remarks", []), *self.get("assessment_remarks", [])]
            ),
        )


class Simulation(Mapping):
    """Simulated responses by record.

    Each has `time` (s), `channels` by name (in the units of the record's file),
    `states` (states x samples, in the model's units), `finite` and `remark`.
    """

    def __init__(
        self, records: dict[str, dict[str, Any]], case: "Case", noise: dict[str, Any]
    ) -> None:
        self._records = records
        self._case = case
        self._noise = noise

    @takes(overwrite=FLAG, mat=FLAG)
    def save(
        self, folder: str | os.PathLike[str], *, overwrite: bool = False, mat: bool = False
    ) -> None:
        """Writes a folder with response_<record>.csv, as `pinode_simulate` does.

        overwrite: True: an existing folder of results is replaced.
        mat: True: also writes results.mat, for MATLAB and Octave.
        """
        _pinode.save_simulation(
            self._case._handle,
            self._records,
            **self._noise,
            path=as_path("folder", folder),
            overwrite=overwrite,
            mat=mat,
        )

    def to_pandas(self, record: str | None = None) -> "DataFrame":
        """Returns the channels of a record as a frame of pandas, indexed by time.
        Default: the first record.
        """
        from . import frames

        return frames.of_simulation(self, record)

    def figures(self) -> "dict[str, Figure]":
        """Returns figures of matplotlib by name: response_<record> with the channels of
        each record.
        """
        from . import figures

        drawn = {f"response_{name}": figures.simulated(self, name) for name in self}
        return {name: figure for name, figure in drawn.items() if figure is not None}

    def __getitem__(self, record: str) -> dict[str, Any]:
        return self._records[record]

    def __iter__(self) -> Iterator[str]:
        return iter(self._records)

    def __len__(self) -> int:
        return len(self._records)

    def __repr__(self) -> str:
        text = ", ".join(
            f"{name}: {len(r['time'])} samples of {', '.join(r['channels'])}" + ("" if r["finite"] else ", not finite")
            for name, r in self.items()
        )
        return f"Simulation({text})"

    def _repr_html_(self) -> str:
        records = [
            [name, len(r["time"]), ", ".join(r["channels"]),
             " ".join(filter(None, ["" if r["finite"] else "not finite", r["remark"]]))]
            for name, r in self.items()
        ]
        channels = [
            [name, channel, float(np.sqrt(np.mean(np.square(values)))),
             float(np.abs(values).max())]
            for name, r in self.items() for channel, values in r["channels"].items()
        ]
        return _html.section(
            f"Simulation of {counted(len(self), 'record')}",
            _html.table(["record", "samples", "channels", ""], records),
            _html.table(["record", "channel", "rms", "largest"], channels),
        )


class SensorPlan(Sequence):
    """Planned sensors, the most informative first.

    Each is a dictionary: name, quantity, sigma and unit of its noise, and rms of its
    values. `typical` and `worst` are the expected deviations of the targets with this
    and all previous sensors; `worst_of` names the target with the worst one.

    targets: names of the parameters that the sensors were chosen for.
    one_more: result with one more sensor. None: there is no other candidate.
    own: `typical` and `worst` with the case's own sensors, or None.
    deviations: {parameter: {"unit", "initial", "own", "planned", "all"}}: expected
        standard deviations with the case's own sensors, the planned ones, and sensors
        at all places. inf: not determined.
    undetermined, undetermined_by_own: combinations of parameters that the planned and
        the own sensors do not determine, as sentences.
    durations: `typical` and `worst` with shorter records, if the table `plan` lists
        durations.
    by_force_at: {DOF: the plan with the force at this DOF}, if the table `plan` has
        `excite`.
    """

    def __init__(
        self, plan: dict[str, Any], by_force_at: "dict[str, SensorPlan] | None" = None
    ) -> None:
        self.by_force_at = by_force_at or {}
        self._sensors: list[dict[str, Any]] = plan["sensors"]
        self._text: str = plan["text"]
        self.targets: list[str] = plan["targets"]
        self.one_more: dict[str, Any] | None = plan["one_more"]
        self.own: dict[str, Any] | None = plan["own"]
        self.deviations: dict[str, dict[str, Any]] = plan["deviations"]
        self.undetermined: list[str] = plan["undetermined"]
        self.undetermined_by_own: list[str] = plan["undetermined_by_own"]
        self.durations: list[dict[str, Any]] = plan["durations"]

    @property
    def names(self) -> list[str]:
        """Names of the sensors, the most informative first."""
        return [s["name"] for s in self._sensors]

    def to_pandas(self, what: str = "sensors") -> "DataFrame":
        """Returns a frame of pandas: "sensors", "deviations" or "durations"."""
        from . import frames

        return frames.of_plan(self, what)

    def figures(self) -> "dict[str, Figure]":
        """Returns figures of matplotlib by name: "plan" shows the gain by each
        sensor.
        """
        from . import figures

        drawn = {"plan": figures.planned(self)}
        return {name: figure for name, figure in drawn.items() if figure is not None}

    def __getitem__(self, index: Any) -> Any:
        return self._sensors[index]

    def __len__(self) -> int:
        return len(self._sensors)

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"SensorPlan({', '.join(self.names)})"

    def _repr_html_(self) -> str:
        rows = [[s["name"], s["quantity"], f"{s['sigma']:.3g} {s['unit']}", s["typical"],
                 s["worst"], s["worst_of"]] for s in self._sensors]
        header = ["sensor", "quantity", "noise", "typical deviation", "worst", "of"]
        return _html.section(f"{counted(len(self), 'sensor')} for {', '.join(self.targets)}",
                             _html.table(header, rows))
