"""Tables of results for notebooks, in memory and on disk."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from . import _html

_SCORES = ["record", "role", "error (%)", "initial (%)"]
CHANGE_HEADER = ["group", "change", "from", "to (95 %)", "P(loss > threshold)"]


def change_row(group: Mapping[str, Any]) -> list[Any]:
    return [group[key] for key in ("name", "change", "lower95", "upper95", "probability")]


def summary_lines(parameters: Iterable[Any], records: Iterable[Any]) -> list[str]:
    """Returns parameters and errors of records as lines for a terminal."""
    found = _html.plain_table(
        ["parameter", "initial", "value", "from", "to (95 %)", "unit"],
        [[p.name, p.initial, p.value, p.lower95, p.upper95, p.unit] for p in parameters],
    )
    scores = _html.plain_table(
        _SCORES, [_score(r) for r in records],
    )
    return [*found, *([""] if found and scores else []), *scores]


def _score(record: Mapping[str, Any]) -> list[Any]:
    return [record["name"], record["role"], _percent(record["nrmse"]),
            _percent(record["prior_nrmse"])]


def _percent(share: Any) -> Any:
    return None if share is None else f"{100.0 * share:.3g}"


def tables(parameters: Iterable[Any], records: Iterable[Any]) -> str:
    """Returns parameters and errors of records as tables for notebooks."""
    keys = ("name", "initial", "value", "lower95", "upper95", "unit")
    return _html.table(
        ["parameter", "initial", "value", "from", "to (95 %)", "unit"],
        [[p[key] for key in keys] for p in parameters],
    ) + _html.table(
        _SCORES, [_score(r) for r in records],
    )
