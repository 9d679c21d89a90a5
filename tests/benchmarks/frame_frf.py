"""Frequency response functions of the steel frame in data/frame; NumPy and SciPy.

The frame has 1620 DOFs. Six accelerometers and one hammer, whose functions are
solutions of all equations with sparse matrices, with noise of 1 % of each
function's root mean square. Truth: two groups of columns have lost stiffness,
the others differ from the model as truth.json says.

  frame_frf.py make FOLDER SEED DATA_FRAME
  frame_frf.py score DATA_FRAME RESULT...
"""

import gzip
import json
import pathlib
import sys

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

LINES_HZ = np.arange(4.0, 30.0, 0.1)
HAMMER = "3153.1"
NOISE = 0.01
LOSSES = {"columns_1_west": -0.15, "columns_2_east": -0.10}


def read_matrix(path):
    """A symmetric matrix of CalculiX, of which one half is stored."""
    with gzip.open(path, "rt") as file:
        rows, columns, values = np.loadtxt(file, unpack=True)
    half = scipy.sparse.coo_matrix((values, (rows.astype(int) - 1, columns.astype(int) - 1)))
    whole = half + half.T - scipy.sparse.diags(half.tocsr().diagonal())
    return whole.tocsc()


def truth_of(frame):
    truth = json.loads((frame / "truth.json").read_text())
    values = dict(truth["as_built"])
    for name, loss in LOSSES.items():
        values[name] = (1.0 + values[name]) * (1.0 + loss) - 1.0
    return truth, values


def functions(frame):
    """Accelerance, lines x sensors."""
    truth, values = truth_of(frame)
    mass, stiffness = read_matrix(frame / "frame.mas.gz"), read_matrix(frame / "frame.sti.gz")
    mass_0, stiffness_0 = mass.copy(), stiffness.copy()
    for name, value in values.items():
        if name.startswith("mass"):
            mass = mass + value * (read_matrix(frame / f"{name}.mas.gz") - mass_0)
        else:
            stiffness = stiffness + value * (read_matrix(frame / f"{name}.sti.gz") - stiffness_0)
    alpha, beta = truth["damping"]["rayleigh"]
    names = (frame / "frame.dof").read_text().split()
    force = np.zeros(len(names), complex)
    force[names.index(HAMMER)] = 1.0
    sensors = [names.index(place) for place in truth["sensors"].values()]
    result = []
    for w in 2.0 * np.pi * LINES_HZ:
        z = (1.0 + 1j * w * beta) * stiffness + (1j * w * alpha - w ** 2) * mass
        result.append(-w ** 2 * scipy.sparse.linalg.splu(z.tocsc()).solve(force)[sensors])
    return np.array(result)


def make(folder, seed, frame):
    exact = folder.parent / "exact.npy"  # the same for all draws
    if not exact.exists():
        np.save(exact, functions(frame))
    values = np.load(exact)
    random = np.random.default_rng(seed)
    sigma = NOISE * np.sqrt(np.mean(np.abs(values) ** 2, axis=0) / 2.0)
    values = values + sigma * (random.standard_normal(values.shape) +
                               1j * random.standard_normal(values.shape))
    truth, _ = truth_of(frame)
    places = list(truth["sensors"].values())
    folder.mkdir(parents=True)
    for i in range(len(places)):
        np.savetxt(folder / f"h{i + 1}.csv",
                   np.column_stack([LINES_HZ, values[:, i].real, values[:, i].imag]), "%.9g", ",",
                   header="Frequency,Real,Imaginary", comments="")
    text = (frame / "columns_two.toml").read_text().split("[[record]]")[0]
    for file in frame.glob("*.gz"):
        text = text.replace(f'"{file.name}"', f'"{file.resolve()}"')
    text += ('[[frf]]\nname = "hammer"\nquantity = "acceleration"\n'
             f"files = {[f'h{i + 1}.csv' for i in range(len(places))]}\n"
             f"responses = {places}\nreferences = [\"{HAMMER}\"]\n").replace("'", '"')
    (folder / "case.toml").write_text(text)


def score(frame, results):
    _, values = truth_of(frame)
    held = total = 0
    for path in results:
        result = json.loads((pathlib.Path(path) / "result.json").read_text())
        by_name = {p["name"]: p for p in result["parameters"]}
        worst = 0.0
        for name, value in values.items():
            own = by_name[name]
            held += own["lower95"] <= value <= own["upper95"]
            total += 1
            worst = max(worst, abs(own["value"] - value))
        print(f"{path}: {result['verdict']}, {result['solver']['seconds']:.1f} s, "
              f"largest error {100.0 * worst:.2f} %")
    print(f"{held} of {total} intervals of 12 groups hold the truth")


def main():
    if sys.argv[1] == "make":
        make(pathlib.Path(sys.argv[2]), int(sys.argv[3]), pathlib.Path(sys.argv[4]))
    else:
        score(pathlib.Path(sys.argv[2]), sys.argv[3:])


main()
