#!/usr/bin/env python3
"""Random structures under measured loads, identified by pinode_modes.

Structures and sensors are those of modes_decays.py. One to three forces are
measured. They are white noise, sweeps, series of hammer blows, or few sines.
Forces and responses are sums of sines, exact to rounding: the forces have no
content above 0.9 of half the sampling rate, and start from rest. Noise of the
sensors is white. In a fifth of the records another force acts that is not
measured.

invented  a listed mode that no mode of the structure explains
twice     a listed mode beside a more similar one of the same true mode
missed    a mode of the structure above the noise that is not listed, of
          records without an unmeasured force: the energy that it alone explains
          is 25 times the noise variance or more for each of its unknowns.
          Anything that the forces explain without poles is explained so.
held      95 % intervals that hold the truth, over modes above the noise
"""

import argparse
import json
import os
import subprocess

import numpy as np
import scipy.linalg

from modes_decays import CLEAR, FEWEST_CYCLES, QUANTITIES, score, structure

LEVELS = [1e-12, 1e-6, 1e-3, 1e-2, 1e-1]
KINDS = ["white", "sweep", "hammer", "sines"]
TOP = 0.9  # highest content of a force over half the sampling rate
FEWEST_LOAD_CYCLES = 50.0
TAPS = 16  # samples around, by which a force acts without a pole


def force(rng, kind, samples, step, band):
    """A force, and its spectrum over twice its length."""
    t = step * np.arange(samples)
    if kind == "white":
        u = rng.standard_normal(samples)
    elif kind == "sweep":
        passes = rng.integers(1, 5)
        phase = (t * passes / t[-1]) % 1.0 * t[-1] / passes
        first, last = 0.5 * band[0], min(1.3 * band[1], 0.45 / step)
        rate = np.log(last / first) / (t[-1] / passes)
        u = np.sin(2 * np.pi * first * np.expm1(rate * phase) / rate +
                   rng.uniform(0, 6))
    elif kind == "hammer":
        u = np.zeros(samples)
        width = rng.uniform(1.5, 4.0)
        for at in np.sort(rng.uniform(0, 0.97 * samples, rng.integers(5, 40))):
            blow = np.abs(np.arange(samples) - at) / width
            u += rng.uniform(0.5, 1.5) * np.where(
                blow < 1, np.cos(0.5 * np.pi * blow), 0.0)
    else:
        u = sum(rng.uniform(0.3, 1.0) *
                np.sin(2 * np.pi * rng.uniform(0.5 * band[0], band[1]) * t +
                       rng.uniform(0, 6))
                for _ in range(rng.integers(2, 6)))
    spectrum = np.fft.rfft(u, 2 * samples)
    spectrum[np.arange(samples + 1) >= TOP * samples] = 0.0
    return np.fft.irfft(spectrum)[:samples], spectrum


def forced(s, spectrum, samples, step):
    """Response of x' = s x + u from rest, with the force of the spectrum."""
    w = 2 * np.pi * np.fft.rfftfreq(2 * samples, step)
    gain = spectrum / (1j * w - s)
    # Positive and negative frequencies: x is complex.
    full = np.zeros(2 * samples, complex)
    full[:samples + 1] = gain
    full[samples + 1:] = (np.conj(spectrum[1:samples]) /
                          (-1j * w[1:samples] - s))[::-1]
    x = np.fft.ifft(full)[:samples]
    return x - x[0] * np.exp(s * step * np.arange(samples))


def responses(s, vectors, left, places, spectra, samples, step):
    """Modal responses, modes x samples, to forces at `places`."""
    q = np.zeros((len(s), samples), complex)
    for place, spectrum in zip(places, spectra):
        for i, pole in enumerate(s):
            q[i] += left[i, place] * forced(pole, spectrum, samples, step)
    return q


def energies_of(y_modes, columns, others, sigma):
    """Energy that each mode alone explains over what its unknowns take."""
    q = np.linalg.qr(others)[0]
    free = [c - q @ (q.T @ c) for c in columns]
    every = np.concatenate(free, axis=1)
    result = []
    for i, y in enumerate(y_modes):
        start = sum(c.shape[1] for c in columns[:i])
        rest = np.delete(every, np.s_[start:start + columns[i].shape[1]], axis=1)
        rest = np.concatenate([others, rest], axis=1)
        u, sizes, _ = np.linalg.svd(rest / np.maximum(
            np.linalg.norm(rest, axis=0), 1e-300), full_matrices=False)
        u = u[:, sizes > 1e-13 * sizes[0]]
        left = y - (y @ u) @ u.T
        left = left - (left @ u) @ u.T
        unknowns = columns[i].shape[1] * len(y) + 2
        result.append((left**2 / sigma[:, None]**2).sum() / unknowns)
    return np.array(result)


def forced_record(rng, masses, noise, kind):
    """A record and its truth, as those of decays in modes_decays.py."""
    m, c, k = structure(rng, masses)
    a = np.block([[np.zeros((masses, masses)), np.eye(masses)],
                  [-np.linalg.solve(m, k), -np.linalg.solve(m, c)]])
    s, vectors = scipy.linalg.eig(a)
    order = np.argsort(np.abs(s))
    s, vectors = s[order], vectors[:, order]
    left = np.linalg.inv(vectors)[:, masses:] / np.diag(m)  # of forces
    places = rng.choice(masses, min(masses, rng.integers(1, 4)), replace=False)
    sensors = np.sort(rng.choice(masses, rng.integers(
        max(1, (masses + 2) // 3), masses + 1), replace=False))
    quantities = rng.integers(0, 3, len(sensors))
    if rng.random() < 0.7:
        quantities[:] = rng.choice([0, 2, 2])
    highest = np.abs(s).max() / 2 / np.pi
    lowest = np.abs(s).min() / 2 / np.pi
    step = 0.5 / highest / rng.uniform(1.25, 3.5)
    samples = int(np.clip(rng.uniform(60, 200) / lowest / step, 5000, 20000))
    us, spectra = zip(*[force(rng, kind, samples, step, (lowest, highest))
                        for _ in places])
    up = s.imag > 0
    real = s.imag == 0
    rows = vectors[sensors]

    def motion(some, q):
        # Accelerations from displacements: the force's own part is s^2 - ...
        y = np.zeros((len(sensors), samples))
        for i, derivative in enumerate(quantities):
            part = rows[i, some, None] * s[some, None]**derivative * q
            y[i] = np.where(s[some].imag > 0, 2.0, 1.0) @ part.real
        return y

    def through(i, derivative, place_list, u_list):
        """Part of an acceleration that follows the forces at once."""
        y = np.zeros(samples)
        if derivative == 2:
            for place, u in zip(place_list, u_list):
                if place == sensors[i]:
                    y += u / m[place, place]
        return y

    keep = up | real
    q = responses(s[keep], vectors, left[keep], places, spectra, samples, step)
    y = motion(keep, q)
    for i, derivative in enumerate(quantities):
        y[i] += through(i, derivative, places, us)
    each = [motion(np.flatnonzero(keep)[[n]], q[[n]])
            for n in range(len(q)) if s[keep][n].imag > 0]
    wind = bool(rng.random() < 0.2)
    if wind:
        place = rng.integers(masses)
        u, spectrum = force(rng, "white", samples, step, (lowest, highest))
        size = 10**rng.uniform(-2, 0) * us[0].std() / u.std()
        more = motion(keep, responses(s[keep], vectors, left[keep], [place],
                                      [spectrum * size], samples, step))
        for i, derivative in enumerate(quantities):
            more[i] += through(i, derivative, [place], [u * size])
        y = y + more
    sigma = noise * y.std(axis=1)
    t = step * np.arange(samples)
    columns = []
    for pole in s[up]:
        parts = [np.exp(pole * t)] + [forced(pole, spectrum, samples, step)
                                      for spectrum in spectra]
        columns.append(np.stack([f(p) for p in parts
                                 for f in (np.real, np.imag)], axis=1))
    others = [np.ones(samples)]
    for u in us:
        padded = np.pad(u, TAPS)
        others += [padded[j:j + samples] for j in range(2 * TAPS + 1)]
    inner = slice(TAPS, samples - TAPS)
    energies = energies_of([one[:, inner] for one in each],
                           [one[inner] for one in columns],
                           np.stack(others, axis=1)[inner],
                           np.maximum(sigma, 1e-13 * y.std(axis=1)))
    if wind:
        energies[:] = 0.0
    y = y + sigma[:, None] * rng.standard_normal(y.shape)
    return {"t": t, "y": y, "u": np.array(us), "s": s[up],
            "quantities": quantities, "shapes": rows[:, up], "wind": wind,
            "bounds": np.ones(int(up.sum())), "energies": energies,
            "step": step, "places": places,
            # Modes are looked for from so many cycles on.
            "duration": samples * step * FEWEST_CYCLES / FEWEST_LOAD_CYCLES}


def write(folder, record):
    os.makedirs(folder, exist_ok=True)
    outputs = [f"y{i + 1}" for i in range(len(record["y"]))]
    forces = [f"u{i + 1}" for i in range(len(record["u"]))]
    np.savetxt(os.path.join(folder, "loads.csv"),
               np.column_stack([record["t"], record["u"].T, record["y"].T]),
               fmt="%.17g", delimiter=",", comments="",
               header=",".join(["t"] + forces + outputs))
    units = ["m", "m/s", "m/s^2"]
    lines = ["[[record]]", 'name = "loads"', 'file = "loads.csv"', 'time = "t"',
             'interpolation = "band_limited"']
    for name in forces:
        lines += ["  [[record.force]]", f'  dof = "{name}"',
                  f'  column = "{name}"', '  unit = "N"']
    for name, quantity in zip(outputs, record["quantities"]):
        lines += ["  [[record.channel]]", f'  column = "{name}"',
                  f'  name = "{name}"', f'  quantity = "{QUANTITIES[quantity]}"',
                  f'  unit = "{units[quantity]}"']
    with open(os.path.join(folder, "case.toml"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


def identify(program, folder):
    run = subprocess.run(
        [program, f"--case={folder}/case.toml", f"--output_dir={folder}/out",
         "--overwrite"], capture_output=True, text=True, check=False)
    path = folder + "/out/modes.json"
    if run.returncode or not os.path.exists(path):
        return None, run.stderr.strip()
    with open(path, encoding="utf-8") as file:
        return json.load(file)["modes"], ""


def summarise(name, some):
    def total(what):
        return sum(one[what] for one in some)

    count = max(1, total("intervals"))
    held = [100 * sum(one["held"][q] for one in some) / count for q in range(2)]
    print(f"{name:8} {len(some):7} {total('modes'):5} {total('invented'):8} "
          f"{total('twice'):5} {total('missed'):6}  {held[0]:15.1f} "
          f"{held[1]:7.1f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", required=True)
    parser.add_argument("--records", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, help="number of one record")
    options = parser.parse_args()
    results = []
    for number in range(options.records):
        if options.only is not None and number != options.only:
            continue
        rng = np.random.default_rng([options.seed, number])
        level = LEVELS[number % len(LEVELS)]
        kind = KINDS[number // len(LEVELS) % len(KINDS)]
        record = forced_record(rng, int(rng.integers(1, 13)), level, kind)
        folder = os.path.join(options.work, f"loads{number}")
        write(folder, record)
        modes, error = identify(options.program, folder)
        if modes is None:
            print(f"record {number}: {error}")
            modes = []
        result = score(record, modes)
        results.append((level, kind, result))
        if result["invented"] + result["twice"] + result["missed"]:
            print(f"record {number}: {kind}, noise {level:g}, "
                  f"{len(record['s'])} modes, {len(record['u'])} forces"
                  f"{' and wind' if record['wind'] else ''}, "
                  f"{len(record['y'])} channels; asked {result['modes']}, "
                  f"listed {len(modes)}, invented {result['invented']}, twice "
                  f"{result['twice']}, missed {result['missed']}")
    print("         records modes invented twice missed  held: frequency damping")
    for level in LEVELS:
        summarise(f"{level:g}", [r for l, _, r in results if l == level])
    for kind in KINDS:
        summarise(kind, [r for _, k, r in results if k == kind])
    summarise("all", [r for _, _, r in results])


if __name__ == "__main__":
    main()
