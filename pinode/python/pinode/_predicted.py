"""Records with the predictions of a model."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from . import _pinode
from ._arguments import LIST
from ._pinode import Error
from ._words import in_python
from .case import Case
from .measurements import Record


class RecordResult(NamedTuple):
    """A record with the simulation of the model.

    time: times, in the unit of the record's file.
    measured, predicted: values by channel, in `units`.
    deviation: standard deviations of measured values from the predicted ones, by
        channel. Empty: unknown.
    units: units of the channels, those of the record's file.
    states: [x; v; z] of the model, states x samples, in the model's units.
    start: the first column of `states`.
    """

    time: np.ndarray
    measured: dict[str, np.ndarray]
    predicted: dict[str, np.ndarray]
    deviation: dict[str, np.ndarray]
    units: dict[str, str]
    states: np.ndarray
    start: np.ndarray


def predicted(outcome: Any, record: Mapping[str, Any]) -> RecordResult:
    """Predicts a record with the model of a fit. The record need not belong to the
    case.
    """
    if not isinstance(record, Record):
        raise Error(f"record is a value of type {type(record).__name__}, expected a name or a "
                    "pinode.Record")
    listed = record.get("channel")
    if not LIST.fits(listed) or not listed:
        raise Error(f"record '{record['name']}': channels is missing, expected the sensors to "
                    "predict, such as pinode.Channel('a1', dof='u1')")
    with tempfile.TemporaryDirectory(prefix="pinode_") as folder:
        outcome._handle.save_model(folder)
        path = str(Path(folder) / "model.toml")
        try:
            case = Case.from_dict(_for_simulation(_pinode.toml_tree(path), record), path=path)
            found = case.simulate(noise_percent=0.0)[record["name"]]
        except Error as failure:  # without the file that is gone when the user reads it
            raise Error(in_python(str(failure).replace(f"{path}: ", ""))) from None
    if not found["finite"]:
        raise Error(f"record '{record['name']}': the motion of the model does not stay finite "
                    f"{found['remark']}")
    return RecordResult(
        time=found["time"],
        measured=_measured(record),
        predicted=found["channels"],
        deviation={name: np.zeros(0) for name in found["channels"]},
        units={channel["name"]: channel.get("unit", "model") for channel in listed},
        states=found["states"],
        start=found["states"][:, 0],
    )


def _for_simulation(tree: dict[str, Any], record: Record) -> dict[str, Any]:
    """Returns a case of the model and this record alone, without measured values."""
    kept = ("title", "units", "model", "group", "element", "library", "network", "options")
    channels = [{key: value for key, value in channel.items() if key not in ("column", "file")}
                for channel in record["channel"]]
    return {**{key: tree[key] for key in kept if key in tree},
            "record": [{**record, "channel": channels}]}


def _measured(record: Record) -> dict[str, np.ndarray]:
    """Returns the values in memory of the channels that have some."""
    table = record.get("file")
    if not isinstance(table, Mapping):
        return {}
    return {channel["name"]: np.asarray(table[channel["column"]], dtype=float)
            for channel in record["channel"] if channel.get("column") in table}
