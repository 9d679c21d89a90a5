"""Models from OpenSees.

OpenSees prints its matrices as full ones:

    integrator('GimmeMCK', 1.0, 0.0, 0.0); analyze(1, 0.0)
    printA('-file', 'M.out')                   # and so for C and K

with `system('FullGeneral')` and `numberer('Plain')`. A row is an equation;
which DOF of which node it is, `nodeDOFs(tag)` says (-1: fixed).

    model = pinode.opensees.read("M.out", "K.out", dofs={2: [0, 1, 2], ...})
    case = pinode.Case(pinode.Model(model.mass, model.stiffness, {"ratios": [0.02]},
                                    dofs=model.dofs, influence=model.influence))
"""

from __future__ import annotations

import operator
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ._pinode import Error

# Entries below this fraction of the largest are no mass.
_NO_MASS = 1e-12


class CondensedModel(NamedTuple):
    """M, C and K over the DOFs that carry mass.

    dofs: "node.direction", in the order of the rows (directions 1 to 3, or to
        6, as OpenSees counts them).
    influence: {"x": r, ...}: what ground accelerations do at each DOF.
    expansion: motion of all equations = expansion @ motion of `dofs`.
    equations: the names of all equations.
    damping: None where it was not given.
    """

    mass: np.ndarray
    damping: np.ndarray | None
    stiffness: np.ndarray
    dofs: list[str]
    influence: dict[str, np.ndarray]
    expansion: np.ndarray
    equations: list[str]

    def condense(self, matrix: np.ndarray) -> np.ndarray:
        """Of a matrix over all equations, such as the part of a group, what it
        is over `dofs`, the others following as they do in the model."""
        matrix = np.asarray(matrix, dtype=float)
        n = len(self.equations)
        if matrix.shape != (n, n):
            raise Error(
                f"the matrix is {' x '.join(map(str, matrix.shape))}, expected {n} x {n}"
            )
        return _symmetric(self.expansion.T @ matrix @ self.expansion)


def read_matrix(path: str | os.PathLike[str]) -> np.ndarray:
    """A full square matrix as `printA -file` writes it."""
    try:
        with open(path, encoding="utf-8") as file:
            lines = file.read().splitlines()
    except (OSError, UnicodeDecodeError) as failure:
        raise Error(f"{path}: cannot be read: {failure}") from None
    rows: list[list[float]] = []
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            rows.append([float(word) for word in line.split()])
        except ValueError:
            raise Error(f"{path}:{number}: '{line.strip()[:40]}', expected numbers") from None
        if len(rows[-1]) != len(rows[0]):
            raise Error(
                f"{path}:{number}: {len(rows[-1])} numbers, expected {len(rows[0])} as in "
                "the first row"
            )
    if not rows or len(rows) != len(rows[0]):
        raise Error(
            f"{path}: {len(rows)} rows of {len(rows[0]) if rows else 0} numbers, expected a "
            "square matrix as of printA with system FullGeneral"
        )
    matrix = np.array(rows)
    if not np.isfinite(matrix).all():
        raise Error(f"{path}: has an entry that is not finite")
    return matrix


def equation_names(dofs: Mapping[int, Sequence[int]], size: int) -> list[str]:
    """"node.direction" of each of `size` equations.

    dofs: {node: equation of each of its DOFs}, from 0, as nodeDOFs gives it;
        negative where a DOF is fixed. An equation that several DOFs share
        (equalDOF with the transformation handler) has the name of the first.
    """
    nodes = _equations(dofs)
    most = sum(map(len, nodes.values()))
    if not isinstance(size, (int, np.integer)) or not 0 < size <= most:
        raise Error(f"size is {size!r:.40}, expected from 1 to {most}, the DOFs of all nodes")
    names = [""] * int(size)
    for node, equations in nodes.items():
        for direction, equation in enumerate(equations, 1):
            if equation < 0:
                continue
            if equation >= size:
                raise Error(
                    f"node {node}: equation {equation}, and the matrices have {size}; "
                    "expected those of nodeDOFs, from 0"
                )
            names[equation] = names[equation] or f"{node}.{direction}"
    for equation, name in enumerate(names):
        if not name:
            raise Error(f"equation {equation} is no DOF of a node, expected all in 'dofs'")
    return names


def condense(
    mass: Any,
    stiffness: Any,
    damping: Any = None,
    *,
    dofs: Mapping[int, Sequence[int]],
    equal: Iterable[tuple[int, int, Sequence[int]]] = (),
    translations: int = 2,
) -> CondensedModel:
    """The model over the DOFs that carry mass.

    mass, stiffness, damping: N x N over the equations.
    dofs: {node: [equation of each DOF]}, see equation_names.
    equal: (retained node, constrained node, [directions]), as equalDOF; where
        the matrices were printed without these constraints (handler Plain).
    translations: 2 or 3, the directions along which nodes move.

    Constraints come first, u = L q with L'ML and so on; then DOFs without mass
    follow the others statically (Guyan's reduction, which is exact there).
    """
    mass, stiffness = _square("mass", mass), _square("stiffness", stiffness)
    size = len(mass)
    if damping is not None:
        damping = _square("damping", damping)
    for name, matrix in (("stiffness", stiffness), ("damping", damping)):
        if matrix is not None and len(matrix) != size:
            raise Error(f"the {name} matrix has {len(matrix)} rows, expected {size} as the mass")
    names = equation_names(dofs, size)
    link, kept = _constraints(_equations(dofs), _ties(equal), size)
    mass, stiffness = link.T @ mass @ link, link.T @ stiffness @ link
    weight = np.abs(mass).max(axis=1)
    massive = weight > _NO_MASS * weight.max(initial=0.0)
    if not massive.any():
        raise Error("the mass matrix is zero, expected some DOF with mass")
    light = ~massive
    expansion = np.zeros((len(kept), int(massive.sum())))
    expansion[massive] = np.eye(expansion.shape[1])
    if light.any():
        inner = stiffness[np.ix_(light, light)]
        try:
            follow = -np.linalg.solve(inner, stiffness[np.ix_(light, massive)])
        except np.linalg.LinAlgError:
            follow = np.array([np.nan])
        scale = np.abs(np.diag(inner)).max()
        if not np.isfinite(follow).all() or np.linalg.eigvalsh(inner)[0] < 1e-12 * scale:
            loose = [names[kept[i]] for i in np.flatnonzero(light)]
            raise Error(
                "the DOFs without mass are not held by the stiffness, expected a support or a "
                f"mass for one of {', '.join(loose[:6])}"
            )
        expansion[light] = follow
    labels = [names[kept[i]] for i in np.flatnonzero(massive)]
    direction = np.array([int(label.rsplit(".", 1)[1]) for label in labels])
    influence = {
        axis: (direction == number).astype(float)
        for number, axis in ((1, "x"), (2, "y"), (3, "z"))
        if number <= translations and (direction == number).any()
    }
    whole = link @ expansion
    return CondensedModel(
        _symmetric(expansion.T @ mass @ expansion),
        None if damping is None else _symmetric(whole.T @ damping @ whole),
        _symmetric(expansion.T @ stiffness @ expansion),
        labels,
        influence,
        whole,
        names,
    )


def read(
    mass: str | os.PathLike[str],
    stiffness: str | os.PathLike[str],
    damping: str | os.PathLike[str] | None = None,
    **keys: Any,
) -> CondensedModel:
    """`condense` of matrices in files of printA."""
    return condense(
        read_matrix(mass),
        read_matrix(stiffness),
        None if damping is None else read_matrix(damping),
        **keys,
    )


def _equations(dofs: Any) -> dict[int, list[int]]:
    try:
        return {
            operator.index(node): [operator.index(equation) for equation in equations]
            for node, equations in dofs.items()
        }
    except (AttributeError, TypeError):
        raise Error(
            f"dofs is a value of type {type(dofs).__name__}, expected "
            "{node: [equation of each DOF]} with whole numbers"
        ) from None


def _ties(equal: Any) -> list[tuple[int, int, list[int]]]:
    try:
        return [
            (operator.index(retained), operator.index(constrained),
             [operator.index(direction) for direction in directions])
            for retained, constrained, directions in equal
        ]
    except (TypeError, ValueError):
        raise Error(
            f"equal is a value of type {type(equal).__name__}, expected a list of "
            "(retained node, constrained node, [directions])"
        ) from None


def _square(name: str, value: Any) -> np.ndarray:
    value = value.toarray() if hasattr(value, "toarray") else value
    try:
        matrix = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise Error(f"the {name} matrix is no array of numbers") from None
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or not matrix.size:
        raise Error(
            f"the {name} matrix is {' x '.join(map(str, matrix.shape)) or 'a number'}, "
            "expected a square one"
        )
    if not np.isfinite(matrix).all():
        raise Error(f"the {name} matrix has an entry that is not finite")
    return matrix


def _constraints(
    dofs: Mapping[int, Sequence[int]],
    equal: Iterable[tuple[int, int, Sequence[int]]],
    size: int,
) -> tuple[np.ndarray, list[int]]:
    """L of u = L q, and which equation each q is."""
    master = list(range(size))

    def equation(node: int, direction: int) -> int:
        if node not in dofs or not 1 <= direction <= len(dofs[node]):
            raise Error(f"equalDOF: node {node} has no DOF {direction}")
        return dofs[node][direction - 1]

    def root(index: int) -> int:
        while master[index] != index:
            index = master[index]
        return index

    held: set[int] = set()
    for retained, constrained, directions in equal:
        for direction in directions:
            leader, follower = equation(retained, direction), equation(constrained, direction)
            if leader < 0 and follower < 0:
                continue
            if leader < 0 or follower < 0:
                # What is tied to a support stands still.
                held.add(root(max(leader, follower)))
            elif root(leader) != root(follower):
                master[root(follower)] = root(leader)
    held = {root(index) for index in held}
    kept = [i for i in range(size) if master[i] == i and i not in held]
    if not kept:
        raise Error("the constraints leave no DOF free")
    place = {index: column for column, index in enumerate(kept)}
    link = np.zeros((size, len(kept)))
    for index in range(size):
        if root(index) in place:
            link[index, place[root(index)]] = 1.0
    return link, kept


def _symmetric(matrix: np.ndarray) -> np.ndarray:
    return 0.5 * (matrix + matrix.T)


__all__ = ["CondensedModel", "condense", "equation_names", "read", "read_matrix"]
