#!/usr/bin/env python3
"""Free decays of random structures, identified by pinode_modes.

A structure is a chain of 1 to 12 random masses with random springs, often with
springs across it. Damping is modal, or comes from random dashpots. Random
sensors measure displacements, velocities or accelerations after a blow or from
a random state. The decay is a sum of exponentials of the eigenvalues (SciPy),
exact to rounding. Noise is white.

invented  a listed mode that no mode of the structure explains
twice     a listed mode beside a more similar one of the same true mode
missed    a mode of the structure above the noise that is not listed: the
          energy that it alone explains is 25 times the noise variance or more
          for each of its unknowns (amplitudes, frequency and damping ratio)
held      95 % intervals that hold the truth, over modes above the noise
bound     the standard deviation of the frequency over the Cramer-Rao bound of
          the record: median and smallest over the same modes
"""

import argparse
import json
import os
import subprocess

import numpy as np
import scipy.linalg

LEVELS = [1e-12, 1e-9, 1e-7, 1e-5, 1e-3, 1e-2, 3e-2, 1e-1]
QUANTITIES = ["displacement", "velocity", "relative_acceleration"]
CLEAR = 25.0  # energy per unknown over the variance of the noise
LARGEST_DAMPING = 0.15
FEWEST_CYCLES = 5.0


def structure(rng, masses):
    """Mass, damping and stiffness matrices."""
    m = np.diag(rng.lognormal(0.0, 0.4, masses))
    k = np.zeros((masses, masses))
    for i in range(masses):
        spring = rng.lognormal(0.0, 0.5)
        k[i, i] += spring
        if i:
            k[i - 1, i - 1] += spring
            k[i - 1, i] -= spring
            k[i, i - 1] -= spring
    for _ in range(rng.integers(0, masses)):
        i, j = rng.choice(masses, 2, replace=False)
        spring = rng.lognormal(-1.0, 0.5)
        k[[i, j], [i, j]] += spring
        k[[i, j], [j, i]] -= spring
    # The lowest frequency between 0.5 and 20 Hz.
    values, shapes = scipy.linalg.eigh(k, m)
    k *= (2 * np.pi * 10**rng.uniform(-0.3, 1.3))**2 / values[0]
    natural = np.sqrt(scipy.linalg.eigh(k, m, eigvals_only=True))
    if rng.random() < 0.6:
        ratios = rng.uniform(0.002, 0.03, masses)
        left = m @ shapes  # mass-normalised
        c = left @ np.diag(2 * ratios * natural) @ left.T
    else:
        # Stiffness-proportional, with two dashpots of random size.
        c = k * 2 * rng.uniform(0.003, 0.02) / natural[masses // 2]
        for i in rng.choice(masses, 2):
            c[i, i] += 2 * rng.uniform(0.0, 0.03) * natural[0] * m[i, i]
    return m, c, k


def bounds(t, s, rows, sigma):
    """Cramer-Rao bounds of the frequencies in Hz: amplitudes eliminated."""
    e = np.exp(s[:, None] * t).T
    q = np.linalg.qr(np.concatenate([e.real, e.imag], axis=1))[0]
    slopes = np.concatenate([(t[:, None] * e).real, (t[:, None] * e).imag],
                            axis=1)
    outside = slopes - q @ (q.T @ slopes)
    gram = outside.T @ outside
    count = len(s)
    fisher = np.zeros((2 * count, 2 * count))
    for row, deviation in zip(2 * rows, sigma):
        # Columns: by Re s and by Im s.
        u = np.block([[np.diag(row.real), np.diag(-row.imag)],
                      [np.diag(-row.imag), np.diag(-row.real)]])
        fisher += u.T @ gram @ u / deviation**2
    scale = 1 / np.sqrt(np.diag(fisher))
    covariance = scale[:, None] * np.linalg.inv(
        scale[:, None] * fisher * scale) * scale
    size = np.abs(s)
    slope = np.concatenate([np.diag(s.real / size), np.diag(s.imag / size)],
                           axis=1) / (2 * np.pi)
    return np.sqrt(np.einsum("ij,jk,ik->i", slope, covariance, slope))


def decay(rng, masses, noise):
    """A record and its truth: poles, shapes of displacements, and the energy of
    each mode over what its unknowns take of the noise."""
    m, c, k = structure(rng, masses)
    a = np.block([[np.zeros((masses, masses)), np.eye(masses)],
                  [-np.linalg.solve(m, k), -np.linalg.solve(m, c)]])
    s, vectors = scipy.linalg.eig(a)
    speed = rng.standard_normal(masses)
    place = np.zeros(masses)
    if rng.random() < 0.5:
        speed = np.zeros(masses)
        speed[rng.integers(masses)] = 1.0
    else:
        place = rng.standard_normal(masses) / np.abs(s).min()
    amplitudes = vectors * np.linalg.solve(vectors, np.r_[place, speed])
    order = np.argsort(np.abs(s))
    s, amplitudes = s[order], amplitudes[:, order]
    up = s.imag > 0
    sensors = np.sort(rng.choice(masses, rng.integers(
        max(1, (masses + 2) // 3), masses + 1), replace=False))
    quantities = rng.integers(0, 3, len(sensors))
    if rng.random() < 0.6:
        quantities[:] = 2
    highest = np.abs(s[up]).max() / 2 / np.pi
    lowest = np.abs(s[up]).min() / 2 / np.pi
    step = 0.5 / highest / rng.uniform(1.25, 3.5)
    samples = int(np.clip(rng.uniform(20, 80) / lowest / step, 800, 8000))
    t = step * np.arange(samples)
    rows = amplitudes[sensors] * s[None, :]**quantities[:, None]
    y = (rows @ np.exp(s[:, None] * t)).real
    sigma = noise * y.std(axis=1)
    basis = np.exp(s[up][:, None] * t).T
    basis = np.concatenate([basis.real, basis.imag], axis=1)
    r = np.linalg.qr(basis, mode="r")
    scatter = np.linalg.inv(r)
    scatter = scatter @ scatter.T
    energies = []
    count = int(up.sum())
    for i, row in enumerate(2 * rows[:, up].T):
        part = np.stack([row.real, -row.imag])
        own = scatter[np.ix_([i, count + i], [i, count + i])]
        energy = np.einsum("ac,ab,bc->c", part, np.linalg.inv(own), part)
        energies.append((energy / sigma**2).sum() / (2 * len(sensors) + 2))
    y = y + sigma[:, None] * rng.standard_normal(y.shape)
    return {"t": t, "y": y, "s": s[up], "quantities": quantities,
            "shapes": rows[:, up] / s[up]**quantities[:, None],
            "bounds": bounds(t, s[up], rows[:, up], sigma),
            "energies": np.array(energies), "duration": samples * step,
            "step": step}


def write(folder, record):
    os.makedirs(folder, exist_ok=True)
    names = [f"y{i + 1}" for i in range(len(record["y"]))]
    np.savetxt(os.path.join(folder, "decay.csv"),
               np.column_stack([record["t"], record["y"].T]), fmt="%.17g",
               delimiter=",", comments="", header=",".join(["t"] + names))
    units = ["m", "m/s", "m/s^2"]
    lines = ["[[record]]", 'name = "decay"', 'file = "decay.csv"',
             'time = "t"', 'excitation = "none"']
    for name, quantity in zip(names, record["quantities"]):
        lines += ["  [[record.channel]]", f'  column = "{name}"',
                  f'  name = "{name}"',
                  f'  quantity = "{QUANTITIES[quantity]}"',
                  f'  unit = "{units[quantity]}"']
    with open(os.path.join(folder, "case.toml"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


def mac(a, b):
    return np.abs(np.vdot(a, b))**2 / (np.vdot(a, a).real * np.vdot(b, b).real)


def score(record, modes):
    """Counts of one record."""
    s = record["s"]
    hertz, ratios = np.abs(s) / 2 / np.pi, -s.real / np.abs(s)
    asked = ((record["energies"] >= CLEAR) & (ratios < LARGEST_DAMPING) &
             (hertz > 1.05 * FEWEST_CYCLES / record["duration"]))
    pairs = []
    for j, mode in enumerate(modes):
        shape = np.array([complex(one["real"], one["imaginary"])
                          for one in mode["shape"]])
        for i in range(len(s)):
            off = np.hypot(mode["frequency_hz"] / hertz[i] - 1,
                           mode["damping_ratio"] - ratios[i])
            near = 0.005 + ratios[i] + 5 * np.hypot(
                mode["frequency_sigma"] / hertz[i], mode["damping_sigma"])
            if off < near:
                pairs.append((off + 0.01 * (1 - mac(shape, record["shapes"][:, i])),
                              j, i))
    partner = {}
    for _, j, i in sorted(pairs):
        if j not in partner and i not in partner.values():
            partner[j] = i
    near = {j for _, j, _ in pairs}
    alone = [j for j in range(len(modes)) if j not in partner]
    result = {"modes": int(asked.sum()),
              "invented": sum(j not in near for j in alone),
              "twice": sum(j in near for j in alone),
              "missed": int(sum(asked[i] and i not in partner.values()
                                for i in range(len(s)))),
              "held": [0, 0], "intervals": 0, "squares": [0.0, 0.0],
              "over": []}
    for j, i in partner.items():
        if not asked[i]:
            continue
        result["intervals"] += 1
        result["over"].append(modes[j]["frequency_sigma"] /
                              record["bounds"][i])
        for q, (name, truth) in enumerate([("frequency", hertz[i]),
                                           ("damping", ratios[i])]):
            result["held"][q] += (modes[j][name + "_lower95"] <= truth <=
                                  modes[j][name + "_upper95"])
            value = modes[j]["frequency_hz" if q == 0 else "damping_ratio"]
            result["squares"][q] += min(
                100.0, abs(value - truth) / max(modes[j][name + "_sigma"],
                                                1e-300))**2
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", required=True)
    parser.add_argument("--decays", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, help="number of one decay")
    options = parser.parse_args()
    results = {level: [] for level in LEVELS}
    for number in range(options.decays):
        if options.only is not None and number != options.only:
            continue
        rng = np.random.default_rng([options.seed, number])
        level = LEVELS[number % len(LEVELS)]
        record = decay(rng, int(rng.integers(1, 13)), level)
        folder = os.path.join(options.work, f"decay{number}")
        write(folder, record)
        run = subprocess.run(
            [options.program, f"--case={folder}/case.toml",
             f"--output_dir={folder}/out", "--overwrite"],
            capture_output=True, text=True, check=False)
        if not os.path.exists(folder + "/out/modes.json"):
            print(f"decay {number}: {run.stderr.strip()}")
            modes = []
        else:
            with open(folder + "/out/modes.json", encoding="utf-8") as file:
                modes = json.load(file)["modes"]
        result = score(record, modes)
        results[level].append(result)
        if result["invented"] + result["twice"] + result["missed"]:
            print(f"decay {number}: noise {level:g}, {len(record['s'])} modes, "
                  f"{len(record['y'])} channels; asked {result['modes']}, listed "
                  f"{len(modes)}, invented {result['invented']}, twice "
                  f"{result['twice']}, missed {result['missed']}")
    print("noise    records modes invented twice missed  held: frequency damping"
          "  rms error in deviations  bound: median smallest")
    for level in LEVELS + ["all"]:
        some = (results[level] if level != "all" else
                [one for part in results.values() for one in part])
        if not some:
            continue

        def total(name):
            return sum(one[name] for one in some)

        count = max(1, total("intervals"))
        held = [100 * sum(one["held"][q] for one in some) / count
                for q in range(2)]
        rms = [np.sqrt(sum(one["squares"][q] for one in some) / count)
               for q in range(2)]
        over = sum((one["over"] for one in some), []) or [np.nan]
        print(f"{level!s:8} {len(some):7} {total('modes'):5} "
              f"{total('invented'):8} {total('twice'):5} {total('missed'):6}  "
              f"{held[0]:15.1f} {held[1]:7.1f}  {rms[0]:8.2f} {rms[1]:5.2f}  "
              f"{np.median(over):19.2f} {np.min(over):8.2f}")


if __name__ == "__main__":
    main()
