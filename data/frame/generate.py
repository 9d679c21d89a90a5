#!/usr/bin/env python3
"""Three-storey steel frame in 3-D: model, matrices and records by CalculiX.

Writes the deck of the design model (frame.inp), the matrices that CalculiX
exports from it and from it with one group changed at a time (.sti.gz .mas.gz,
frame.dof), a record (.csv) and a case file (.toml) per state of the structure,
the responses without noise (responses.npz) and truth.json.  Every response is CalculiX'; the
record of the loose joint by its nonlinear *DYNAMIC, the others by *MODAL
DYNAMIC.

Needs CalculiX 2.20 as `ccx` (Debian: calculix-ccx), NumPy and SciPy.  The loose
joint takes an hour, all others some minutes; `--runs FOLDER` keeps CalculiX'
files, and what is finished there is not run again.

    generate.py --runs FOLDER             everything
    generate.py --seed N --output FOLDER  other noise, without CalculiX
    generate.py --check                   holds the committed files against each
                                          other and, where there is a `ccx`,
                                          against CalculiX
"""

import argparse
import gzip
import json
import os
import shutil
import subprocess
import sys
import tempfile

import numpy as np
import scipy.sparse as sparse
from scipy.ndimage import convolve1d
from scipy.signal import firwin
from scipy.sparse.linalg import eigsh, splu

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import reference  # noqa: E402

# Geometry, N m s kg.  x goes east, y north, z up.
SPAN = (0.60, 0.40)  # between column axes
STOREY = 0.50  # between beam axes
COLUMN = (0.012, 0.016)  # section along x and y
DEPTH = 0.020  # of the beams, which are as wide as the columns
CORNERS = {1: (0, 0), 2: (1, 0), 3: (1, 1), 4: (0, 1)}  # SW SE NE NW
SIDES = {"west": (1, 4), "east": (2, 3)}
COLUMN_ELEMENTS = 4  # per storey
STOREYS = (1, 2, 3)

YOUNG, POISSON, DENSITY = 2.1e11, 0.3, 7850.0
FLOOR_DENSITY = 4.0e4  # of the beams, which carry the floor's ballast
ROD_STIFFNESS = 3.0e6  # crossed rods that brace each floor in its plane
BRACE_STIFFNESS = 8.0e4  # diagonal of the north face, one a storey
# C = a0 M + a1 K; the springs of rods and braces have none in the run of the
# loose joint, where CalculiX knows damping as a property of materials only.
RAYLEIGH = (1.0, 2.0e-5)

# The structure as it stands differs from its design model by these fractions.
AS_BUILT = {
    "columns_1_west": -0.04, "columns_1_east": 0.03,
    "columns_2_west": -0.06, "columns_2_east": 0.02,
    "columns_3_west": 0.05, "columns_3_east": -0.03,
    "brace_1": 0.06, "brace_2": -0.05, "brace_3": 0.04,
    "mass_1": 0.020, "mass_2": -0.015, "mass_3": 0.010,
}
# What changed since, as fractions of the structure as it stood.
STATES = {
    "healthy_1": {}, "healthy_2": {}, "healthy_3": {}, "healthy_4": {},
    "column_10": {"columns_2_west": -0.10},
    "column_20": {"columns_1_east": -0.20},
    "columns_two": {"columns_1_west": -0.15, "columns_3_east": -0.10},
    "gap": {},
    "added_mass": {"mass_2": 0.08},
}
GAP_BRACE = 1  # the brace whose joint is loose in the state "gap" ...
GAP = 1.5e-4  # ... and its play either way, m
EXPORT_FACTOR = 2.0  # a changed export has the group times this

# Hammer blows.
BLOW = 0.030  # s, soft tip: sin^2
BLOWS = 8  # a record, by turns along x and y
DURATION = 5.0  # of a record
GAP_DURATION = 4.0

STEP = 2.5e-4  # CalculiX' and that of its printed velocities
RATE = 400.0  # Hz, of the records
CORNER_HZ = 160.0  # of the anti-alias filter
TAIL = 0.05  # s simulated beyond a record, for that filter
MODES = 80  # of *MODAL DYNAMIC
NOISE = 0.02  # of each channel's standard deviation
HEADER = ["t", "fx", "fy", "a1x", "a1y", "a2x", "a2y", "a3x", "a3y"]


def station(floor):
    """The section of a column that is the top of a floor's joint."""
    return (COLUMN_ELEMENTS + 1) * floor


def column_node(corner, section, place):
    """`place` 1..4 of the section: SW SE NE NW."""
    return 1000 * corner + 10 * section + place


SENSOR_NODES = [column_node(1, station(s), 1) for s in STOREYS]
FORCE_X = column_node(3, station(3), 3)  # direction 1
FORCE_Y = column_node(2, station(3), 1)  # direction 2


def brace_nodes(storey):
    """Lower and upper end of the brace of the north face."""
    lower, upper = (4, 3) if storey % 2 else (3, 4)
    inner = {3: 4, 4: 3}
    return (column_node(lower, station(storey - 1), inner[lower]),
            column_node(upper, station(storey), inner[upper]))


def mesh():
    """Coordinates by node, [(element, nodes)] by set."""
    heights = [0.0]
    for floor in range(3):
        low = floor * STOREY + (DEPTH / 2 if floor else 0.0)
        high = (floor + 1) * STOREY - DEPTH / 2
        heights += list(np.linspace(low, high, COLUMN_ELEMENTS + 1)[1:])
        heights.append(high + DEPTH)
    places = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    nodes, sets = {}, {}
    for corner, (east, north) in CORNERS.items():
        side = "west" if corner in SIDES["west"] else "east"
        for section, z in enumerate(heights):
            for place, (x, y) in enumerate(places, 1):
                nodes[column_node(corner, section, place)] = np.array([
                    east * SPAN[0] + x * COLUMN[0],
                    north * SPAN[1] + y * COLUMN[1], z])
        for section in range(len(heights) - 1):
            storey, place = divmod(section, COLUMN_ELEMENTS + 1)
            name = ("joints" if place == COLUMN_ELEMENTS else
                    f"columns_{storey + 1}_{side}")
            sets.setdefault(name, []).append(
                (1000 * corner + section,
                 [column_node(corner, section + up, place)
                  for up in (0, 1) for place in (1, 2, 3, 4)]))
    # A beam joins the faces of two joints and has one section between.
    beams = [(1, 2, (2, 3), (1, 4)), (4, 3, (2, 3), (1, 4)),
             (1, 4, (4, 3), (1, 2)), (2, 3, (4, 3), (1, 2))]
    for floor in STOREYS:
        top = station(floor)
        for number, (first, last, out, into) in enumerate(beams):
            def face(corner, places):
                a, b = places
                return [column_node(corner, section, place)
                        for section, place in ((top - 1, a), (top - 1, b),
                                               (top, b), (top, a))]
            begin, end = face(first, out), face(last, into)
            base = 5000 + 100 * floor + 20 * number
            middle = [base + k for k in (1, 2, 3, 4)]
            for node, a, b in zip(middle, begin, end):
                nodes[node] = (nodes[a] + nodes[b]) / 2
            for half, (a, b) in enumerate(((begin, middle), (middle, end)), 1):
                x = [nodes[n] for n in a]
                along = nodes[b[0]] - x[0]
                if np.cross(x[1] - x[0], x[3] - x[0]) @ along < 0:
                    a, b = ([face[i] for i in (0, 3, 2, 1)] for face in (a, b))
                sets.setdefault(f"beams_{floor}", []).append((base + half,
                                                              a + b))
    return nodes, sets


def lines_of(values, form, per_line=8):
    texts = [form % value for value in values]
    return [",".join(texts[i:i + per_line])
            for i in range(0, len(texts), per_line)]


def model_lines(factors, damped, gap):
    """Deck of the model; factors: 1 + change by group.

    CalculiX tells the direction of a spring from its constant by the decimal
    point and drops the blank line that a SPRINGA has in its place.
    """
    nodes, sets = mesh()
    lines = ["** Three-storey steel frame: written by generate.py. N m s kg.",
             "*NODE,NSET=ALL"]
    lines += ["%d,%.7g,%.7g,%.7g" % (node, *x)
              for node, x in sorted(nodes.items())]
    for name, elements in sets.items():
        lines.append(f"*ELEMENT,TYPE=C3D8I,ELSET={name}")
        lines += [",".join(map(str, [element] + list(corners)))
                  for element, corners in elements]
    inner = {1: 3, 2: 4, 3: 1, 4: 2}
    lines.append("*ELEMENT,TYPE=SPRINGA,ELSET=rods")
    for floor in STOREYS:
        for a, b in ((1, 3), (2, 4)):
            lines.append("%d,%d,%d" % (
                6000 + 10 * floor + a,
                column_node(a, station(floor), inner[a]),
                column_node(b, station(floor), inner[b])))
    lines += ["*SPRING,ELSET=rods", "%.9E" % ROD_STIFFNESS]
    for storey in STOREYS:
        name = f"brace_{storey}"
        stiffness = BRACE_STIFFNESS * factors.get(name, 1.0)
        lines += [f"*ELEMENT,TYPE=SPRINGA,ELSET={name}",
                  "%d,%d,%d" % (6100 + storey, *brace_nodes(storey))]
        if gap and storey == GAP_BRACE:
            reach = 0.01
            force = stiffness * (reach - GAP)
            lines += [f"*SPRING,ELSET={name},NONLINEAR",
                      "%.9E,%.9E" % (-force, -reach), "%.9E,%.9E" % (0, -GAP),
                      "%.9E,%.9E" % (0, GAP), "%.9E,%.9E" % (force, reach)]
        else:
            lines += [f"*SPRING,ELSET={name}", "%.9E" % stiffness]
    for name in sets:
        density = DENSITY
        if name.startswith("beams"):
            density = FLOOR_DENSITY * factors.get("mass_" + name[-1], 1.0)
        lines += [f"*MATERIAL,NAME=M_{name}", "*ELASTIC",
                  "%.15g,%g" % (YOUNG * factors.get(name, 1.0), POISSON),
                  "*DENSITY", "%.15g" % density]
        if damped:
            lines.append("*DAMPING,ALPHA=%g,BETA=%g" % RAYLEIGH)
        lines.append(f"*SOLID SECTION,ELSET={name},MATERIAL=M_{name}")
    lines.append("*BOUNDARY")
    lines += ["%d,1,3" % column_node(corner, 0, place)
              for corner in CORNERS for place in (1, 2, 3, 4)]
    lines += ["*NSET,NSET=SENSORS", ",".join(map(str, SENSOR_NODES))]
    return lines


def blows(state):
    """[(direction, start, peak)] of a state's record, its own."""
    rng = np.random.default_rng([17, list(STATES).index(state)])
    duration = GAP_DURATION if state == "gap" else DURATION
    spacing = (duration - 0.8) / BLOWS
    return [("xy"[i % 2], 0.05 + spacing * (i + 0.3 * rng.random()),
             rng.uniform(80.0, 150.0)) for i in range(BLOWS)]


def forces(state, times):
    """fx, fy at `times`."""
    result = np.zeros((2, len(times)))
    for direction, start, peak in blows(state):
        s = (times - start) / BLOW
        inside = (s > 0) & (s < 1)
        result["xy".index(direction), inside] += (
            peak * np.sin(np.pi * s[inside])**2)
    return result


def amplitude_lines(name, times, values):
    """The history where it is not zero; linear between."""
    nonzero = np.concatenate([[False], values != 0, [False]])
    keep = nonzero[:-2] | nonzero[1:-1] | nonzero[2:]
    keep[[0, -1]] = True
    pairs = np.column_stack([times[keep], values[keep]])
    return ([f"*AMPLITUDE,NAME={name}"] +
            [",".join("%.8g,%.9g" % tuple(pair) for pair in pairs[i:i + 4])
             for i in range(0, len(pairs), 4)])


def factors_of(state):
    changes = STATES[state]
    return {name: (1 + AS_BUILT[name]) * (1 + changes.get(name, 0.0))
            for name in AS_BUILT}


def history_deck(state, step=STEP, modes=MODES, duration=None):
    is_gap = state == "gap"
    if duration is None:
        duration = (GAP_DURATION if is_gap else DURATION) + TAIL
    # The force is the same whatever the step.
    times = STEP * np.arange(int(round(duration / STEP)) + 1)
    lines = model_lines(factors_of(state), is_gap, is_gap)
    for name, values in zip("XY", forces(state, times)):
        lines += amplitude_lines("FORCE_" + name, times, values)
    if is_gap:
        lines += ["*STEP,INC=1000000", "*DYNAMIC,DIRECT,ALPHA=-0.05",
                  "%g,%g" % (step, duration)]
    else:
        lines += ["*STEP", "*FREQUENCY,STORAGE=YES", "%d" % modes, "*END STEP",
                  "*STEP,INC=1000000", "*MODAL DYNAMIC",
                  "%g,%g" % (step, duration), "*MODAL DAMPING,RAYLEIGH",
                  ",,%g,%g" % RAYLEIGH]
    lines += ["*CLOAD,AMPLITUDE=FORCE_X", "%d,1,1." % FORCE_X,
              "*CLOAD,AMPLITUDE=FORCE_Y", "%d,2,1." % FORCE_Y,
              "*NODE PRINT,NSET=SENSORS", "V", "*END STEP"]
    return lines


def export_deck(factors):
    return model_lines(factors, False, False) + [
        "*STEP", "*FREQUENCY,SOLVER=MATRIXSTORAGE", "*END STEP"]


def frequency_deck(factors, count):
    return model_lines(factors, False, False) + [
        "*STEP", "*FREQUENCY", "%d" % count, "*END STEP"]


def static_deck(factors):
    return model_lines(factors, False, False) + [
        "*STEP", "*STATIC", "*CLOAD", "%d,1,100." % FORCE_X,
        "%d,2,-70." % FORCE_Y, "*NODE PRINT,NSET=SENSORS", "U", "*END STEP"]


# What the case files say of the model: first guesses of the damping, and the
# DOFs that the reduction keeps, as many as modes: sensors, forces, the ends of
# the braces, and two of beams, which the tenth to twelfth mode bend.
GUESSED_RAYLEIGH = (0.7, 1.4e-5)
BRACE_ENDS = [f"{column_node(3, station(1), 4)}.1",
              f"{column_node(3, station(2), 4)}.1", f"{FORCE_X}.1"]
SENSORS = [f"{node}.{k}" for node in SENSOR_NODES for k in (1, 2)]
KEPT = SENSORS + [f"{FORCE_X}.1", f"{FORCE_Y}.2"] + BRACE_ENDS[:2] + [
    "5102.2", "5264.1"]


def case_lines(state, frequencies):
    """Case file of a state; all differ by their record alone."""
    def quoted(names):
        return ", ".join(f'"{name}"' for name in names)
    lines = [
        "# Written by generate.py; data/README.md describes the frame.",
        f'title = "Steel frame, {state}"',
        "[units]", 'force = "N"', 'length = "m"', 'time = "s"',
        "[model]",
        "damping = {rayleigh = [%g, %g]}   # a guess; see c_mass, c_stiffness"
        % GUESSED_RAYLEIGH,
        "[model.finite_element]",
        'mass = "frame.mas.gz"', 'stiffness = "frame.sti.gz"',
        "expected_frequencies = [" +
        ", ".join("%.7g" % f for f in frequencies[:6]) + "]   # CalculiX' own",
        "frequency_tolerance = 1e-6",
        "[model.reduction]", 'method = "serep"',
        f"keep = [{quoted(KEPT[:6])},", f"        {quoted(KEPT[6:])}]",
        f"compare = {len(KEPT)}",
        "renew = true   # the basis follows the parameters"]
    for group in AS_BUILT:
        kind = "mass" if group.startswith("mass") else "stiffness"
        lines += ["[[group]]", f'name = "{group}"', f'adds_to = "{kind}"',
                  f'changed_export = "{group}.{export_names(group)}.gz"',
                  "factor = %g" % EXPORT_FACTOR, "lower = -0.9", "upper = 2.0"]
    for of, scale in zip(("mass", "stiffness"), GUESSED_RAYLEIGH):
        lines += ["[[group]]", f'name = "c_{of}"', 'adds_to = "damping"',
                  f'proportional_to = "{of}"', "scale = %g" % scale,
                  "lower = -0.99", "upper = 20.0"]
    lines += ["[[record]]", f'name = "{state}"', f'file = "{state}.csv"',
              'time = "t"', 'interpolation = "cubic"', 'start = "rest"']
    for column, dof in (("fx", f"{FORCE_X}.1"), ("fy", f"{FORCE_Y}.2")):
        lines += ["  [[record.force]]", f'  dof = "{dof}"',
                  f'  column = "{column}"', '  unit = "N"']
    for column, dof in zip(HEADER[3:], SENSORS):
        lines += ["  [[record.channel]]", f'  column = "{column}"',
                  '  quantity = "absolute_acceleration"', f'  dof = "{dof}"',
                  '  unit = "m/s^2"', "  sigma_percent = %g" % (100 * NOISE)]
    # Groups of stiffness are called like their element sets.
    lines += ["[geometry]", 'file = "frame.inp"', "groups = {" + ", ".join(
        f'mass_{floor} = "beams_{floor}"' for floor in STOREYS) + "}"]
    # Added mass is what the groups mass_1 ... are for.
    lines += ["[damage]", 'kinds = ["nonlinear"]']
    for storey, below in zip(STOREYS, ["ground"] + BRACE_ENDS):
        lines += ["  [[damage.place]]", f'  name = "brace_{storey}"',
                  f'  between = ["{below}", "{BRACE_ENDS[storey - 1]}"]']
    return lines


class Runs:
    """CalculiX in a folder; a deck that has been run there is not run again."""

    def __init__(self, folder):
        self.folder = folder
        os.makedirs(folder, exist_ok=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def run(self, name, lines):
        deck = "\n".join(lines) + "\n"
        done = self.path(name + ".done")
        if os.path.exists(done):
            with open(done, encoding="ascii") as file:
                if file.read() == deck:
                    return
        with open(self.path(name + ".inp"), "w", encoding="ascii") as file:
            file.write(deck)
        outcome = subprocess.run(
            ["ccx", "-i", name], cwd=self.folder, capture_output=True,
            text=True, check=False,
            env=dict(os.environ, OMP_NUM_THREADS="1"))
        if "Job finished" not in outcome.stdout:
            raise RuntimeError(f"{name}: ccx failed\n{outcome.stdout[-2000:]}")
        with open(done, "w", encoding="ascii") as file:
            file.write(deck)

    def frequencies(self, name):
        """Hz, as printed in .dat."""
        result = []
        with open(self.path(name + ".dat"), encoding="ascii") as file:
            for line in file:
                if "P A R T I C I P A T I O N" in line:
                    break
                words = line.split()
                if len(words) == 5 and words[0].isdigit():
                    result.append(float(words[3]))
        return np.array(result)

    def printed(self, name):
        """Times and sensor vectors (times x nodes x 3) of .dat."""
        times, rows = [], []
        with open(self.path(name + ".dat"), encoding="ascii") as file:
            for line in file:
                words = line.split()
                if "for set SENSORS" in line:
                    times.append(float(words[-1]))
                elif len(words) == 4 and words[0].isdigit():
                    rows.append([float(word) for word in words[1:]])
        return (np.array(times),
                np.array(rows).reshape(len(times), len(SENSOR_NODES), 3))


def export_names(group):
    """The matrix that a changed export changes."""
    return "mas" if group.startswith("mass") else "sti"


def read_matrix(path, size):
    """Symmetric, of one triangle: row column value, from 1."""
    opener = gzip.open if path.endswith(".gz") else open
    with opener(path, "rt", encoding="ascii") as file:
        table = np.loadtxt(file)
    rows, columns = (table[:, i].astype(int) - 1 for i in (0, 1))
    half = sparse.coo_matrix((table[:, 2], (rows, columns)),
                             (size, size)).tocsc()
    full = half + sparse.triu(half, 1).T
    full.eliminate_zeros()
    return full.tocsc()


def read_dofs(folder):
    with open(os.path.join(folder, "frame.dof"), encoding="ascii") as file:
        return file.read().split()


def compress(source, target):
    """The same bytes for the same content: no name, no time."""
    with open(source, "rb") as file:
        data = gzip.compress(file.read(), 9, mtime=0)
    with open(target, "wb") as file:
        file.write(data)


def lowest(stiffness, mass, count):
    """Hz; shift-invert, because M is singular: see check()."""
    values = eigsh(stiffness, count, mass, sigma=0.0,
                   return_eigenvectors=False)
    return np.sqrt(np.sort(values)) / (2 * np.pi)


def accelerations(times, velocities, duration):
    """At RATE from velocities at CalculiX' step, which start at rest.

    Central differences of fourth order, then a low-pass filter without delay,
    flat within 1e-4 to 130 Hz and 80 dB down from 190 Hz.
    """
    step = times[0]
    assert np.allclose(np.diff(times), step, rtol=1e-3)
    before = 400  # at rest, as long as the filter
    v = np.vstack([np.zeros((before, velocities.shape[1])), velocities])
    a = np.zeros_like(v)
    a[2:-2] = (8 * (v[3:-1] - v[1:-3]) - (v[4:] - v[:-4])) / (12 * step)
    taps = firwin(int(round(2 * TAIL / step)) | 1, CORNER_HZ, fs=1 / step,
                  window=("kaiser", 9.0))
    a = convolve1d(a, taps, axis=0, mode="constant")
    every = int(round(1 / (RATE * step)))
    count = int(round(duration * RATE)) + 1
    # Row `before` is the first increment, at t = step.
    return a[before - 1::every][:count]


def no_spurious_mode(runs, name):
    """With very many modes (160) CalculiX adds one at 0 Hz that runs away."""
    frequencies = runs.frequencies(name)
    assert frequencies[0] > 6.0, (name, frequencies[:3])


def responses_of(runs, name, duration):
    times, velocities = runs.printed(name)
    return accelerations(times, velocities[:, :, :2].reshape(len(times), -1),
                         duration)


def duration_of(state):
    return GAP_DURATION if state == "gap" else DURATION


def write_records(folder, responses, seed):
    for index, state in enumerate(STATES):
        clean = responses[state].astype(float)
        times = np.arange(len(clean)) / RATE
        noise = np.random.default_rng([seed, index])
        measured = clean + (NOISE * clean.std(axis=0) *
                            noise.standard_normal(clean.shape))
        reference.write_csv(
            os.path.join(folder, state + ".csv"), HEADER,
            [times, *forces(state, times), *measured.T],
            ["%.4f"] + ["%.7g"] * 2 + ["%.4f"] * 6)


def export(runs, output):
    """The design model's matrices, and with one group changed at a time."""
    runs.run("frame", export_deck({}))
    shutil.copyfile(runs.path("frame.inp"), os.path.join(output, "frame.inp"))
    shutil.copyfile(runs.path("frame.dof"), os.path.join(output, "frame.dof"))
    for suffix in ("sti", "mas"):
        compress(runs.path("frame." + suffix),
                 os.path.join(output, f"frame.{suffix}.gz"))
    for group in AS_BUILT:
        runs.run(group, export_deck({group: EXPORT_FACTOR}))
        with open(runs.path("frame.dof"), encoding="ascii") as a, \
                open(runs.path(group + ".dof"), encoding="ascii") as b:
            assert a.read() == b.read(), group
        suffix = export_names(group)
        compress(runs.path(f"{group}.{suffix}"),
                 os.path.join(output, f"{group}.{suffix}.gz"))


def truth(runs):
    states = {}
    for state in STATES:
        runs.run("modes_" + state, frequency_deck(factors_of(state), 12))
        entry = {
            "frequencies_hz": list(runs.frequencies("modes_" + state)),
            "changes": STATES[state],
            "blows": [{"direction": d, "start_s": round(float(t), 9),
                       "peak_n": round(float(p), 9)}
                      for d, t, p in blows(state)],
        }
        if state == "gap":
            lower, upper = brace_nodes(GAP_BRACE)
            entry["frequencies_hz_of"] = "the joint closed"
            entry["gap"] = {
                "joint": f"brace_{GAP_BRACE}", "play_m": GAP,
                "stiffness_n_per_m": BRACE_STIFFNESS *
                (1 + AS_BUILT[f"brace_{GAP_BRACE}"]),
                "nodes": [lower, upper]}
        states[state] = entry
    return {
        "units": "N m s",
        "solver": "CalculiX 2.20",
        "sensors": {f"a{s}{d}": f"{node}.{k}"
                    for s, node in zip(STOREYS, SENSOR_NODES)
                    for k, d in ((1, "x"), (2, "y"))},
        "forces": {"fx": f"{FORCE_X}.1", "fy": f"{FORCE_Y}.2"},
        "damping": {"rayleigh": list(RAYLEIGH)},
        "export_factor": EXPORT_FACTOR,
        "as_built": AS_BUILT,
        "design_frequencies_hz": list(runs.frequencies("modes_design")),
        "noise": NOISE,
        "states": states,
    }


def generate(folder, output):
    runs = Runs(folder)
    export(runs, output)
    runs.run("modes_design", frequency_deck({}, 12))
    responses = {}
    for state in STATES:
        runs.run(state, history_deck(state))
        if state != "gap":
            no_spurious_mode(runs, state)
        responses[state] = responses_of(runs, state, duration_of(state))
    np.savez_compressed(
        os.path.join(output, "responses.npz"),
        **{name: a.astype(np.float32) for name, a in responses.items()})
    shutil.copyfile(runs.path("gap.inp"), os.path.join(output, "gap.inp"))
    known = truth(runs)
    reference.write_json(os.path.join(output, "truth.json"), known)
    for state in STATES:
        with open(os.path.join(output, state + ".toml"), "w",
                  encoding="utf-8") as file:
            file.write("\n".join(case_lines(
                state, known["design_frequencies_hz"])) + "\n")
    write_records(output, clean_responses(output), 1)


def clean_responses(folder):
    with np.load(os.path.join(folder, "responses.npz")) as archive:
        return {name: archive[name] for name in archive.files}


def check_matrices(folder):
    """Exports against CalculiX' own frequencies, and what they hold.

    The traps: C3D8I's internal DOFs come as nodes of their own, and M is
    singular (its null vectors are combinations of them, not single DOFs), so
    that only shift-invert about K gives the modes.
    """
    with open(os.path.join(folder, "truth.json"), encoding="utf-8") as file:
        known = json.load(file)
    dofs = read_dofs(folder)
    size = len(dofs)
    assert len(set(dofs)) == size
    stiffness, mass = (read_matrix(os.path.join(folder, f"frame.{s}.gz"), size)
                       for s in ("sti", "mas"))
    for matrix in (stiffness, mass):
        assert abs(matrix - matrix.T).max() == 0
    nodes, sets = mesh()
    internal = [dof for dof in dofs if int(dof.split(".")[0]) not in nodes]
    assert len(internal) == 9 * sum(map(len, sets.values()))
    print(f"{len(nodes)} nodes, {size} DOFs, {len(internal)} of them internal")
    spectrum = np.linalg.eigvalsh(mass.toarray())
    print("null vectors of M:", np.sum(spectrum < 1e-12 * spectrum[-1]))

    frequencies = np.array(known["design_frequencies_hz"])
    error = lowest(stiffness, mass, len(frequencies)) / frequencies - 1
    print("design: frequencies of the export against CalculiX' own, relative:",
          "%.1e" % np.max(np.abs(error)))
    assert np.max(np.abs(error)) < 1e-6

    groups = {}
    for group in AS_BUILT:
        suffix = export_names(group)
        changed = read_matrix(os.path.join(folder, f"{group}.{suffix}.gz"),
                              size)
        base = stiffness if suffix == "sti" else mass
        groups[group] = (changed - base) / (EXPORT_FACTOR - 1)
    for state in STATES:
        factors = factors_of(state)
        k, m = stiffness.copy(), mass.copy()
        for group, matrix in groups.items():
            if group.startswith("mass"):
                m = m + (factors[group] - 1) * matrix
            else:
                k = k + (factors[group] - 1) * matrix
        frequencies = np.array(known["states"][state]["frequencies_hz"])
        error = lowest(k, m, len(frequencies)) / frequencies - 1
        print(f"{state}: frequencies of design and groups, relative:",
              "%.1e" % np.max(np.abs(error)))
        assert np.max(np.abs(error)) < 1e-6
    return dofs, stiffness, mass, groups


def check_records(folder):
    """Noise of the records, and free vibration that decays."""
    responses = clean_responses(folder)
    with tempfile.TemporaryDirectory() as again:
        write_records(again, responses, 1)
        for state in STATES:
            with open(os.path.join(folder, state + ".csv"), "rb") as a, \
                    open(os.path.join(again, state + ".csv"), "rb") as b:
                assert a.read() == b.read(), state
    for state, a in responses.items():
        _, start, _ = blows(state)[-1]
        free = a[int((start + BLOW + 0.05) * RATE):].astype(float)
        energy = [np.sum(part**2) for part in np.array_split(free, 3)]
        print(f"{state}: {len(a)} samples, RMS",
              np.round(a.std(axis=0), 2), "m/s^2, free end from third to third",
              np.round(np.divide(energy[1:], energy[:-1]), 2))
        assert np.all(np.isfinite(a)) and energy[0] > energy[1] > energy[2]


def check_solver(folder, runs, dofs, stiffness):
    """Against CalculiX itself."""
    # Deck and exports are what CalculiX makes of them now.
    runs.run("frame", export_deck({}))
    for suffix in ("sti", "mas"):
        with gzip.open(os.path.join(folder, f"frame.{suffix}.gz")) as a, \
                open(runs.path("frame." + suffix), "rb") as b:
            assert a.read() == b.read(), suffix
    # A static answer.
    runs.run("static", static_deck({}))
    load = np.zeros(len(dofs))
    load[dofs.index(f"{FORCE_X}.1")] = 100.0
    load[dofs.index(f"{FORCE_Y}.2")] = -70.0
    answer = splu(stiffness).solve(load)
    _, printed = runs.printed("static")
    ours = np.array([[answer[dofs.index(f"{node}.{k}")] for k in (1, 2, 3)]
                     for node in SENSOR_NODES])
    error = np.max(np.abs(ours - printed[0])) / np.max(np.abs(printed))
    print("static answer, relative: %.1e" % error)
    assert error < 1e-6
    # Step, modes.
    state, duration = "healthy_1", 1.5
    base = None
    for name, step, modes in (("base", STEP, MODES),
                              ("half_step", STEP / 2, MODES),
                              ("more_modes", STEP, MODES * 3 // 2)):
        runs.run("check_" + name, history_deck(state, step, modes,
                                               duration + TAIL))
        no_spurious_mode(runs, "check_" + name)
        a = responses_of(runs, "check_" + name, duration)
        if base is None:
            base = a
            committed = clean_responses(folder)[state][:len(a)]
            error = np.linalg.norm(committed - a) / np.linalg.norm(a)
            print("committed response again: %.1e" % error)
            assert error < 1e-4
            continue
        error = np.max(np.linalg.norm(a - base, axis=0) /
                       np.linalg.norm(base, axis=0))
        print(f"{name}: worst channel %.1e" % error)
        assert error < 1e-3
    # Nonlinear run: half the step over its first blow.
    state, duration = "gap", 0.25
    runs.run("check_gap", history_deck(state, STEP / 2, MODES, duration + TAIL))
    a = responses_of(runs, "check_gap", duration)
    committed = clean_responses(folder)[state][:len(a)]
    error = np.max(np.linalg.norm(committed - a, axis=0) /
                   np.linalg.norm(a, axis=0))
    print("gap, half the step, worst channel over %.2f s: %.1e" %
          (duration, error))
    assert error < NOISE / 2


def main():
    parser = argparse.ArgumentParser(
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", default=HERE)
    parser.add_argument("--runs", help="folder of CalculiX' files")
    parser.add_argument("--seed", type=int,
                        help="of the noise; those committed have 1")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    if arguments.check:
        dofs, stiffness, _, _ = check_matrices(arguments.output)
        check_records(arguments.output)
        if shutil.which("ccx"):
            with tempfile.TemporaryDirectory() as scratch:
                check_solver(arguments.output,
                             Runs(arguments.runs or scratch), dofs, stiffness)
        return
    reference.prepare_output(HERE, arguments.output)
    if arguments.seed is None:
        with tempfile.TemporaryDirectory() as scratch:
            generate(arguments.runs or scratch, arguments.output)
        return
    if not os.path.samefile(arguments.output, HERE):
        for name in os.listdir(HERE):
            if name.endswith((".gz", ".dof", ".inp", ".npz", ".json")):
                shutil.copyfile(os.path.join(HERE, name),
                                os.path.join(arguments.output, name))
    write_records(arguments.output, clean_responses(HERE), arguments.seed)


if __name__ == "__main__":
    main()
