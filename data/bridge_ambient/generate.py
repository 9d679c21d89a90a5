#!/usr/bin/env python3
"""A long-span girder under wind and traffic that nobody measures.

Writes setup1.csv.gz and setup2.csv.gz (an hour each of ten accelerometers),
M.csv and K.csv of the design, a matrix a group, and truth.json.  --seed gives
another realisation; with --output also the case file goes there.

A steel box girder, continuous over three spans of 160, 240 and 120 m: Euler's
beam in vertical bending, St. Venant's in torsion, elements of 40 m.  Ends are
held in height and twist; on each pier stand two bearings side by side.  DOFs are
the height w, the twist t (positive where the left edge goes up) and the slope r
of the nodes 0 to 13.  The footway is on one side: the centre of mass is a little
off the shear centre, and bending and torsion of a close pair mix.

Wind: vertical and longitudinal turbulence after von Karman, coherent after
Davenport between nodes, makes lift and moment by the quasi-steady derivatives of
the deck with an admittance after Liepmann.  Traffic: at each node two lanes of
tyre forces that know nothing of each other, flat up to the bounce of lorries.
Forces and responses are made at once in the frequency domain, over a period
twice as long as the record, of which the second half is left out: they are
stationary, and exact between lines.  Before it samples, the logger low-passes
(flat to 8 Hz, nothing from 10 Hz on); it reads whole mm/s^2.
"""

import argparse
import gzip
import os
import sys

import numpy as np
from scipy.linalg import eig, eigh

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import reference  # noqa: E402

RATE = 20.0  # Hz
DURATION = 3600.0  # s
NOISE = 0.02  # of each channel's standard deviation
RESOLUTION = 1e-3  # m/s^2: 16 bits for 3.3 g to either side
FLAT, STOP = 8.0, 10.0  # Hz, the logger's filter

# Girder, by span.  Steel box 5.5 m deep and 7 m wide, deck 25 m wide.
ELEMENTS = [4, 6, 3]
LENGTH = 40.0  # of an element, m
YOUNG, SHEAR = 2.1e11, 8.1e10  # N/m^2
BENDING = [3.2, 4.0, 3.2]  # second moment of area, m^4
TORSION = 3.8  # m^4, closed box with plates of 18 mm: 4 A^2 / sum(b / t)
MASS = 12e3  # kg/m: steel 7 t/m, asphalt and footway 5 t/m
RADIUS = 8.0  # of gyration about the axis, m: the deck is 25 m wide
OFFSET = 0.1  # of the centre of mass to the left, m
PIERS = [4, 10]  # nodes
BEARING = 1.2e9  # N/m each: pot bearings on columns 30 m high
BEARING_ARM = 3.5  # from the axis, m
EDGE = 11.0  # of the sensors from the axis, m

# What the structure differs by from the design: two pairs of a bending and a
# torsion mode are about 1.2 % apart then.
TRUTH = {"bending_1": 0.12, "bending_2": -0.07, "bending_3": 0.06,
         "torsion_sides": -0.08, "torsion_2": 0.07, "bearings": 0.22}
# C = a0 M + a1 K of the design; the case's factors are 30 % too low.
DAMPING = [(0.3, 0.010), (3.0, 0.009)]  # Hz, ratio
PRIOR_DAMPING_FACTOR = 0.7

# Wind across the girder, 30 m above the water; traffic.
WIND = 15.0  # m/s
INTENSITY = {"vertical": 0.07, "longitudinal": 0.13}
SCALE = {"vertical": 40.0, "longitudinal": 130.0}  # m
DECAY = 8.0  # Davenport's C
AIR, WIDTH = 1.25, 25.0  # kg/m^3, m
# Of lift and moment per length, in rho U^2 B / 2 and rho U^2 B^2 / 2, for a gust
# of size U: derivatives for a vertical one, twice the coefficients for the other.
LIFT = {"vertical": 4.1, "longitudinal": -0.4}
MOMENT = {"vertical": 1.0, "longitudinal": 0.1}
TYRES, TYRES_CORNER = 2.5e3, 3.0  # N at a node in a lane; Hz
LANE = 5.0  # from the axis, m

# Stations (nodes) of the accelerometers, a pair each; the first two in both.
REFERENCES = [1, 6]
SETUPS = {"setup1": REFERENCES + [2, 8, 11], "setup2": REFERENCES + [3, 5, 12]}

NODES = sum(ELEMENTS) + 1
INNER = range(1, NODES - 1)


def dof_names():
    names = []
    for node in range(NODES):
        names += [f"w{node}", f"t{node}"] if node in INNER else []
        names.append(f"r{node}")
    return names


DOFS = dof_names()
PLACE = {name: i for i, name in enumerate(DOFS)}


def assemble(matrix, element, names):
    """Adds what it has at DOFs that are free."""
    kept = [i for i, name in enumerate(names) if name in PLACE]
    at = [PLACE[names[i]] for i in kept]
    matrix[np.ix_(at, at)] += element[np.ix_(kept, kept)]


def girder():
    """M, and by group the parts of K, of the design."""
    h = LENGTH
    bending = np.array([[12, 6 * h, -12, 6 * h],
                        [6 * h, 4 * h**2, -6 * h, 2 * h**2],
                        [-12, -6 * h, 12, -6 * h],
                        [6 * h, 2 * h**2, -6 * h, 4 * h**2]]) / h**3
    torsion = np.array([[1, -1], [-1, 1]]) / h
    mass = np.zeros((6, 6))  # w r w r, t t
    for point, weight in zip(*np.polynomial.legendre.leggauss(4)):
        s = 0.5 * (1 + point)
        height = np.array([1 - 3 * s**2 + 2 * s**3, h * s * (1 - s)**2,
                           3 * s**2 - 2 * s**3, h * s**2 * (s - 1), 0, 0])
        twist = np.array([0, 0, 0, 0, 1 - s, s])
        centre = height + OFFSET * twist
        mass += 0.5 * h * weight * MASS * (
            np.outer(centre, centre) +
            (RADIUS**2 - OFFSET**2) * np.outer(twist, twist))
    size = len(DOFS)
    total = np.zeros((size, size))
    parts = {name: np.zeros((size, size)) for name in TRUTH}
    spans = np.repeat([1, 2, 3], ELEMENTS)
    for e, span in enumerate(spans):
        vertical = [f"w{e}", f"r{e}", f"w{e + 1}", f"r{e + 1}"]
        twisting = [f"t{e}", f"t{e + 1}"]
        assemble(total, mass, vertical + twisting)
        assemble(parts[f"bending_{span}"],
                 YOUNG * BENDING[span - 1] * bending, vertical)
        assemble(parts["torsion_2" if span == 2 else "torsion_sides"],
                 SHEAR * TORSION * torsion, twisting)
    for node in PIERS:
        for side in (1, -1):
            arm = np.array([1, side * BEARING_ARM])
            assemble(parts["bearings"], BEARING * np.outer(arm, arm),
                     [f"w{node}", f"t{node}"])
    return total, parts


def rayleigh():
    """a0 and a1 of the structure."""
    w = np.array([2 * np.pi * hertz for hertz, _ in DAMPING])
    ratios = [ratio for _, ratio in DAMPING]
    return np.linalg.solve(np.column_stack([0.5 / w, 0.5 * w]), ratios)


def sensors(stations):
    """Rows of channels: at each station the left edge, then the right one."""
    rows = np.zeros((2 * len(stations), len(DOFS)))
    for i, node in enumerate(stations):
        for side, arm in enumerate([EDGE, -EDGE]):
            rows[2 * i + side, PLACE[f"w{node}"]] = 1
            rows[2 * i + side, PLACE[f"t{node}"]] = arm
    return rows


def columns(stations):
    return [f"{side}{node}" for node in stations for side in ("left", "right")]


def gust_density(frequency, direction):
    """Of the turbulence in (m/s)^2/Hz, one-sided, after von Karman."""
    scale = SCALE[direction]
    x = frequency * scale / WIND
    sigma = INTENSITY[direction] * WIND
    shape = ((1 + 755 * x**2) / (1 + 283 * x**2)**(11 / 6)
             if direction == "vertical" else 1 / (1 + 70.8 * x**2)**(5 / 6))
    return 4 * sigma**2 * scale / WIND * shape


def forces(frequency, rng):
    """Fourier components at all DOFs (lines by DOFs) of unit lines' width, N."""
    inner = np.array(INNER)
    lines = len(frequency)
    force = np.zeros((lines, len(DOFS)), dtype=complex)
    heights = [PLACE[f"w{node}"] for node in inner]
    twists = [PLACE[f"t{node}"] for node in inner]

    def normal():
        return rng.standard_normal((lines, len(inner), 2)) @ [1, 1j]

    apart = LENGTH * np.abs(inner[:, None] - inner[None, :])
    coherence = np.exp(-DECAY * frequency[:, None, None] * apart / WIND)
    root = np.linalg.cholesky(coherence + 1e-9 * np.eye(len(inner)))
    # Lift per m/s of gust on the length of a node.
    pressure = 0.5 * AIR * WIND * WIDTH * LENGTH
    admittance = 1 / np.sqrt(1 + 2 * np.pi**2 * frequency * WIDTH / WIND)
    for direction in ("vertical", "longitudinal"):
        size = pressure * admittance * np.sqrt(
            gust_density(frequency, direction))
        gust = size[:, None] * np.einsum("kij,kj->ki", root, normal())
        force[:, heights] += LIFT[direction] * gust
        force[:, twists] += MOMENT[direction] * WIDTH * gust
    density = TYRES / np.sqrt(
        TYRES_CORNER * np.pi / 2) / np.sqrt(1 + (frequency / TYRES_CORNER)**2)
    for arm in (LANE, -LANE):
        tyres = density[:, None] * normal()
        force[:, heights] += tyres
        force[:, twists] += arm * tyres
    return force


def record(stations, seed, mass, damping, stiffness):
    """Accelerations (samples by channels) as the logger stores them, the standard
    deviation of the noise, and of the channels."""
    rng = np.random.default_rng(seed)
    samples = int(round(DURATION * RATE))
    period = 2 * samples
    frequency = np.fft.rfftfreq(period, 1 / RATE)[1:-1]
    # Half the one-sided density on either side.
    force = 0.5 * np.sqrt(period * RATE) * forces(frequency, rng)
    rows = sensors(stations)
    spectrum = np.zeros((period // 2 + 1, len(rows)), dtype=complex)
    for first in range(0, len(frequency), 4000):
        part = slice(first, min(first + 4000, len(frequency)))
        w = 2 * np.pi * frequency[part, None, None]
        dynamic = stiffness - w**2 * mass + 1j * w * damping
        motion = np.linalg.solve(dynamic, force[part, :, None])[:, :, 0]
        spectrum[1:-1][part] = -w[:, :, 0]**2 * motion @ rows.T
    slope = np.clip((frequency - FLAT) / (STOP - FLAT), 0, 1)
    spectrum[1:-1] *= 0.5 * (1 + np.cos(np.pi * slope))[:, None]
    values = np.fft.irfft(spectrum, period, axis=0)[:samples]
    size = values.std(axis=0)
    values += NOISE * size * rng.standard_normal(values.shape)
    return np.rint(values / RESOLUTION).astype(int), NOISE * size, size


def modes(mass, damping, stiffness):
    """Frequencies in Hz, damping ratios, shapes (a column each) below STOP."""
    size = len(mass)
    states = np.block([
        [np.zeros((size, size)), np.eye(size)],
        [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]])
    values, vectors = eig(states)
    kept = np.flatnonzero((values.imag > 0) &
                          (np.abs(values) < 2 * np.pi * STOP))
    kept = kept[np.argsort(np.abs(values[kept]))]
    values, shapes = values[kept], vectors[:size, kept]
    # Damping couples modes a little: as real as they can be.
    shapes *= np.exp(-0.5j * np.angle((shapes**2).sum(axis=0)))
    assert np.abs(shapes.imag).max() < 0.03 * np.abs(shapes.real).max()
    return np.abs(values) / (2 * np.pi), -values.real / np.abs(values), shapes


def write_record(path, header, values):
    lines = [",".join(header)]
    lines += [",".join(map(str, row)) for row in values.tolist()]
    data = ("\n".join(lines) + "\n").encode()
    with open(path, "wb") as file:
        file.write(gzip.compress(data, 9, mtime=0))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", default=HERE)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    reference.prepare_output(HERE, args.output)

    mass, parts = girder()
    design = sum(parts.values())
    built = sum((1 + TRUTH[name]) * part for name, part in parts.items())
    a0, a1 = rayleigh()
    damping = a0 * mass + a1 * design
    for name, matrix in [("M", mass), ("K", design), *parts.items()]:
        reference.write_matrix(
            os.path.join(args.output, name + ".csv"), matrix)

    hertz, ratios, shapes = modes(mass, damping, built)
    band = np.flatnonzero(hertz < 3.0)
    assert len(band) == 10 and 0.3 < hertz[0] and hertz[10] > 3.5
    assert np.all((0.005 < ratios[band]) & (ratios[band] < 0.0105))
    pairs = [i for i in band if hertz[i + 1] / hertz[i] < 1.02]
    assert len(pairs) == 2
    # The same modes without damping, which the fit's matrices have.
    undamped = np.sqrt(eigh(built, mass, eigvals_only=True)) / (2 * np.pi)
    assert np.allclose(undamped[band], hertz[band], rtol=1e-3)

    all_stations = sorted(set(sum(SETUPS.values(), [])))
    rows = sensors(all_stations)
    truth = {
        "groups": dict(TRUTH, c_mass=1 / PRIOR_DAMPING_FACTOR - 1,
                       c_stiffness=1 / PRIOR_DAMPING_FACTOR - 1),
        "case_rayleigh": [PRIOR_DAMPING_FACTOR * a0, PRIOR_DAMPING_FACTOR * a1],
        "hertz": [float(f) for f in hertz],
        "damping_ratio": [float(z) for z in ratios],
        "places": columns(all_stations),
        "shapes": {},
        "noise_sigma": {},
        "channel_deviation": {},
    }
    for i in band:
        shape = (rows @ shapes[:, i]).real
        shape /= shape[np.argmax(np.abs(shape))]
        truth["shapes"][f"{i + 1}"] = [float("%.6g" % v) for v in shape]
    for number, (name, stations) in enumerate(SETUPS.items()):
        values, sigma, size = record(stations, [args.seed, number], mass,
                                     damping, built)
        assert np.abs(values).max() < 2**15
        truth["noise_sigma"][name] = [float("%.4g" % v) for v in sigma]
        truth["channel_deviation"][name] = [float("%.4g" % v) for v in size]
        write_record(os.path.join(args.output, name + ".csv.gz"),
                     columns(stations), values)
    reference.write_json(os.path.join(args.output, "truth.json"), truth)


if __name__ == "__main__":
    main()
