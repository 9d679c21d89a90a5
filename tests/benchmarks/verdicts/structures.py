#!/usr/bin/env python3
"""Random structures with hidden faults: what a user would give to pinode.

    structures.py FOLDER SEED [--faults=none|KIND,KIND|random] [--dofs=5-40]

writes FOLDER/case.toml, FOLDER/record.csv, FOLDER/holdout.csv (of half the
seeds) and FOLDER/truth.json: the values of the user's unknowns, the faults, and
for each fault by how many deviations of noise it changes the record beyond what
the user's unknowns can take over.

A structure is a chain of storeys, half of them with braces across two storeys.
Its model is right but for the user's groups and for the faults.  Responses are
exact for excitations that go straight from sample to sample (exponentials of the
state matrix); with a cubic spring by RK4 at a tenth of the sampling step.
"""

import argparse
import json
import os
import sys

import numpy as np
from scipy import interpolate, linalg, signal

sys.dont_write_bytecode = True

RATE = 100.0
DURATION = 20.0
KINDS = ["damping", "damping_modes", "mass", "all_masses", "stiffness", "gain",
         "upside_down", "delay", "exchange", "excitation_delay",
         "excitation_scale", "clock_rate", "cubic"]


class Structure:
    """Springs between masses; spring (i, j) with i = -1 for the ground."""

    def __init__(self, rng, least, most):
        self.dofs = int(round(least * (most / least)**rng.random()))
        n = self.dofs
        self.mass = rng.uniform(0.6, 1.6, n) * 1000
        self.springs = [(i - 1, i) for i in range(n)]
        self.stiffness = list(rng.uniform(0.7, 1.4, n) * (1.5 - np.arange(n) / n))
        if rng.random() < 0.5:
            for i in range(1, n, max(2, n // 6)):
                self.springs.append((i - 2, i))
                self.stiffness.append(0.3 * rng.uniform(0.7, 1.4))
        self.stiffness = np.array(self.stiffness)
        self.names = [f"u{i + 1}" for i in range(n)]
        self.moves = np.ones(n)  # with the ground; turns do not
        self.parts = n  # springs, from the first, that groups are made of
        self.scale_to(rng)

    def scale_to(self, rng):
        """A first mode, and damping, as structures have them."""
        wanted = 2 * np.pi * rng.uniform(0.6, 3.0)
        first = linalg.eigh(self.matrix(self.stiffness), np.diag(self.mass),
                            eigvals_only=True, subset_by_index=[0, 0])[0]
        self.stiffness *= wanted**2 / first
        self.ratio = rng.uniform(0.008, 0.04)

    def matrix(self, stiffness):
        n = self.dofs
        k = np.zeros((n, n))
        for (i, j), value in zip(self.springs, stiffness):
            k[j, j] += value
            if i >= 0:
                k[i, i] += value
                k[i, j] -= value
                k[j, i] -= value
        return k

    def modes(self):
        squares, shapes = linalg.eigh(self.matrix(self.stiffness),
                                      np.diag(self.mass))
        return np.sqrt(squares), shapes

    def damping(self, factors):
        """One ratio a mode of the model as it is, times a factor a mode."""
        circular, shapes = self.modes()
        left = np.diag(self.mass) @ shapes
        return left @ np.diag(2 * self.ratio * factors * circular) @ left.T

    def rayleigh(self):
        """Coefficients of mass and stiffness for the ratio at modes 1 and 3."""
        w = self.modes()[0][[0, 2]]
        return linalg.solve(np.array([1 / (2 * w), w / 2]).T,
                            [self.ratio, self.ratio])


def foh(a, b, step):
    """Exact step for inputs that are linear between samples."""
    n, m = b.shape
    big = np.zeros((n + 2 * m, n + 2 * m))
    big[:n, :n] = a * step
    big[:n, n:n + m] = b * step
    big[n:n + m, n + m:] = np.eye(m)
    e = linalg.expm(big)
    gamma1, gamma2 = e[:n, n:n + m], e[:n, n + m:]
    return e[:n, :n], gamma1 - gamma2, gamma2


def simulate(m, c, k, load, u, cubic, rate):
    """Displacements, velocities and relative accelerations, from rest.

    load: force per unit of u at each DOF; cubic: (place, coefficient) or None,
    a force coefficient * d^3 of the spring from DOF i to j.
    """
    n = len(m)
    inverse = 1 / m
    a = np.block([[np.zeros((n, n)), np.eye(n)],
                  [-inverse[:, None] * k, -inverse[:, None] * c]])
    b = np.concatenate([np.zeros(n), inverse * load])
    h = np.zeros((len(u), 2 * n))
    if cubic is None:
        phi, g0, g1 = foh(a, b[:, None], 1 / rate)
        for s in range(len(u) - 1):
            h[s + 1] = phi @ h[s] + g0[:, 0] * u[s] + g1[:, 0] * u[s + 1]
        rates = h @ a.T + u[:, None] * b
        return h[:, :n], h[:, n:], rates[:, n:]
    (i, j), coefficient = cubic
    push = np.zeros(2 * n)
    push[n + j] = -coefficient * inverse[j]
    if i >= 0:
        push[n + i] = coefficient * inverse[i]

    def rate_of(state, load_now):
        d = state[j] - (state[i] if i >= 0 else 0.0)
        return a @ state + b * load_now + push * d**3

    parts = 10
    dt = 1 / rate / parts
    rates = np.zeros_like(h)
    state = h[0]
    for s in range(len(u)):
        h[s] = state
        rates[s] = rate_of(state, u[s])
        if s + 1 == len(u):
            break
        for p in range(parts):
            u0, u2 = (u[s] + (u[s + 1] - u[s]) * q / parts for q in (p, p + 1))
            u1 = (u0 + u2) / 2
            r1 = rate_of(state, u0)
            r2 = rate_of(state + dt / 2 * r1, u1)
            r3 = rate_of(state + dt / 2 * r2, u1)
            r4 = rate_of(state + dt * r3, u2)
            state = state + dt / 6 * (r1 + 2 * r2 + 2 * r3 + r4)
    return h[:, :n], h[:, n:], rates[:, n:]


def excitation(rng, samples):
    """A quake-like record: filtered noise with a rise, a plateau and a decay."""
    t = np.arange(samples) / RATE
    sos = signal.butter(2, [0.3, 15.0], "bandpass", fs=RATE, output="sos")
    u = signal.sosfilt(sos, rng.standard_normal(samples))
    length = samples / RATE
    envelope = np.minimum(1, t / (0.1 * length)) * np.exp(
        -np.maximum(0, t - 0.5 * length) / (0.2 * length))
    return u * envelope / np.abs(u * envelope).max()


class Setup:
    """One user's case: structure, loads, sensors, unknowns and faults."""

    make = Structure

    def __init__(self, seed, kinds, dofs):
        rng = self.rng = np.random.default_rng(seed)
        s = self.structure = self.make(rng, *dofs)
        n = s.dofs
        places = np.flatnonzero(s.moves)
        self.ground = rng.random() < 0.6
        self.force_at = int(places[rng.integers(0, len(places))])
        self.quantity = ("absolute_acceleration" if rng.random() < 0.7 else
                         rng.choice(["displacement", "velocity"]))
        groups = int(rng.integers(2, min(s.parts, 8) + 1))
        self.groups = [list(part) for part in
                       np.array_split(np.arange(s.parts), groups)]
        # One group in three is given as right, and is.
        self.free = [bool(rng.random() < 0.7) for _ in self.groups]
        self.free[int(rng.integers(groups))] = True
        count = len(places)
        sensors = count if count <= 8 or rng.random() < 0.4 else int(
            rng.integers(max(3, groups), max(3, groups) + count // 2))
        self.sensors = sorted(rng.choice(places, min(sensors, count),
                                         replace=False))
        self.damping_free = bool(rng.random() < 0.4)
        self.noise = 10**rng.uniform(np.log10(0.003), np.log10(0.05))
        self.alphas = [rng.uniform(-0.25, 0.25) if free else 0.0
                       for free in self.free]
        self.damping_alphas = list(rng.uniform(-0.4, 0.6, 2)
                                   if self.damping_free else [0.0, 0.0])
        self.records = 1 + int(rng.random() < 0.5)
        self.loads = [excitation(rng, int(DURATION * RATE))
                      for _ in range(self.records)]
        self.faults = [self.draw(kind) for kind in kinds]

    def draw(self, kind):
        rng, s = self.rng, self.structure
        sign = 1 if rng.random() < 0.5 else -1
        fault = {"kind": kind, "place": ""}
        if kind == "damping":
            fault["size"] = float(rng.choice([0.5, 0.65, 1.4, 1.8]))
        elif kind == "damping_modes":
            fault["size"] = list(rng.uniform(0.5, 1.8, s.dofs))
        elif kind in ("mass", "cubic"):
            places = np.flatnonzero(s.moves)
            place = int(places[rng.integers(len(places))])
            fault["index"] = place
            fault["place"] = s.names[place]
            fault["size"] = (sign * rng.uniform(0.12, 0.4) if kind == "mass"
                             else rng.uniform(0.1, 0.6))
            if kind == "cubic":
                i, j = s.springs[place]
                fault["place"] = self.between(i, j)
        elif kind == "all_masses":
            fault["size"] = sign * rng.uniform(0.1, 0.4)
        elif kind == "stiffness":
            fixed = [j for g, free in zip(self.groups, self.free) if not free
                     for j in g] + list(range(s.parts, len(s.springs)))
            if not fixed:
                return self.draw("mass")
            index = int(rng.choice(fixed))
            fault["index"] = index
            fault["place"] = self.between(*s.springs[index])
            fault["size"] = -rng.uniform(0.15, 0.6)
        elif kind in ("gain", "upside_down", "delay"):
            c = int(rng.integers(len(self.sensors)))
            fault["index"] = c
            fault["place"] = f"a{self.sensors[c] + 1}"
            fault["size"] = {"gain": sign * rng.uniform(0.1, 0.4),
                             "upside_down": -2.0,
                             "delay": sign * rng.uniform(0.005, 0.04)}[kind]
        elif kind == "exchange":
            c, d = sorted(int(x) for x in
                          rng.choice(len(self.sensors), 2, replace=False))
            fault["index"] = [c, d]
            fault["place"] = ",".join(f"a{self.sensors[x] + 1}" for x in (c, d))
        elif kind == "excitation_delay":
            fault["size"] = sign * rng.uniform(0.01, 0.05)
        elif kind == "excitation_scale":
            fault["size"] = sign * rng.uniform(0.1, 0.4)
        elif kind == "clock_rate":
            fault["size"] = sign * rng.uniform(0.02, 0.2)
        return fault

    @staticmethod
    def between(i, j):
        return f"{'ground' if i < 0 else f'u{i + 1}'}-u{j + 1}"

    def respond(self, alphas, damping_alphas, faults):
        """Channels (rows) of each record, without noise."""
        s = self.structure
        n = s.dofs
        mass, stiffness = s.mass.copy(), s.stiffness.copy()
        for alpha, group in zip(alphas, self.groups):
            stiffness[group] *= 1 + alpha
        factors, cubic = np.ones(n), None
        for f in faults:
            if f["kind"] in ("damping", "damping_modes"):
                factors = factors * np.array(f["size"])
            elif f["kind"] == "mass":
                mass[f["index"]] *= 1 + f["size"]
            elif f["kind"] == "all_masses":
                mass *= 1 + f["size"]
            elif f["kind"] == "stiffness":
                stiffness[f["index"]] *= 1 + f["size"]
            elif f["kind"] == "cubic":
                cubic = f
        if self.damping_free:
            a0, a1 = s.rayleigh()
            a0, a1 = (a * (1 + alpha) for a, alpha in
                      zip((a0, a1), damping_alphas))
            circular, shapes = s.modes()
            left = np.diag(s.mass) @ shapes
            c = left @ np.diag(factors * (a0 + a1 * circular**2)) @ left.T
        else:
            c = s.damping(factors)
        load = (-mass * s.moves if self.ground else
                np.eye(n)[self.force_at] * s.mass.mean())
        k = s.matrix(stiffness)
        records = []
        for u in self.loads:
            spring = None
            if cubic is not None:
                # As large as this share of the linear force at the peak.
                j = cubic["index"]
                i, j2 = s.springs[j]
                if "coefficient" not in cubic:
                    x = simulate(mass, c, k, load, u, None, RATE)[0]
                    d = np.abs(x[:, j2] - (x[:, i] if i >= 0 else 0)).max()
                    cubic["coefficient"] = cubic["size"] * stiffness[j] / d**2
                spring = ((i, j2), cubic["coefficient"])
            rate = RATE
            for f in faults:
                # The logger says RATE and samples at another rate.
                if f["kind"] == "clock_rate":
                    rate = RATE * (1 + f["size"])
            x, v, a = simulate(mass, c, k, load, u, spring, rate)
            if self.quantity == "displacement":
                y = x
            elif self.quantity == "velocity":
                y = v
            else:
                y = a + (u[:, None] * s.moves if self.ground else 0)
            records.append(self.sense(y[:, self.sensors].T.copy(), faults))
        return records

    @staticmethod
    def sense(y, faults):
        def late(row, seconds):
            t = np.arange(len(row)) / RATE
            spline = interpolate.CubicSpline(t, row)
            return spline(np.clip(t - seconds, 0, t[-1]))

        for f in faults:
            c = f.get("index")
            if f["kind"] in ("gain", "upside_down"):
                y[c] *= 1 + f["size"]
            elif f["kind"] == "delay":
                y[c] = late(y[c], f["size"])
            elif f["kind"] == "exchange":
                y[c] = y[c[::-1]]
            elif f["kind"] == "excitation_delay":
                y = np.array([late(row, f["size"]) for row in y])
            elif f["kind"] == "excitation_scale":
                y *= 1 + f["size"]
        return y

    def deviations(self):
        """Of each fault: change of the records in deviations of their noise,
        beyond what a linear change of the user's unknowns does."""
        base = self.respond(self.alphas, self.damping_alphas, [])
        sigma = [np.maximum(y.std(axis=1), 1e-300)[:, None] * self.noise
                 for y in base]

        def flat(records):
            return np.concatenate([(y / e).ravel()
                                   for y, e in zip(records, sigma)])

        zero = flat(base)
        columns = []
        for i, free in enumerate(self.free):
            if free:
                alphas = list(self.alphas)
                alphas[i] += 1e-4
                columns.append(flat(self.respond(alphas, self.damping_alphas,
                                                 [])) - zero)
        for i in range(2 if self.damping_free else 0):
            alphas = list(self.damping_alphas)
            alphas[i] += 1e-4
            columns.append(flat(self.respond(self.alphas, alphas, [])) - zero)
        q = linalg.orth(np.array([c / np.linalg.norm(c) for c in columns]).T)
        sizes = []
        for f in self.faults:
            change = flat(self.respond(self.alphas, self.damping_alphas,
                                       [f])) - zero
            sizes.append(float(np.linalg.norm(change - q @ (q.T @ change))))
        return sizes

    def write(self, folder):
        os.makedirs(folder, exist_ok=True)
        records = self.respond(self.alphas, self.damping_alphas, self.faults)
        for name, u, y in zip(("record", "holdout"), self.loads, records):
            y = y + self.noise * y.std(axis=1)[:, None] * \
                self.rng.standard_normal(y.shape)
            header = ["t", "u"] + [f"a{j + 1}" for j in self.sensors]
            table = np.column_stack([np.arange(len(u)) / RATE, u, y.T])
            np.savetxt(os.path.join(folder, name + ".csv"), table,
                       delimiter=",", header=",".join(header), comments="",
                       fmt="%.9g")
        with open(os.path.join(folder, "case.toml"), "w",
                  encoding="utf-8") as file:
            file.write(self.case())
        for name, k in self.matrices():
            np.savetxt(os.path.join(folder, name), k, delimiter=",",
                       fmt="%.17g")
        with open(os.path.join(folder, "truth.json"), "w",
                  encoding="utf-8") as file:
            json.dump(self.truth(), file, indent=1)

    def matrices(self):
        s = self.structure
        yield "K.csv", s.matrix(s.stiffness)
        for i, group in enumerate(self.groups):
            part = np.zeros(len(s.stiffness))
            part[group] = s.stiffness[group]
            yield f"K{i + 1}.csv", s.matrix(part)

    def case(self):
        s = self.structure
        lines = ["[model]",
                 "mass = {diagonal = [" +
                 ", ".join(f"{m:.17g}" for m in s.mass) + "]}",
                 'stiffness = "K.csv"',
                 "dofs = [" + ", ".join(f'"{name}"' for name in s.names) + "]"]
        if not s.moves.all():
            lines.append("influence = {x = [" +
                         ", ".join(f"{m:g}" for m in s.moves) + "]}")
        if self.damping_free:
            a0, a1 = s.rayleigh()
            lines.append(f"damping = {{rayleigh = [{a0:.17g}, {a1:.17g}]}}")
        else:
            lines.append(f"damping = {{ratios = [{s.ratio:.17g}]}}")
        for i, free in enumerate(self.free):
            if free:
                lines += ["[[group]]", f'name = "k{i + 1}"',
                          'adds_to = "stiffness"', f'matrix = "K{i + 1}.csv"']
        if self.damping_free:
            for name, to, a in zip(("c_mass", "c_stiffness"),
                                   ("mass", "stiffness"), s.rayleigh()):
                lines += ["[[group]]", f'name = "{name}"',
                          'adds_to = "damping"', f'proportional_to = "{to}"',
                          f"scale = {a:.17g}"]
        unit = {"displacement": "m", "velocity": "m/s"}.get(self.quantity,
                                                            "m/s^2")
        for name, role in zip(("record", "holdout"),
                              ("train", "holdout")[:self.records]):
            lines += ["[[record]]", f'name = "{name}"', f'role = "{role}"',
                      f'file = "{name}.csv"', 'time = "t"', 'start = "rest"',
                      'interpolation = "linear"']
            if self.ground:
                lines += ["[[record.ground]]", 'direction = "x"',
                          'column = "u"', 'unit = "m/s^2"']
            else:
                lines += ["[[record.force]]", f'dof = "{s.names[self.force_at]}"',
                          'column = "u"', 'unit = "N"',
                          f"scale = {s.mass.mean():.17g}"]
            for j in self.sensors:
                lines += ["[[record.channel]]", f'column = "a{j + 1}"',
                          f'quantity = "{self.quantity}"',
                          f'dof = "{s.names[j]}"',
                          f'unit = "{unit}"']
        return "\n".join(lines) + "\n"

    def truth(self):
        values = {f"k{i + 1}": alpha for i, (alpha, free) in
                  enumerate(zip(self.alphas, self.free)) if free}
        # Factors on the damping leave no truth of its free parts.
        if self.damping_free and not any(
                f["kind"].startswith("damping") for f in self.faults):
            values["c_mass"], values["c_stiffness"] = self.damping_alphas
        faults = [dict(f, deviations=d)
                  for f, d in zip(self.faults, self.deviations())]
        return {"dofs": self.structure.dofs, "sensors": len(self.sensors),
                "ground": self.ground, "quantity": self.quantity,
                "noise": self.noise, "damping_free": self.damping_free,
                "holdout": self.records > 1, "values": values,
                "faults": faults}


def draw_kinds(rng):
    """A quarter with nothing wrong, else one to three faults."""
    if rng.random() < 0.25:
        return []
    count = int(rng.choice([1, 2, 3], p=[0.6, 0.25, 0.15]))
    return list(rng.choice(KINDS, count, replace=False))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("seed", type=int)
    parser.add_argument("--faults", default="random")
    parser.add_argument("--dofs", default="5-40")
    args = parser.parse_args()
    if args.faults == "random":
        kinds = draw_kinds(np.random.default_rng([args.seed, 1]))
    else:
        kinds = [k for k in args.faults.split(",") if k != "none"]
    dofs = tuple(int(x) for x in args.dofs.split("-"))
    Setup(args.seed, kinds, dofs).write(args.folder)


if __name__ == "__main__":
    main()
