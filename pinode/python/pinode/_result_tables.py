"""Tables of results for notebooks, in memory and on disk."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from . import _html

_SCORES = ["record", "role", "error (%)", "initial (%)"]
CHANGE_HEADER = ["group", "change (%)", "from", "to (95 %)", "P(loss > threshold) (%)"]


def change_row(group: Mapping[str, Any]) -> list[Any]:
    changes = [_percent(group[key]) for key in ("change", "lower95", "upper95")]
    return [group["name"], *changes, _probability(group["probability"])]


def _probability(share: Any) -> Any:
    """Returns a probability in per cent. Beyond 1 in 10 000 only the side is known."""
    if share is None or not math.isfinite(share):
        return None
    return "< 0.01" if share < 1e-4 else "> 99.99" if share > 0.9999 else _percent(share)


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
    return None if share is None or not math.isfinite(share) else f"{100.0 * share:.3g}"


def tables(parameters: Iterable[Any], records: Iterable[Any]) -> str:
    """Returns parameters and errors of records as tables for notebooks."""
    keys = ("name", "initial", "value", "lower95", "upper95", "unit")
    return _html.table(
        ["parameter", "initial", "value", "from", "to (95 %)", "unit"],
        [[p[key] for key in keys] for p in parameters],
    ) + _html.table(
        _SCORES, [_score(r) for r in records],
    )
