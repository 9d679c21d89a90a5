#!/usr/bin/env python3
"""The steel frame of `frame` under broadband forces that nobody measures.

Writes record.csv.gz (ten minutes at 100 Hz of the six accelerometers, 2 % noise),
frame_ambient.toml, whose matrices are those of ../frame, and frame_modes.toml,
the same model for measured modes, which are to follow.  Nothing of
that is committed; a study makes as many as it wants:

    generate.py --output FOLDER [--seed N] [--change columns_1_east=-0.03 ...]

Forces act at all nodes of the floors in all three directions: at each node its
own, with a spectrum that falls above 20 Hz, and one that a floor's nodes share,
of its own in each direction, which falls above 8 Hz.  The responses are sums over
the first forty modes of the exported matrices of the structure as it was built
(truth.json of ../frame), with what --change says of it, made at once in the
frequency domain over a period twice as long as the record, of which one half is
left out: they are stationary, and have nothing above half the sampling rate.

Needs NumPy and SciPy; modes are kept in --cache, if given.
"""

import argparse
import gzip
import importlib.util
import json
import os
import sys

import numpy as np
from scipy.sparse.linalg import eigsh

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import reference  # noqa: E402

FOLDER = os.path.join(HERE, "..", "frame")
SPEC = importlib.util.spec_from_file_location(
    "frame", os.path.join(FOLDER, "generate.py"))
FRAME = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(FRAME)

RATE = 100.0  # Hz
DURATION = 600.0  # s
NOISE = 0.02  # of each channel's standard deviation
MODES = 40
OWN, OWN_CORNER = 0.05, 20.0  # N at each node, Hz
SHARED, SHARED_CORNER = 0.05, 8.0  # N at each node of a floor, Hz


def floor_nodes(floor):
    _, sets = FRAME.mesh()
    return sorted({node for _, corners in sets[f"beams_{floor}"]
                   for node in corners})


def modes_of(changes, cache):
    """Hz, mass-normalised shapes at the forces (areas apart) and the sensors."""
    name = "_".join(f"{group}{value:+g}"
                    for group, value in sorted(changes.items())) or "healthy"
    path = os.path.join(cache, name + ".npz") if cache else None
    if path and os.path.exists(path):
        with np.load(path) as kept:
            return kept["hertz"], kept["own"], kept["shared"], kept["sensors"]
    dofs = FRAME.read_dofs(FOLDER)
    place = {dof: i for i, dof in enumerate(dofs)}
    stiffness, mass = (
        FRAME.read_matrix(os.path.join(FOLDER, f"frame.{s}.gz"), len(dofs))
        for s in ("sti", "mas"))
    nominal = {"sti": stiffness, "mas": mass}
    total = dict(nominal)
    for group, built in FRAME.AS_BUILT.items():
        kind = FRAME.export_names(group)
        exported = FRAME.read_matrix(
            os.path.join(FOLDER, f"{group}.{kind}.gz"), len(dofs))
        factor = (1 + built) * (1 + changes.get(group, 0.0)) - 1
        total[kind] = total[kind] + factor / (FRAME.EXPORT_FACTOR - 1) * (
            exported - nominal[kind])
    values, shapes = eigsh(total["sti"], MODES, total["mas"], sigma=0.0)
    order = np.argsort(values)
    shapes = shapes[:, order]
    own, shared = [], []
    for floor in FRAME.STOREYS:
        for direction in "123":
            rows = shapes[[place[f"{node}.{direction}"]
                           for node in floor_nodes(floor)]]
            own.append(rows)
            shared.append(rows.sum(axis=0))
    result = (np.sqrt(values[order]) / (2 * np.pi), np.vstack(own),
              np.array(shared),
              shapes[[place[sensor] for sensor in FRAME.SENSORS]])
    if path:
        os.makedirs(cache, exist_ok=True)
        temporary = f"{path}.{os.getpid()}.npz"
        np.savez(temporary, hertz=result[0], own=result[1], shared=result[2],
                 sensors=result[3])
        os.replace(temporary, path)
    return result


def record(seed, changes, cache):
    """Accelerations (samples by sensors) with noise."""
    hertz, own, shared, sensors = modes_of(changes, cache)
    rng = np.random.default_rng(seed)
    samples = int(round(DURATION * RATE))
    period = 2 * samples
    frequency = np.fft.rfftfreq(period, 1 / RATE)[1:-1]

    def modal_force(places, size, corner):
        """Of white noise at the places, N/sqrt(Hz) one-sided by corner."""
        root = np.linalg.cholesky(places.T @ places +
                                  1e-12 * np.trace(places.T @ places) *
                                  np.eye(MODES))
        normal = rng.standard_normal((len(frequency), MODES, 2)) @ [1, 1j]
        density = size / np.sqrt(corner * np.pi / 2) / np.sqrt(
            1 + (frequency / corner)**2)
        return density[:, None] * (normal @ root.T)

    force = 0.5 * np.sqrt(period * RATE) * (
        modal_force(own, OWN, OWN_CORNER) +
        modal_force(shared, SHARED, SHARED_CORNER))
    w = 2 * np.pi * frequency[:, None]
    natural = 2 * np.pi * hertz
    a0, a1 = FRAME.RAYLEIGH
    motion = force / (natural**2 - w**2 + 1j * w * (a0 + a1 * natural**2))
    spectrum = np.zeros((period // 2 + 1, len(sensors)), dtype=complex)
    spectrum[1:-1] = (-w**2 * motion) @ sensors.T
    values = np.fft.irfft(spectrum, period, axis=0)[:samples]
    sigma = NOISE * values.std(axis=0)
    return values + sigma * rng.standard_normal(values.shape)


def model_lines():
    """The model and groups of ../frame; one floor's mass is known, for without
    a force the scale of mass and stiffness is open."""
    with open(os.path.join(FOLDER, "truth.json"), encoding="utf-8") as file:
        known = json.load(file)
    lines = FRAME.case_lines("healthy_1", known["design_frequencies_hz"])
    lines = lines[:lines.index("[[record]]")]
    lines[0] = "# Written by generate.py; data/README.md describes it."
    lines[1] = 'title = "Steel frame, ambient"'
    place = lines.index('name = "mass_3"')
    lines.insert(place + 1, "free = false   # weighed")
    return lines


def modes_lines():
    """What modes tell of: they are undamped."""
    lines = model_lines()
    return lines[:lines.index('name = "c_mass"') - 1]


def case_lines():
    lines = model_lines()
    lines += ["[[record]]", 'name = "ambient"', 'file = "record.csv.gz"',
              "sampling_rate_hz = %g" % RATE, 'excitation = "ambient"']
    for column, dof in zip(FRAME.HEADER[3:], FRAME.SENSORS):
        lines += ["  [[record.channel]]", f'  column = "{column}"',
                  '  quantity = "absolute_acceleration"', f'  dof = "{dof}"',
                  '  unit = "m/s^2"']
    return lines


def write(folder, values):
    """The cases and the record (samples by sensors)."""
    os.makedirs(folder, exist_ok=True)
    relative = os.path.relpath(FOLDER, folder)
    for name, lines in (("frame_ambient.toml", case_lines()),
                        ("frame_modes.toml", modes_lines())):
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            for line in lines:
                for key in ("mass = ", "stiffness = ", "changed_export = "):
                    if line.startswith(key) and ".gz" in line:
                        line = line.replace('= "', f'= "{relative}/')
                file.write(line + "\n")
    text = [",".join(FRAME.HEADER[3:])]
    text += [",".join("%.5g" % v for v in row) for row in values]
    with open(os.path.join(folder, "record.csv.gz"), "wb") as file:
        file.write(gzip.compress(("\n".join(text) + "\n").encode(), 1, mtime=0))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cache", help="folder that keeps modes")
    parser.add_argument("--change", nargs="*", default=[],
                        help="group=fraction of the structure as it stood")
    args = parser.parse_args()
    changes = {}
    for change in args.change:
        group, value = change.split("=")
        if group not in FRAME.AS_BUILT:
            parser.error(f"no group {group}")
        changes[group] = float(value)
    write(args.output, record(args.seed, changes, args.cache))


if __name__ == "__main__":
    main()
