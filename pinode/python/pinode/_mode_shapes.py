"""Mode shapes of the initial and the updated model."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

# Units of time a second.
SECONDS = {"s": 1.0, "ms": 1e3, "us": 1e6}


class ShapePair(NamedTuple):
    """A mode of the initial and the updated model: number from 1, frequencies (Hz), and
    shapes over the DOFs.

    The largest entry of each shape is 1. The sign of the first agrees with that of
    the other.
    """

    number: int
    initial_hz: float
    updated_hz: float
    initial: np.ndarray
    updated: np.ndarray


def shape_pairs(outcome: Any, most: int) -> tuple[list[str], list[ShapePair]]:
    """Returns the DOFs, and the first modes in the pairs of result.json.

    The result has the identified matrices but no shapes, which are computed here.
    Modes at 0 Hz are left out, because any combination of them is a mode. Modes whose
    frequency is not found again are left out too.
    """
    rows = [row for row in outcome.modes if row["initial_hz"] and row["updated_hz"]]
    if not rows:
        return [], []
    before = outcome.case.natural_modes()
    dofs = list(before["dofs"])
    kept = [outcome.case.dofs.index(dof) for dof in dofs]
    block = np.ix_(kept, kept)
    after = _modes(outcome.mass[block], outcome.stiffness[block])
    if after is None:
        return dofs, []
    hz, shapes = after
    hz = hz * SECONDS.get(outcome.json["units"]["time"], np.nan)
    pairs = []
    for number, row in enumerate(outcome.modes, 1):
        if not (row["initial_hz"] and row["updated_hz"]):
            continue
        initial = before["shapes"][:, number - 1]
        same = np.flatnonzero(np.isclose(hz, row["updated_hz"], rtol=1e-6))
        if len(same) == 0 or not np.isfinite(initial).all():
            continue
        # Takes the most similar one of several at one frequency.
        updated = max((shapes[:, i] for i in same), key=lambda s: _mac(initial, s))
        updated = updated / np.abs(updated).max()
        initial = initial / np.abs(initial).max() * (-1.0 if initial @ updated < 0 else 1.0)
        pairs.append(
            ShapePair(number, row["initial_hz"], row["updated_hz"], initial, updated)
        )
        if len(pairs) == most:
            break
    return dofs, pairs


def _modes(mass: np.ndarray, stiffness: np.ndarray) -> Any:
    """Returns frequencies (cycles per unit of the model's time) and shapes, by columns.
    None if the mass is not positive.
    """
    try:
        root = np.linalg.inv(np.linalg.cholesky(mass))
    except np.linalg.LinAlgError:
        return None
    squares, vectors = np.linalg.eigh(root @ stiffness @ root.T)
    return np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi), root.T @ vectors


def _mac(one: np.ndarray, other: np.ndarray) -> float:
    return (one @ other) ** 2 / ((one @ one) * (other @ other))
