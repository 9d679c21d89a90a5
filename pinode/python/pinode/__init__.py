"""Structural identification from matrices and records.

The simple case is one call:

    import pinode

    fit = pinode.identify(M, K, floors, ground=ag, fs=100)
    print(fit)

Other cases are made of parts:

    case = pinode.Case(
        pinode.Model(mass=M, stiffness=K, damping=C),
        groups=[pinode.Group("k1", matrix=K1)],
        records=[pinode.Record("quake", step=0.01, ground={"x": ag},
                               interpolation="linear", start="rest",
                               channels=pinode.channels("a", A,
                                                        "absolute_acceleration"))],
    )
    fit = case.identify()
    print(fit)

Parts and keywords have the names of a case file. Arrays of NumPy or SciPy take the
place of file names. Numbers are in the units of the model unless a part says
otherwise.

Errors are raised as `pinode.Error`, a ValueError with one sentence. An unknown
keyword raises `pinode.KeywordError`, which is also a TypeError.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import _checked, _pinode
from ._arguments import KeywordError
from ._pinode import Error, __version__
from ._simple import identify
from .case import Case, read_case
from .forecast import Check, SensorPlan, Simulation
from .frequency_responses import FrequencyResponses, estimate_frfs
from .measurements import Channel, Mode, Record, channels
from .modes import IdentifiedModes, identify_modes
from .parts import (
    Element,
    FiniteElementModel,
    Group,
    Library,
    Model,
    Network,
    ShearBuilding,
    Unknown,
    UnknownForce,
)
from .result import Damage, Discovery, Fit, Parameter, RecordResult
from .result_folder import ResultFolder, read_result
from .structure_view import StructureView

if TYPE_CHECKING:
    from types import ModuleType

    from . import calculix, elements, figures, frames, opensees, watch

Error.__module__ = "pinode"
KeywordError.__module__ = "pinode"
_checked.install(_pinode)


# Bridges, frames, figures and a compiler's caller, which are read when they are
# asked for.
MODULES = ("calculix", "elements", "figures", "frames", "opensees", "watch")


def __getattr__(name: str) -> ModuleType:
    """Imports a module of the package at its first use."""
    if name in MODULES:
        import importlib

        return importlib.import_module("." + name, __name__)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


__all__ = [
    "Case",
    "Channel",
    "Check",
    "Damage",
    "Discovery",
    "Element",
    "Error",
    "FiniteElementModel",
    "Fit",
    "FrequencyResponses",
    "Group",
    "IdentifiedModes",
    "KeywordError",
    "Library",
    "Mode",
    "Model",
    "Network",
    "Parameter",
    "Record",
    "RecordResult",
    "ResultFolder",
    "SensorPlan",
    "ShearBuilding",
    "Simulation",
    "StructureView",
    "Unknown",
    "UnknownForce",
    "channels",
    "estimate_frfs",
    "identify",
    "identify_modes",
    "read_case",
    "read_result",
    "__version__",
]
