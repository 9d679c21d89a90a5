"""Models after elimination of constraints, including DOFs without mass."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ._pinode import Error
from .parts import FiniteElementModel, Group


class ConstrainedModel(NamedTuple):
    """M, C (None: not given) and K over `dofs`. Motion of all equations = link @ motion
    of `dofs`.
    """

    mass: np.ndarray
    damping: np.ndarray | None
    stiffness: np.ndarray
    dofs: list[str]
    link: np.ndarray

    def group(self, name: str, matrix: np.ndarray, adds_to: str, **keys: Any) -> Group:
        """Returns a group from a part of M, C or K over all equations."""
        wholes = {"mass": self.mass, "damping": self.damping, "stiffness": self.stiffness}
        whole = wholes.get(adds_to) if isinstance(adds_to, str) else None
        if whole is None:
            known = ", ".join(key for key, value in wholes.items() if value is not None)
            raise Error(f"group '{name}': adds_to is {adds_to!r:.40}, expected one of {known}")
        part = self.link.T @ matrix @ self.link
        # As an export where that part is there twice.
        return Group(name, adds_to=adds_to, changed_export=whole + 0.5 * (part + part.T),
                     factor=2.0, **keys)

    def model(self, keep: list[str], **keys: Any) -> FiniteElementModel:
        """Returns the model in which the DOFs `keep` stay and the others follow
        statically.
        """
        return FiniteElementModel(
            self.mass,
            self.stiffness,
            exported_damping=None if "damping" in keys else self.damping,
            dofs=self.dofs,
            reduction={"method": "guyan", "keep": keep, "renew": True},
            **keys,
        )
