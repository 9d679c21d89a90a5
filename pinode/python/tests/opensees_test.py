"""Models as OpenSees prints them, against published frequencies.

Bathe and Wilson's frame and the seven-storey portal frame of OpenSees'
verification examples, assembled here.
"""

import numpy as np
import pytest
import scipy.linalg

import pinode
from pinode import opensees


def beam(ends, area, inertia, young):
    """K of a plane frame member over x, y and rotation of both ends."""
    (x1, y1), (x2, y2) = ends
    length = np.hypot(x2 - x1, y2 - y1)
    c, s = (x2 - x1) / length, (y2 - y1) / length
    a, b = young * area / length, young * inertia / length**3
    local = np.zeros((6, 6))
    local[np.ix_([0, 3], [0, 3])] = [[a, -a], [-a, a]]
    local[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = b * np.array([
        [12, 6 * length, -12, 6 * length],
        [6 * length, 4 * length**2, -6 * length, 2 * length**2],
        [-12, -6 * length, 12, -6 * length],
        [6 * length, 2 * length**2, -6 * length, 4 * length**2]])
    turn = np.kron(np.eye(2), [[c, s, 0], [-s, c, 0], [0, 0, 1]])
    return turn.T @ local @ turn


class Frame:
    """Nodes by number with three DOFs each; those at y = 0 are fixed."""

    def __init__(self, widths, heights):
        xs = np.concatenate([[0.0], np.cumsum(widths)])
        ys = np.concatenate([[0.0], np.cumsum(heights)])
        self.columns = len(xs)
        self.places = {1 + i * len(xs) + j: (x, y)
                       for i, y in enumerate(ys) for j, x in enumerate(xs)}
        self.dofs, count = {}, 0
        for node, (_, y) in self.places.items():
            fixed = y == 0.0
            self.dofs[node] = [-1] * 3 if fixed else list(range(count, count + 3))
            count += 0 if fixed else 3
        self.mass = np.zeros((count, count))
        self.stiffness = np.zeros((count, count))

    def add(self, one, other, area, inertia, young, mass_per_length=0.0):
        ends = self.places[one], self.places[other]
        where = np.array(self.dofs[one] + self.dofs[other])
        free = where >= 0
        matrix = beam(ends, area, inertia, young)
        self.stiffness[np.ix_(where[free], where[free])] += matrix[np.ix_(free, free)]
        half = mass_per_length * np.hypot(*np.subtract(*ends)) / 2
        for node in (one, other):
            self.add_mass(node, half)

    def add_mass(self, node, mass):
        for equation in self.dofs[node][:2]:
            if equation >= 0:
                self.mass[equation, equation] += mass

    def print_matrices(self, folder):
        """As printA -file does."""
        for name, matrix in (("M", self.mass), ("K", self.stiffness)):
            np.savetxt(folder / f"{name}.out", matrix, fmt="%.15e", delimiter=" ")


def bathe_and_wilson():
    frame = Frame([20.0] * 10, [10.0] * 9)
    n = frame.columns
    for node in frame.places:
        if node > n and node % n != 0:  # a beam to the right
            frame.add(node, node + 1, 3.0, 1.0, 432000.0, 3.0)
        if node + n in frame.places:
            frame.add(node, node + n, 3.0, 1.0, 432000.0, 3.0)
    return frame


def omega_squared(model):
    return scipy.linalg.eigh(model.stiffness, model.mass, eigvals_only=True)


def test_bathe_and_wilsons_frame(tmp_path):
    frame = bathe_and_wilson()
    frame.print_matrices(tmp_path)
    model = opensees.read(tmp_path / "M.out", tmp_path / "K.out", dofs=frame.dofs)
    assert len(model.equations) == 297 and len(model.dofs) == 198
    assert omega_squared(model)[:3] == pytest.approx([0.589541, 5.52695, 16.5878],
                                                     rel=5e-6)
    case = pinode.Case(pinode.Model(model.mass, model.stiffness, dofs=model.dofs,
                                    influence=model.influence))
    assert case.natural_modes()["frequencies_hz"][0] == pytest.approx(
        np.sqrt(0.589541) / (2 * np.pi), rel=1e-6)
    # What follows statically meets no force.
    shape = model.expansion @ scipy.linalg.eigh(model.stiffness, model.mass)[1][:, 0]
    force = frame.stiffness @ shape
    light = frame.mass.diagonal() == 0.0
    assert np.abs(force[light]).max() < 1e-9 * np.abs(force[~light]).max()


# Of wide-flange sections: area (in^2), second moment (in^4).
SECTIONS = {
    "W14X176": (51.7, 2150.0), "W14X211": (62.1, 2670.0), "W14X246": (72.3, 3230.0),
    "W14X287": (84.4, 3910.0), "W24X110": (32.5, 3330.0), "W24X130": (38.3, 4020.0),
    "W24X160": (47.1, 5120.0)}
OUTER = ["W14X246"] * 3 + ["W14X211"] * 2 + ["W14X176"] * 2
INNER = ["W14X287"] * 3 + ["W14X246"] * 2 + ["W14X211"] * 2
BEAMS = ["W24X160"] * 2 + ["W24X130"] * 2 + ["W24X110"] * 3


def portal():
    """Two bays and seven storeys; kip, in, s. The floors' masses act along x
    alone, and the nodes of a floor move together along x."""
    frame = Frame([360.0] * 2, [162.0] * 2 + [156.0] * 5)
    n = frame.columns
    equal = []
    for storey in range(7):
        for line in range(n):
            node = 1 + storey * n + line
            name = (INNER if line == 1 else OUTER)[storey]
            frame.add(node, node + n, *SECTIONS[name], 29500.0)
        left = 1 + (storey + 1) * n
        for line in range(n - 1):
            frame.add(left + line, left + line + 1, *SECTIONS[BEAMS[storey]], 29500.0)
            equal.append((left, left + line + 1, [1]))
        frame.mass[frame.dofs[left][0], frame.dofs[left][0]] += 0.49
    return frame, equal


PERIODS = [1.2732, 0.4313, 0.2420, 0.1602, 0.1190, 0.0951, 0.0795]  # s


def test_seven_storey_portal_frame(tmp_path):
    frame, equal = portal()
    frame.print_matrices(tmp_path)
    model = opensees.read(tmp_path / "M.out", tmp_path / "K.out", dofs=frame.dofs,
                          equal=equal)
    assert len(model.dofs) == 7
    assert list(model.influence) == ["x"]
    periods = 2 * np.pi / np.sqrt(omega_squared(model))
    assert np.round(periods, 4) == pytest.approx(PERIODS, abs=1.01e-4)


def test_equations_that_dofs_share():
    """The same frame as the transformation handler prints it: one equation for
    what moves together."""
    frame, equal = portal()
    link = np.eye(len(frame.mass))
    numbers = np.arange(len(frame.mass))
    for leader, follower, _ in equal:
        numbers[frame.dofs[follower][0]] = frame.dofs[leader][0]
    kept = sorted(set(numbers))
    link = (numbers[:, None] == np.array(kept)).astype(float)
    dofs = {node: [kept.index(numbers[e]) if e >= 0 else -1 for e in equations]
            for node, equations in frame.dofs.items()}
    shared = opensees.condense(link.T @ frame.mass @ link, link.T @ frame.stiffness @ link,
                               dofs=dofs)
    tied = opensees.condense(frame.mass, frame.stiffness, dofs=frame.dofs, equal=equal)
    assert shared.dofs == tied.dofs
    assert omega_squared(shared) == pytest.approx(omega_squared(tied), rel=1e-9)


def test_groups_follow_the_model():
    frame, equal = portal()
    model = opensees.condense(frame.mass, frame.stiffness, dofs=frame.dofs, equal=equal)
    part = portal()[0]
    part.stiffness[:] = 0.0
    part.add(1, 4, *SECTIONS[OUTER[0]], 29500.0)
    group = model.condense(part.stiffness)
    # dw^2/dalpha of the condensed model is that of the whole one.
    values, shapes = scipy.linalg.eigh(model.stiffness, model.mass)
    slope = shapes[:, 0] @ group @ shapes[:, 0]
    step = 1e-4
    moved = opensees.condense(frame.mass, frame.stiffness + step * part.stiffness,
                              dofs=frame.dofs, equal=equal)
    assert slope == pytest.approx((omega_squared(moved)[0] - values[0]) / step, rel=1e-3)


def test_groups_with_rotations_without_mass():
    """A column whose rotations have no mass: how they follow is another matter in the
    structure that has lost stiffness."""
    frame = Frame([6.0], [4.0, 4.0])
    young, inertia, area = 2e11, 1e-4, 1e-2
    parts = {}
    for name, ends in {"low": [(1, 3), (2, 4)], "high": [(3, 5), (4, 6)],
                       "beams": [(3, 4), (5, 6)]}.items():
        before = frame.stiffness.copy()
        for one, other in ends:
            frame.add(one, other, area, inertia, young)
        parts[name] = frame.stiffness - before
    for node in (3, 4, 5, 6):
        frame.add_mass(node, 1e4)

    def frequencies(stiffness):
        model = opensees.condense(frame.mass, stiffness, dofs=frame.dofs)
        return np.sqrt(omega_squared(model)) / (2 * np.pi)

    model = opensees.condense(frame.mass, frame.stiffness, dofs=frame.dofs)
    modes = [pinode.Mode(hz, frequency_sigma=1e-6 * hz)
             for hz in frequencies(frame.stiffness - 0.4 * parts["low"])[:2]]
    linear = pinode.Case(
        pinode.Model(model.mass, model.stiffness, dofs=model.dofs, influence=model.influence),
        groups=[pinode.Group("low", model.condense(parts["low"]))], modes=modes)
    whole = pinode.Case(model.whole(), modes=modes, groups=[
        model.group("low", parts["low"], lower=-0.9)])
    assert whole.dofs == model.dofs and len(model.constrained.dofs) == 12
    assert np.allclose(whole.stiffness, model.stiffness)
    assert abs(linear.identify()["low"] + 0.4) > 0.01
    assert whole.identify()["low"] == pytest.approx(-0.4, abs=1e-4)
    with pytest.raises(pinode.Error, match="expected 12 x 12"):
        model.group("low", np.eye(3))
    with pytest.raises(pinode.Error, match="expected one of mass, stiffness"):
        model.group("low", parts["low"], adds_to="damping")


@pytest.mark.parametrize("text, message", [
    ("", "0 rows"), ("1 2\n3\n", ":2: 1 numbers, expected 2"), ("1 a\n", ":1: '1 a'"),
    ("1 2\n", "1 rows of 2"), ("nan\n", "not finite")])
def test_bad_files(tmp_path, text, message):
    path = tmp_path / "M.out"
    path.write_text(text)
    with pytest.raises(pinode.Error, match=message):
        opensees.read_matrix(path)
    with pytest.raises(pinode.Error, match="cannot be read"):
        opensees.read_matrix(tmp_path / "nowhere")


def test_what_does_not_fit_together():
    one, two = np.eye(1), np.eye(2)
    dofs = {1: [0, 1]}
    for arguments, message in [
            ((one, two), "2 rows, expected 1"),
            ((two, np.ones(2)), "expected a square one"),
            ((two, two, [["a", 1], [1, 1]]), "not an array of numbers"),
            ((0 * two, two), "mass matrix is zero"),
            ((two, np.array([[4.0, -2.0], [0.0, 2.0]])),
             r"stiffness matrix is not symmetric: -2 at 1\.1, 1\.2 and 0 the other way round"),
            ((np.diag([1.0, 0.0]), np.zeros((2, 2))), "not held by the stiffness")]:
        with pytest.raises(pinode.Error, match=message):
            opensees.condense(*arguments, dofs=dofs)
    with pytest.raises(pinode.Error, match="equation 1 is not a DOF"):
        opensees.condense(two, two, dofs={1: [0, -1]})
    with pytest.raises(pinode.Error, match="equation 7"):
        opensees.condense(two, two, dofs={1: [0, 7]})
    with pytest.raises(pinode.Error, match="node 5 has no DOF"):
        opensees.condense(two, two, dofs=dofs, equal=[(1, 5, [1])])


def test_rigid_diaphragm():
    """A slab of mass m on four columns of stiffness k at its corners: w^2 is
    4 k / m in both directions, and k r^2 / (m r^2 / 4) the same in torsion; an
    eccentric mass at one corner couples them."""
    half_x, half_y, k, m = 3.0, 2.0, 5.0e6, 8.0e3
    corners = {1: (half_x, half_y, 3.0), 2: (-half_x, half_y, 3.0),
               3: (-half_x, -half_y, 3.0), 4: (half_x, -half_y, 3.0)}
    dofs = {node: [3 * node - 3, 3 * node - 2, -1, -1, -1, 3 * node - 1] for node in range(1, 6)}
    masses = np.array([1.0, 1.0, 1.0, 3.0]) * m / 4
    mass, stiffness = np.zeros((15, 15)), np.zeros((15, 15))
    for node, own in zip(corners, masses):
        for equation in dofs[node][:2]:
            mass[equation, equation], stiffness[equation, equation] = own, k
    model = opensees.condense(
        mass, stiffness, dofs=dofs, translations=3, rigid=[(3, 5, [1, 2, 3, 4])],
        coordinates={**corners, 5: (0.0, 0.0, 3.0)})
    assert model.dofs == ["5.1", "5.2", "5.6"]
    x, y = np.array([place[:2] for place in corners.values()]).T
    expected = np.array([
        [masses.sum(), 0.0, -(masses * y).sum()],
        [0.0, masses.sum(), (masses * x).sum()],
        [-(masses * y).sum(), (masses * x).sum(), (masses * (x**2 + y**2)).sum()]])
    np.testing.assert_allclose(model.mass, expected, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(
        model.stiffness, np.diag([4 * k, 4 * k, 4 * k * (half_x**2 + half_y**2)]),
        rtol=1e-12, atol=1e-6)
    np.testing.assert_array_equal(model.influence["y"], [0.0, 1.0, 0.0])
    # Every corner moves with the slab.
    turned = model.expansion @ [0.0, 0.0, 1.0]
    np.testing.assert_allclose(turned[dofs[2][0]], -half_y)
    np.testing.assert_allclose(turned[dofs[2][1]], -half_x)


@pytest.mark.parametrize("kind", ["beam", "bar"])
def test_rigid_links(kind):
    """A cantilever whose mass sits on a rigid arm (a, b) from its tip: its
    inertia is that of the arm, or of none where only translations are tied."""
    height, inertia, young, m, a, b = 4.0, 2.0e-5, 2.1e11, 300.0, 0.6, 0.25
    ends = ((0.0, 0.0), (0.0, height))
    dofs = {1: [-1] * 3, 2: [0, 1, 2], 3: [3, 4, 5], 4: [6, 7, 8]}
    stiffness, mass = np.zeros((9, 9)), np.zeros((9, 9))
    stiffness[:3, :3] = beam(ends, 1e-2, inertia, young)[3:, 3:]
    mass[6, 6] = mass[7, 7] = m
    # In two links, the second given first.
    places = {1: ends[0], 2: ends[1], 3: (a, height), 4: (a, height + b)}
    if kind == "bar":
        stiffness[5, 5] = stiffness[8, 8] = 1.0
    model = opensees.condense(mass, stiffness, dofs=dofs,
                              rigid=[(kind, 3, [4]), (kind, 2, [3])], coordinates=places)
    tip = stiffness[:3, :3]
    if kind == "beam":
        assert model.dofs == ["2.1", "2.2", "2.3"]
        expected = m * np.array([[1, 0, -b], [0, 1, a], [-b, a, a * a + b * b]])
        np.testing.assert_allclose(model.mass, expected, rtol=1e-12)
        np.testing.assert_allclose(model.stiffness, tip, rtol=1e-12)
    else:
        assert model.dofs == ["2.1", "2.2"]
        follow = tip[:2, :2] - np.outer(tip[:2, 2], tip[2, :2]) / tip[2, 2]
        np.testing.assert_allclose(model.mass, m * np.eye(2), rtol=1e-12)
        np.testing.assert_allclose(model.stiffness, follow, rtol=1e-9)


@pytest.mark.parametrize("keys, message", [
    ({"rigid": [("rod", 2, [3])]}, "kind 'rod'"),
    ({"rigid": [(3, 2, [3])]}, "translations=3"),
    ({"rigid": [("beam", 2, [9])]}, "node 9 is not in 'dofs'"),
    ({"rigid": [("beam", 2, [2])]}, "tied to itself"),
    ({"rigid": [("beam", 2, [3])], "coordinates": {2: (0, 1)}}, "node 3 has no place"),
    ({"rigid": [("beam", 2, [3])], "coordinates": {2: (0, 1), 3: (0, 1, 2)}}, "2 finite"),
    ({"rigid": [("beam", 2, [3]), ("beam", 3, [2])]}, "circle"),
    ({"rigid": [("beam", 2, [4]), ("beam", 3, [4])]}, "twice"),
    ({"rigid": [("beam", 2, [1])]}, "fixed, expected the fixed node"),
    ({"rigid": 3}, "list of"),
])
def test_links_that_cannot_be(keys, message):
    dofs = {1: [-1] * 3, 2: [0, 1, 2], 3: [3, 4, 5], 4: [6, 7, 8]}
    places = {1: (0, 0), 2: (0, 1), 3: (1, 1), 4: (2, 1)}
    with pytest.raises(pinode.Error, match=message):
        opensees.condense(np.eye(9), np.eye(9), dofs=dofs,
                          **{"coordinates": places, **keys})
