"""Models from OpenSees.

OpenSees prints its matrices as full ones:

    integrator('GimmeMCK', 1.0, 0.0, 0.0); analyze(1, 0.0)
    printA('-file', 'M.out')                   # and so for C and K

Use `system('FullGeneral')` and `numberer('Plain')`. Each row is an equation. The
command `nodeDOFs(tag)` returns the equations of a node's DOFs (-1: fixed).

    model = pinode.opensees.read("M.out", "K.out", dofs={2: [0, 1, 2], ...})
    case = pinode.Case(pinode.Model(model.mass, model.stiffness, {"ratios": [0.02]},
                                    dofs=model.dofs, influence=model.influence))

Use the whole model if rotations have no mass and the stiffness of groups may differ
much from the initial one:

    case = pinode.Case(model.whole(damping={"ratios": [0.02]}),
                       groups=[model.group("k1", K1)])
"""

from __future__ import annotations

import operator
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ._arguments import ANY, MAPPING, takes
from ._arrays import as_array
from ._constrained import ConstrainedModel
from ._part import as_path
from ._pinode import Error
from .parts import FiniteElementModel, Group

# Entries below this fraction of the largest are no mass.
_NO_MASS = 1e-12


class CondensedModel(NamedTuple):
    """M, C and K over the DOFs with mass.

    mass, damping, stiffness: square, one row per DOF. damping is None if it was not
        given.
    dofs: "node.direction", in the order of the rows. Directions are 1 to 3 or 1 to 6,
        as in OpenSees.
    influence: {"x": r, ...}: displacement of each DOF for a unit displacement of the
        ground.
    expansion: motion of all equations = expansion @ motion of `dofs`.
    equations: names of all equations.
    constrained: the model before DOFs without mass were eliminated.
    """

    mass: np.ndarray
    damping: np.ndarray | None
    stiffness: np.ndarray
    dofs: list[str]
    influence: dict[str, np.ndarray]
    expansion: np.ndarray
    equations: list[str]
    constrained: ConstrainedModel

    def condense(self, matrix: np.ndarray) -> np.ndarray:
        """Reduces a matrix over all equations, such as that of a group, to `dofs`.

        The other equations follow `dofs` as in the initial model, also if the group
        has changed. This is exact if all DOFs have mass, else of first order.
        Example: a column with free rotations loses 20 % of its stiffness. The shift
        of a frequency is then about 5 % too large, and at a loss of 40 % about 11 %.
        With `whole` the equations follow the changed group.
        """
        return _symmetric(self.expansion.T @ self._of_equations(matrix) @ self.expansion)

    def whole(self, **keys: Any) -> FiniteElementModel:
        """Returns the model with its DOFs without mass, as a FiniteElementModel.

        These follow `dofs` in the identified structure, by a reduction that is
        renewed during the fit. `keys` are those of FiniteElementModel. Groups must
        come from `group`.
        """
        return self.constrained.model(self.dofs, **keys)

    def group(
        self, name: str, matrix: np.ndarray, *, adds_to: str = "stiffness", **keys: Any
    ) -> Group:
        """Returns a Group for `whole`, from a matrix over all equations. `keys` are
        those of Group.
        """
        return self.constrained.group(name, self._of_equations(matrix), adds_to, **keys)

    def _of_equations(self, matrix: Any) -> np.ndarray:
        matrix = _numbers("group's", matrix)
        n = len(self.equations)
        if matrix.shape != (n, n):
            raise Error(
                f"the matrix is {' x '.join(map(str, matrix.shape))}, expected {n} x {n}"
            )
        return matrix


def read_matrix(path: str | os.PathLike[str]) -> np.ndarray:
    """Reads a full square matrix that `printA -file` has written."""
    # A number is an open file to Python.
    path = as_path("path", path)
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
    """Returns "node.direction" for each of `size` equations.

    dofs: {node: equation of each of its DOFs}, from 0, as nodeDOFs returns it;
        negative for a fixed DOF. If several DOFs share an equation (equalDOF with the
        transformation handler), it has the name of the first.
    """
    nodes = _equations(dofs)
    most = sum(map(len, nodes.values()))
    is_whole = isinstance(size, (int, np.integer)) and not isinstance(size, bool)
    if not is_whole or not 0 < size <= most:
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
            raise Error(f"equation {equation} is not a DOF of a node, expected all in 'dofs'")
    return names


def condense(
    mass: Any,
    stiffness: Any,
    damping: Any = None,
    *,
    dofs: Mapping[int, Sequence[int]],
    equal: Iterable[tuple[int, int, Sequence[int]]] = (),
    rigid: Iterable[tuple[str | int, int, Sequence[int]]] = (),
    coordinates: Mapping[int, Sequence[float]] | None = None,
    translations: int = 2,
) -> CondensedModel:
    """Reduces a model to the DOFs with mass. Returns a CondensedModel.

    mass, stiffness, damping: N x N over the equations.
    dofs: {node: [equation of each DOF]}, see equation_names.
    equal: (retained node, constrained node, [directions]) as for equalDOF. Use it if
        the matrices were printed without these constraints (handler Plain).
    rigid: (kind, retained node, [constrained nodes]), likewise. The kind is "beam" or
        "bar" as for rigidLink, or the direction 1, 2 or 3 across a rigidDiaphragm.
    coordinates: {node: (x, y) or (x, y, z)} of the nodes in `rigid`.
    translations: 2 or 3, the number of directions in which nodes move.

    Constraints are applied first: u = L q, so that M becomes L' M L. Then DOFs
    without mass follow the others statically (R. J. Guyan, AIAA J. 3 (1965) 380),
    which is exact for them. For groups see CondensedModel.condense.
    """
    mass, stiffness = _square("mass", mass), _square("stiffness", stiffness)
    size = len(mass)
    if damping is not None:
        damping = _square("damping", damping)
    for name, matrix in (("stiffness", stiffness), ("damping", damping)):
        if matrix is not None and len(matrix) != size:
            raise Error(f"the {name} matrix has {len(matrix)} rows, expected {size} as the mass")
    names = equation_names(dofs, size)
    nodes = _equations(dofs)
    for name, matrix in (("mass", mass), ("stiffness", stiffness), ("damping", damping)):
        if matrix is not None:
            _check_symmetric(name, matrix, names)
    link, kept = _constraints(
        nodes, _ties(equal), _rigid_rows(nodes, rigid, coordinates, translations), size
    )
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
    constrained = ConstrainedModel(
        _symmetric(mass),
        None if damping is None else _symmetric(link.T @ damping @ link),
        _symmetric(stiffness),
        [names[i] for i in kept],
        link,
    )
    return CondensedModel(
        _symmetric(expansion.T @ mass @ expansion),
        None if damping is None else _symmetric(whole.T @ damping @ whole),
        _symmetric(expansion.T @ stiffness @ expansion),
        labels,
        influence,
        whole,
        names,
        constrained,
    )


@takes(dofs=MAPPING, equal=ANY, rigid=ANY, coordinates=ANY, translations=ANY)
def read(
    mass: str | os.PathLike[str],
    stiffness: str | os.PathLike[str],
    damping: str | os.PathLike[str] | None = None,
    **keys: Any,
) -> CondensedModel:
    """Reads matrices from files of printA and reduces them with `condense`."""
    paths = [as_path("mass", mass), as_path("stiffness", stiffness)]
    if damping is not None:
        paths.append(as_path("damping", damping))
    return condense(*map(read_matrix, paths), **keys)


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


def _numbers(name: str, value: Any) -> np.ndarray:
    try:
        matrix = as_array(value.toarray() if hasattr(value, "toarray") else value)
        if matrix.dtype.kind in "biuf":
            return matrix.astype(float)
    except (TypeError, ValueError):
        pass
    raise Error(f"the {name} matrix is not an array of numbers")


def _square(name: str, value: Any) -> np.ndarray:
    matrix = _numbers(name, value)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or not matrix.size:
        raise Error(
            f"the {name} matrix is {' x '.join(map(str, matrix.shape)) or 'a number'}, "
            "expected a square one"
        )
    if not np.isfinite(matrix).all():
        raise Error(f"the {name} matrix has an entry that is not finite")
    return matrix


class _Row(NamedTuple):
    """A DOF that follows others: the sum of factor * motion of (node, direction)."""

    node: int
    direction: int
    leaders: list[tuple[float, int, int]]


def _places(coordinates: Any, translations: int) -> dict[int, np.ndarray]:
    try:
        places = {
            operator.index(node): np.array([float(x) for x in place])
            for node, place in ({} if coordinates is None else coordinates).items()
        }
    except (AttributeError, TypeError, ValueError):
        raise Error(
            f"coordinates is a value of type {type(coordinates).__name__}, expected "
            "{node: (x, y) or (x, y, z)}"
        ) from None
    for node, place in places.items():
        if place.shape != (translations,) or not np.isfinite(place).all():
            raise Error(f"coordinates: node {node}, expected {translations} finite numbers")
    return places


def _link_rows(kind: Any, offset: np.ndarray, retained: int, constrained: int,
               translations: int) -> list[_Row]:
    """Returns the rows of a rigid link: u_c = u_r + theta_r x offset, theta_c =
    theta_r, or the part of them that this kind of link has.
    """
    plane = translations == 2
    rotations = [3] if plane else [4, 5, 6]
    axes = [(3, 2)] if plane else [(4, 0), (5, 1), (6, 2)]  # DOF, vector
    moving, turning = list(range(1, translations + 1)), list(rotations)
    if kind == "bar":
        turning, axes = [], []
    elif kind != "beam":
        moving = [d for d in moving if d != kind]
        turning = [kind + 3]
        axes = [(kind + 3, kind - 1)]
    arm = np.zeros(3)
    arm[:translations] = offset
    rows = []
    for direction in moving:
        leaders = [(1.0, retained, direction)]
        for dof, axis in axes:
            factor = np.cross(np.eye(3)[axis], arm)[direction - 1]
            if factor != 0.0:
                leaders.append((float(factor), retained, dof))
        rows.append(_Row(constrained, direction, leaders))
    return rows + [_Row(constrained, d, [(1.0, retained, d)]) for d in turning]


def _rigid_rows(dofs: Mapping[int, Sequence[int]], rigid: Any, coordinates: Any,
                translations: int) -> list[_Row]:
    if not isinstance(translations, (int, np.integer)) or translations not in (2, 3):
        raise Error(f"translations is {translations!r:.40}, expected 2 or 3")
    try:
        links = [
            (kind, operator.index(retained), [operator.index(node) for node in constrained])
            for kind, retained, constrained in rigid
        ]
    except (TypeError, ValueError):
        raise Error(
            f"rigid is a value of type {type(rigid).__name__}, expected a list of "
            "(kind, retained node, [constrained nodes])"
        ) from None
    places = _places(coordinates, translations)
    kinds = ["beam", "bar"] + ([1, 2, 3] if translations == 3 else [])
    rows = []
    for kind, retained, constrained in links:
        is_kind = isinstance(kind, (str, int, np.integer)) and not isinstance(kind, bool)
        if not is_kind or kind not in kinds:
            raise Error(
                f"rigid: kind {kind!r:.40}, expected one of {', '.join(map(repr, kinds))}"
                + ("" if translations == 3 else " (rigidDiaphragm needs translations=3)")
            )
        for node in constrained:
            for each in (retained, node):
                if each not in dofs:
                    raise Error(f"rigid: node {each} is not in 'dofs'")
                if kind != "bar" and each not in places:
                    raise Error(f"rigid: node {each} has no place in 'coordinates'")
            if node == retained:
                raise Error(f"rigid: node {node} is tied to itself")
            offset = (np.zeros(translations) if kind == "bar"
                      else places[node] - places[retained])
            rows += _link_rows(kind, offset, retained, node, translations)
    return rows


class _Links:
    """Equations that follow others."""

    def __init__(self, dofs: Mapping[int, Sequence[int]], size: int) -> None:
        self.dofs = dofs
        self.master = list(range(size))
        self.held: set[int] = set()
        self.follow: dict[int, list[tuple[float, int]]] = {}

    def equation(self, what: str, node: int, direction: int) -> int:
        if node not in self.dofs or not 1 <= direction <= len(self.dofs[node]):
            raise Error(f"{what}: node {node} has no DOF {direction}")
        return self.dofs[node][direction - 1]

    def root(self, index: int) -> int:
        while self.master[index] != index:
            index = self.master[index]
        return index

    def tie(self, retained: int, constrained: int, direction: int) -> None:
        leader = self.equation("equalDOF", retained, direction)
        follower = self.equation("equalDOF", constrained, direction)
        if leader < 0 and follower < 0:
            return
        if leader < 0 or follower < 0:
            # What is tied to a support stands still.
            self.held.add(self.root(max(leader, follower)))
        elif self.root(leader) != self.root(follower):
            self.master[self.root(follower)] = self.root(leader)

    def add(self, row: _Row) -> None:
        leaders = []
        for factor, node, direction in row.leaders:
            leader = self.equation("rigid", node, direction)
            if leader >= 0:
                leaders.append((factor, self.root(leader)))
        follower = self.equation("rigid", row.node, row.direction)
        if follower < 0:
            if not leaders:
                return
            raise Error(
                f"rigid: DOF {row.direction} of node {row.node} is fixed, expected the fixed "
                "node as the retained one"
            )
        follower = self.root(follower)
        if leaders == [(1.0, follower)]:
            return
        if follower in self.follow or follower in self.held:
            raise Error(f"rigid: DOF {row.direction} of node {row.node} is constrained twice")
        self.follow[follower] = leaders


def _constraints(
    dofs: Mapping[int, Sequence[int]],
    equal: Iterable[tuple[int, int, Sequence[int]]],
    rigid: Iterable[_Row],
    size: int,
) -> tuple[np.ndarray, list[int]]:
    """Returns L of u = L q, and the equation of each q."""
    links = _Links(dofs, size)
    for retained, constrained, directions in equal:
        for direction in directions:
            links.tie(retained, constrained, direction)
    links.held = {links.root(index) for index in links.held}
    for row in rigid:
        links.add(row)
    roots = [links.root(index) for index in range(size)]
    kept = [i for i in range(size)
            if roots[i] == i and i not in links.held and i not in links.follow]
    if not kept:
        raise Error("the constraints leave no DOF free")
    link = np.zeros((size, len(kept)))
    link[kept] = np.eye(len(kept))
    # Those that follow others that follow come after these.
    done, waiting = set(kept) | links.held, dict(links.follow)
    while waiting:
        ready = [f for f, leaders in waiting.items() if all(i in done for _, i in leaders)]
        if not ready:
            raise Error("rigid: nodes follow each other in a circle")
        for follower in ready:
            for factor, leader in waiting.pop(follower):
                link[follower] += factor * link[leader]
            done.add(follower)
    return link[roots], kept


def _check_symmetric(name: str, matrix: np.ndarray, names: Sequence[str]) -> None:
    difference = np.abs(matrix - matrix.T)
    if matrix.size and difference.max() > 1e-6 * np.abs(matrix).max():
        row, column = np.unravel_index(np.argmax(difference), matrix.shape)
        raise Error(
            f"the {name} matrix is not symmetric: {matrix[row, column]:g} at {names[row]}, "
            f"{names[column]} and {matrix[column, row]:g} the other way round"
        )


def _symmetric(matrix: np.ndarray) -> np.ndarray:
    return 0.5 * (matrix + matrix.T)


__all__ = ["CondensedModel", "condense", "equation_names", "read", "read_matrix"]
