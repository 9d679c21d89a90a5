"""Data and scores of damage_sizes.sh; NumPy and SciPy.

beam: a beam of ten elements, simply supported or clamped at one end, whose
elements differ from the model by 10 % (standard deviation), as the case says.
Its five lowest frequencies are measured with a deviation of 0.05 %, once
healthy and once after one element has lost stiffness.

frame: a shear frame of four storeys under measured ground motion with two
accelerometers, 50 % noise, 20 s at 100 Hz. Its storeys differ from the model by
10 %, the case gives no prior; damping is Rayleigh damping as in the model. One
storey loses stiffness.

The losses are 5, 10, 20, 35 and 50 %, one after the other by seed.

  damage_sizes.py make KIND SEED FOLDER
  damage_sizes.py score FOLDER...
"""

import json
import pathlib
import sys

import numpy as np
import scipy.linalg
import scipy.signal

LOSSES = (0.05, 0.10, 0.20, 0.35, 0.50)


def beam_matrices(clamped, elements=10):
    """Hermite elements of a beam of length 1 m, without its supports."""
    length = 1.0 / elements
    bending = 2.1e11 * 8.3333e-10 / length**3
    mass = 7850.0 * 1e-4 * length / 420.0
    k = bending * np.array([
        [12, 6 * length, -12, 6 * length],
        [6 * length, 4 * length**2, -6 * length, 2 * length**2],
        [-12, -6 * length, 12, -6 * length],
        [6 * length, 2 * length**2, -6 * length, 4 * length**2]])
    m = mass * np.array([
        [156, 22 * length, 54, -13 * length],
        [22 * length, 4 * length**2, 13 * length, -3 * length**2],
        [54, 13 * length, 156, -22 * length],
        [-13 * length, -3 * length**2, -22 * length, 4 * length**2]])
    size = 2 * (elements + 1)
    fixed = (0, 1) if clamped else (0, size - 2)
    keep = [i for i in range(size) if i not in fixed]
    total = np.zeros((size, size))
    parts = []
    for e in range(elements):
        part = np.zeros((size, size))
        part[2 * e:2 * e + 4, 2 * e:2 * e + 4] = k
        parts.append(part[np.ix_(keep, keep)])
        total[2 * e:2 * e + 4, 2 * e:2 * e + 4] += m
    return parts, total[np.ix_(keep, keep)]


def make_beam(clamped, seed, folder):
    rng = np.random.default_rng(seed)
    parts, mass = beam_matrices(clamped)
    count = len(parts)
    sigma = 5e-4
    healthy = 1.0 + 0.1 * rng.standard_normal(count)
    place = int(rng.integers(count))
    loss = LOSSES[seed % len(LOSSES)]
    damaged = healthy.copy()
    damaged[place] *= 1.0 - loss
    size = len(mass)
    names = [f'"q{i + 1}"' for i in range(size)]
    np.savetxt(folder / "M.csv", mass, delimiter=",", fmt="%.17g")
    np.savetxt(folder / "K.csv", sum(parts), delimiter=",", fmt="%.17g")
    model = (f"[model]\ndofs = [{', '.join(names)}]\n"
             'mass = "M.csv"\nstiffness = "K.csv"\n')
    for e, part in enumerate(parts):
        np.savetxt(folder / f"K{e + 1}.csv", part, delimiter=",", fmt="%.17g")
        model += (f'[[group]]\nname = "e{e + 1}"\nadds_to = "stiffness"\n'
                  f'matrix = "K{e + 1}.csv"\nprior_sigma = 0.1\n')
    for name, factors in (("healthy", healthy), ("damaged", damaged)):
        stiffness = sum(f * part for f, part in zip(factors, parts))
        values = scipy.linalg.eigh(stiffness, mass, eigvals_only=True)[:5]
        frequencies = np.sqrt(values) / (2.0 * np.pi)
        frequencies *= 1.0 + sigma * rng.standard_normal(5)
        text = model
        for f in frequencies:
            text += (f"[[mode]]\nfrequency = {f:.9g}\n"
                     f"frequency_sigma = {sigma * f:.6g}\n")
        (folder / f"{name}.toml").write_text(text)
    return f"e{place + 1}", loss


def respond(stiffness, ground, step):
    """Absolute accelerations of a chain of unit masses of 1000 kg."""
    count = len(stiffness)
    k = np.zeros((count, count))
    for j, value in enumerate(stiffness):
        k[j, j] += value
        if j > 0:
            k[j - 1, j - 1] += value
            k[j, j - 1] -= value
            k[j - 1, j] -= value
    m = 1000.0 * np.eye(count)
    # Rayleigh damping of the model, which has 1e6 N/m in every storey.
    c = 0.3 * m + 3e-4 * respond.nominal
    inverse = np.linalg.inv(m)
    a = np.block([[np.zeros((count, count)), np.eye(count)],
                  [-inverse @ k, -inverse @ c]])
    b = np.concatenate([np.zeros(count), -np.ones(count)])[:, None]
    out = np.hstack([-inverse @ k, -inverse @ c])
    # The ground acceleration is linear between samples.
    system = scipy.signal.StateSpace(a, b, out, np.zeros((count, 1)))
    times = step * np.arange(len(ground))
    _, y, _ = scipy.signal.lsim(system, ground, times, interp=True)
    return y


def nominal(count):
    k = np.zeros((count, count))
    for j in range(count):
        k[j, j] += 1e6
        if j > 0:
            k[j - 1, j - 1] += 1e6
            k[j, j - 1] -= 1e6
            k[j - 1, j] -= 1e6
    return k


def make_frame(seed, folder):
    rng = np.random.default_rng(seed)
    count, step, samples = 4, 0.01, 2000
    respond.nominal = nominal(count)
    healthy = 1e6 * (1.0 + 0.1 * rng.standard_normal(count))
    place = int(rng.integers(count))
    loss = LOSSES[seed % len(LOSSES)]
    damaged = healthy.copy()
    damaged[place] *= 1.0 - loss
    np.savetxt(folder / "C.csv", 0.3 * 1000.0 * np.eye(count)
               + 3e-4 * respond.nominal, delimiter=",", fmt="%.17g")
    case = ("[model]\ndamping = \"C.csv\"\n[model.shear_building]\n"
            f"masses = [{', '.join(['1000'] * count)}]\n"
            f"stiffnesses = [{', '.join(['1e6'] * count)}]\n")
    for j in range(count):
        case += (f'[[group]]\nname = "k{j + 1}"\nadds_to = "stiffness"\n'
                 f"storey = {j + 1}\n")
    for name, stiffness in (("healthy", healthy), ("damaged", damaged)):
        b, a = scipy.signal.butter(2, (0.5, 20.0), "band", fs=1.0 / step)
        ground = scipy.signal.lfilter(b, a, rng.standard_normal(samples))
        ground[0] = 0.0
        y = respond(stiffness, ground, step)
        y += 0.5 * y.std(axis=0) * rng.standard_normal(y.shape)
        columns = ["t", "ground"] + [f"a{j + 1}" for j in range(count)]
        np.savetxt(folder / f"{name}.csv",
                   np.column_stack([step * np.arange(samples), ground, y]),
                   delimiter=",", fmt="%.12g", header=",".join(columns),
                   comments="")
        channels = ", ".join(
            f'{{column = "a{j + 1}", quantity = "absolute_acceleration", '
            f'dof = "u{j + 1}", unit = "m/s^2"}}' for j in (0, 1, 3))
        (folder / f"{name}.toml").write_text(
            case + f'[[record]]\nname = "{name}"\nfile = "{name}.csv"\n'
            'time = "t"\nstart = "rest"\ninterpolation = "linear"\n'
            'ground = [{direction = "x", column = "ground", unit = "m/s^2"}]\n'
            f"channel = [{channels}]\n")
    return f"k{place + 1}", loss


def score(folders):
    rows = {}
    faults = []
    for folder in map(pathlib.Path, folders):
        truth = json.loads((folder / "truth.json").read_text())
        row = rows.setdefault((truth["kind"], truth["loss"]),
                              dict(runs=0, found=0, first=0, listed=0,
                                   inside=0, width=0.0))
        row["runs"] += 1
        path = folder / "E" / "damage.json"
        if not path.exists():
            faults.append(f"{folder}: no result")
            continue
        damage = json.loads(path.read_text())
        sets = damage["explanations"]
        row["found"] += bool(sets)
        if not sets:
            continue
        named = [[c["name"] for c in s["changes"]] for s in sets]
        row["first"] += truth["place"] in named[0]
        for s in sets:
            for c in s["changes"]:
                if c["name"] != truth["place"]:
                    continue
                row["listed"] += 1
                row["inside"] += (
                    c["lower95"] <= -truth["loss"] <= c["upper95"])
                row["width"] += 0.5 * (c["upper95"] - c["lower95"])
                break
            else:
                continue
            break
        else:
            faults.append(f"{folder}: {truth['place']} is not in {named}")
    print("kind       loss %   runs  found  first  listed  inside  inside %"
          "  mean half-width %")
    total = np.zeros(2)
    for (kind, loss), row in sorted(rows.items()):
        total += row["inside"], row["listed"]
        listed = max(row["listed"], 1)
        print(f"{kind:10} {100 * loss:6.0f} {row['runs']:6} {row['found']:6} "
              f"{row['first']:6} {row['listed']:7} {row['inside']:7} "
              f"{100 * row['inside'] / listed:9.1f} "
              f"{100 * row['width'] / listed:10.2f}")
    print(f"all: {total[0]:.0f} of {total[1]:.0f} inside, "
          f"{100 * total[0] / max(total[1], 1):.1f} %")
    for fault in faults[:20]:
        print(fault)


def main():
    if sys.argv[1] == "score":
        score(sys.argv[2:])
        return
    kind, seed = sys.argv[2], int(sys.argv[3])
    folder = pathlib.Path(sys.argv[4])
    folder.mkdir(parents=True)
    if kind == "frame":
        place, loss = make_frame(seed, folder)
    else:
        place, loss = make_beam(kind == "cantilever", seed, folder)
    (folder / "truth.json").write_text(
        json.dumps({"kind": kind, "place": place, "loss": loss}))


if __name__ == "__main__":
    main()
