"""A device of unknown law: a network with memory beside two others.

    memory_network.py PINODE_UPDATE [--draws=3] [--noise=3] [--sliders=1] [--width=6]

A frame of two storeys has a degrading Bouc-Wen device (Baber and Noori's
equation, integrated here) in its first storey. Each draw has two
earthquakes for the fit and another one that is held out, all from filtered
noise. The floors' accelerations and the device's deformation have noise. The
matrices are known. Three devices are fitted from the same records:

- a network with memory, which knows nothing of the law,
- a feed-forward network of as many weights on deformation and rate,
- the true law, from starts that are wrong by a fifth.

A line per draw says the error of the free run on the held-out earthquake, as
RMS over the noise-free accelerations and deformation, each in per cent of its
RMS, and the seconds of each fit. The last line is the median over the draws.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile
import time

import numpy as np
from scipy.signal import lfilter

MASSES = np.array([2000.0, 2000.0])
STIFFNESSES = np.array([0.6e6, 2.0e6])
DAMPINGS = np.array([2000.0, 3000.0])
DEVICE = {"k": 1.5e6, "f": 9000.0, "s": 0.5, "n": 1.5, "strength": 0.02, "stiffness": 0.015}
STEP, SAMPLES = 0.01, 2000


def storeys(values):
    """Returns the matrix of springs between floors."""
    lower = np.array([[1.0, 0.0], [-1.0, 1.0]])
    return lower.T @ np.diag(values) @ lower


def earthquake(random, peak):
    """Returns ground accelerations from filtered noise in an envelope."""
    times = STEP * np.arange(SAMPLES)
    omega, zeta = 2.0 * np.pi * 2.5, 0.6
    pole = np.exp((-zeta + 1j * np.sqrt(1.0 - zeta**2)) * omega * STEP)
    noise = lfilter([1.0, -1.0], [1.0, -2.0 * pole.real, abs(pole) ** 2],
                    random.standard_normal(SAMPLES))
    noise *= (times / 4.0) ** 2 * np.exp(2.0 * (1.0 - times / 4.0))
    return peak * noise / np.abs(noise).max()


def simulate(ground):
    """Returns floors' absolute accelerations and the device's deformation."""
    p = DEVICE
    stiffness, damping = storeys(STIFFNESSES), storeys(DAMPINGS)
    matrix = np.zeros((2, 5))
    matrix[:, :2] = -stiffness / MASSES[:, None]
    matrix[:, 2:4] = -damping / MASSES[:, None]
    matrix[0, 4] = -p["f"] / MASSES[0]

    def rate(state, base):
        absolute = matrix @ state[:5]
        z, e = state[4], state[5]
        elastic = p["k"] * state[2] / p["f"]
        share = 1.0 if state[2] * z > 0.0 else 1.0 - 2.0 * p["s"]
        yielding = (1.0 + p["strength"] * e) * share * abs(z) ** p["n"]
        return np.array([state[2], state[3], absolute[0] - base, absolute[1] - base,
                         elastic * (1.0 - yielding) / (1.0 + p["stiffness"] * e), elastic * z])

    state = np.zeros(6)
    rows = [[0.0, 0.0, 0.0]]
    steps = 8
    size = STEP / steps
    for before, after in zip(ground[:-1], ground[1:]):
        for k in range(steps):
            base = [before + (after - before) * (k + part) / steps for part in (0.0, 0.5, 1.0)]
            one = rate(state, base[0])
            two = rate(state + 0.5 * size * one, base[1])
            three = rate(state + 0.5 * size * two, base[1])
            four = rate(state + size * three, base[2])
            state = state + size / 6.0 * (one + 2.0 * two + 2.0 * three + four)
        rows.append([*(matrix @ state[:5]), state[0]])
    return np.array(rows).T


def device_keys(kind, sliders, width):
    """Returns the case's section of one of the devices."""
    if kind == "law":
        values = "".join(
            f"parameters.{key} = {{initial = {value * factor}}}\n"
            for (key, value), factor in zip(DEVICE.items(), (1.2, 0.8, 1.0, 1.0, 0.8, 1.2)))
        return ("[[element]]\nname = \"device\"\ntype = \"baber_noori\"\n"
                "between = [\"ground\", \"u1\"]\n" + values)
    head = ("[[network]]\nname = \"device\"\ninputs = [\"x[u1]\", \"v[u1]\"]\n"
            "outputs = [\"u1\"]\nacts_as = \"force\"\n")
    if kind == "memory":
        return head + f"memory = {sliders}\nlayers = [{width}]\n"
    weights = 3 * sliders + 1 + width * (sliders + 4) + sliders * (1 + width)
    # A unit of the feed-forward network has two inputs, a bias and an output;
    # the linear path and the last bias are three more.
    return head + f"layers = [{round((weights - 3) / 4)}]\n"


def write_case(folder, kind, options):
    """Writes the case of one device; the records are in the same folder."""
    records = ""
    for name, role in (("one", "train"), ("two", "train"), ("unseen", "holdout")):
        channels = "".join(
            f"  [[record.channel]]\n  column = \"{column}\"\n  quantity = \"{quantity}\"\n"
            f"  dof = \"{dof}\"\n  unit = \"{unit}\"\n"
            for column, quantity, dof, unit in (
                ("a1", "absolute_acceleration", "u1", "m/s^2"),
                ("a2", "absolute_acceleration", "u2", "m/s^2"),
                ("d1", "displacement", "u1", "m")))
        records += (
            f"[[record]]\nname = \"{name}\"\nrole = \"{role}\"\nfile = \"{name}.csv\"\n"
            "time = \"t\"\nstart = \"rest\"\ninterpolation = \"linear\"\n"
            "  [[record.ground]]\n  direction = \"x\"\n  column = \"ground\"\n"
            "  unit = \"m/s^2\"\n" + channels)
    path = folder / f"{kind}.toml"
    path.write_text(
        "[model]\ndofs = [\"u1\", \"u2\"]\n"
        f"mass = {{diagonal = {MASSES.tolist()}}}\n"
        f"stiffness = {storeys(STIFFNESSES).tolist()}\n"
        f"damping = {storeys(DAMPINGS).tolist()}\n"
        "influence = {x = [1.0, 1.0]}\n"
        + device_keys(kind, options.sliders, options.width) + records)
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program")
    parser.add_argument("--draws", type=int, default=3)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--noise", type=float, default=3.0)
    parser.add_argument("--sliders", type=int, default=1)
    parser.add_argument("--width", type=int, default=6)
    parser.add_argument("--kinds", default="memory,feed_forward,law")
    parser.add_argument("--keep", help="folder that keeps the cases and results")
    options = parser.parse_args()
    kinds = options.kinds.split(",")
    table = []
    for draw in range(options.first, options.first + options.draws):
        random = np.random.default_rng([7, draw])
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(options.keep or place) / f"draw{draw}"
            folder.mkdir(parents=True, exist_ok=True)
            times = STEP * np.arange(SAMPLES)
            for name, peak in (("one", 4.0), ("two", 6.0), ("unseen", 5.0)):
                ground = earthquake(random, peak)
                truth = simulate(ground)
                spread = np.sqrt(np.mean(truth**2, axis=1, keepdims=True))
                noisy = truth + 0.01 * options.noise * spread * random.standard_normal(
                    truth.shape)
                np.savetxt(folder / f"{name}.csv", np.column_stack([times, ground, noisy.T]),
                           delimiter=",", header="t,ground,a1,a2,d1", comments="")
            row = []
            for kind in kinds:
                case = write_case(folder, kind, options)
                begin = time.monotonic()
                done = subprocess.run(
                    [options.program, f"--case={case}", f"--output_dir={folder / kind}",
                     "--threads=1", "--overwrite"],
                    stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
                seconds = time.monotonic() - begin
                path = folder / kind / "prediction_unseen.csv"
                if not path.is_file():
                    raise SystemExit(f"draw {draw}, {kind}: no result: {done.stderr[-500:]}")
                values = np.genfromtxt(path, delimiter=",", names=True)
                found = np.array([values[name] for name in values.dtype.names
                                  if name.endswith("_predicted")])
                error = 100.0 * np.sqrt(np.mean(np.mean((found - truth) ** 2, axis=1)
                                                / spread[:, 0] ** 2))
                row.append((error, seconds))
                verdict = json.loads((folder / kind / "result.json").read_text())["verdict"]
                print(f"draw {draw}, {kind}: {error:.2f} %, {seconds:.0f} s, {verdict}",
                      flush=True)
            table.append(row)
    medians = np.median(np.array(table), axis=0)
    print("median: " + "; ".join(f"{kind} {error:.2f} %, {seconds:.0f} s"
                                 for kind, (error, seconds) in zip(kinds, medians)))


if __name__ == "__main__":
    main()
