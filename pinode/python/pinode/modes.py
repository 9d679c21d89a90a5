"""Modes of a structure from records alone, without a model or its loads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from . import _html, _pinode
from ._pinode import Error

_DERIVATIVES = {"displacement": 0, "strain": 0, "velocity": 1, "acceleration": 2}


class IdentifiedModes(Sequence):
    """Modes by frequency; each a dictionary: frequency_hz, damping_ratio, their
    sigma, lower95 and upper95, the complex shape over `places`."""

    def __init__(self, found: dict[str, Any]) -> None:
        self._modes: list[dict[str, Any]] = found["modes"]
        self.places: list[str] = found["places"]
        self.remarks: list[str] = found["remarks"]

    @property
    def frequencies_hz(self) -> np.ndarray:
        return np.array([m["frequency_hz"] for m in self._modes])

    @property
    def damping_ratios(self) -> np.ndarray:
        return np.array([m["damping_ratio"] for m in self._modes])

    @property
    def shapes(self) -> np.ndarray:
        """places x modes, complex; the largest entry of each is 1."""
        if not self._modes:
            return np.zeros((len(self.places), 0), dtype=complex)
        return np.column_stack([m["shape"] for m in self._modes])

    def __getitem__(self, index: Any) -> Any:
        return self._modes[index]

    def __len__(self) -> int:
        return len(self._modes)

    def __repr__(self) -> str:
        text = ", ".join(f"{f:.4g} Hz" for f in self.frequencies_hz)
        return f"IdentifiedModes({text})"

    def _repr_html_(self) -> str:
        rows = [
            [i + 1, m["frequency_hz"], m["frequency_lower95"], m["frequency_upper95"],
             m["damping_ratio"], m["damping_lower95"], m["damping_upper95"]]
            for i, m in enumerate(self._modes)
        ]
        header = ["mode", "Hz", "from", "to (95 %)", "damping ratio", "from", "to (95 %)"]
        return _html.section(f"{len(self)} modes", _html.table(header, rows))


def identify_modes(
    records: Any,
    *,
    step: float | None = None,
    names: Sequence[str] | None = None,
    quantity: str | Sequence[str] = "acceleration",
    lowest_hz: float = 0.0,
    highest_hz: float = 0.0,
    block_rows: int = 0,
    max_order: int = 0,
    references: Sequence[str] = (),
    pick: Sequence[float] = (),
    threads: int = 1,
) -> IdentifiedModes:
    """Stochastic subspace identification over many orders, with intervals.

    records: samples x channels of one set-up, `step` seconds apart; or a
        dictionary {set-up: {"values": ..., "step": ..., "names": ...}} of several
        that have places in common.
    names: of the channels, which are places on the structure.
    quantity: "displacement", "velocity" or "acceleration", for all or for each.
    lowest_hz, highest_hz: what is looked for; chosen where 0.
    pick: frequencies (Hz) at which modes are taken whether stable or not.
    """
    if not isinstance(records, Mapping):
        records = {"record": {"values": records, "step": step, "names": names,
                              "quantity": quantity}}
    setups = []
    for name, setup in records.items():
        if not isinstance(setup, Mapping) or "values" not in setup:
            raise Error(f"set-up '{name}': expected {{'values': ..., 'step': ...}}")
        values = np.asarray(setup["values"])
        if values.ndim == 1:
            values = values[:, None]
        count = values.shape[1] if values.ndim == 2 else 0
        places = setup.get("names")
        places = [f"a{i + 1}" for i in range(count)] if places is None else list(places)
        setup_step = setup.get("step", step)
        if setup_step is None:
            raise Error(f"set-up '{name}': 'step' is missing, expected seconds")
        setups.append((str(name), places, _derivatives(setup.get("quantity", quantity), count),
                       values, float(setup_step)))
    return IdentifiedModes(
        _pinode.identify_modes(
            setups,
            lowest_hz=lowest_hz,
            highest_hz=highest_hz,
            block_rows=block_rows,
            max_order=max_order,
            references=list(references),
            pick=list(pick),
            threads=threads,
        )
    )


def _derivatives(quantity: str | Sequence[str], count: int) -> list[int]:
    quantities = [quantity] * count if isinstance(quantity, str) else list(quantity)
    for name in quantities:
        if name not in _DERIVATIVES:
            raise Error(
                f"'{name}' is no quantity, expected one of {', '.join(_DERIVATIVES)}"
            )
    return [_DERIVATIVES[name] for name in quantities]
