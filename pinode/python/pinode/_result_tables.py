"""What notebooks show of results, in memory and on disk."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from . import _html

CHANGE_HEADER = ["group", "change", "from", "to (95 %)", "P(loss > threshold)"]


def change_row(group: Mapping[str, Any]) -> list[Any]:
    return [group[key] for key in ("name", "change", "lower95", "upper95", "probability")]


def tables(parameters: Iterable[Any], records: Iterable[Any]) -> str:
    """Parameters and scores of records as notebooks show them."""
    keys = ("name", "initial", "value", "lower95", "upper95", "unit")
    scores = ("name", "role", "nrmse", "prior_nrmse")
    return _html.table(
        ["parameter", "before", "value", "from", "to (95 %)", "unit"],
        [[p[key] for key in keys] for p in parameters],
    ) + _html.table(
        ["record", "role", "error", "error before"],
        [[r[key] for key in scores] for r in records],
    )
