"""Draws noisy FRFs of six masses, and finds their modes by published steps.

    frf_modes.py draw FOLDER SEED NOISE     writes the FRFs of one draw as text
    frf_modes.py score FOLDER DRAWS NOISE   reads the results of pinode_modes,
                                            and prints coverage and errors

NOISE is channel (1 % of each channel's rms) or line (1 % of each line). The
reference is LSCF (P. Guillaume et al. 2003) with real coefficients, the highest
one fixed to 1 or the lowest, and least squares in the frequency domain (LSFD)
for residues, upper and lower residuals. It gets the order up to 60 and the
constraint that suit it best, which needs the exact modes.
"""

import csv
import sys

import numpy as np

HZ = np.array([1.9293, 5.6169, 8.6806, 14.4909, 15.8430, 17.0080])
RATIO = 0.02
V = np.array([1.0, 0.8, -0.6, 1.3, 0.5, -0.9])
SHAPES = np.eye(6) - 2.0 * np.outer(V, V) / (V @ V)
F = 0.5 + 0.05 * np.arange(391)
S = 2j * np.pi * F


def poles():
    w = 2.0 * np.pi * HZ
    return w * (-RATIO + 1j * np.sqrt(1.0 - RATIO**2))


def exact():
    """Accelerances of all masses to a force at mass 1, lines x outputs."""
    w = 2.0 * np.pi * HZ
    d = 1.0 / (S[:, None] ** 2 + 2.0 * RATIO * w * S[:, None] + w**2)
    return np.einsum("or,r,kr->ko", SHAPES, SHAPES[0], d) * S[:, None] ** 2


def sigmas(h, noise):
    if noise == "line":
        return 0.01 * np.abs(h)
    return 0.01 * np.sqrt(np.mean(np.abs(h) ** 2, axis=0)) * np.ones_like(h.real)


def draw(seed, noise):
    h = exact()
    random = np.random.default_rng(seed)
    parts = random.standard_normal((2,) + h.shape)
    return h + sigmas(h, noise) / np.sqrt(2.0) * (parts[0] + 1j * parts[1])


def write(folder, seed, noise):
    h = draw(seed, noise)
    for o in range(6):
        np.savetxt(f"{folder}/u{o + 1}.txt", np.c_[F, h[:, o].real, h[:, o].imag],
                   header="Frequency Real Imaginary", comments="", fmt="%.17g")


def bounds(noise):
    """Cramer-Rao deviations of frequency and damping, residuals free."""
    p = poles()
    w = 2.0 * np.pi * HZ
    residue = SHAPES * SHAPES[0] / (2j * w * np.sqrt(1.0 - RATIO**2))
    weight = np.sqrt(2.0) / sigmas(exact(), noise)
    u = S[:, None] ** 2 / (S[:, None] - p)
    v = S[:, None] ** 2 / (S[:, None] - p.conj())
    u2, v2 = u / (S[:, None] - p), v / (S[:, None] - p.conj())

    def real(a, o):
        a = a * weight[:, o, None]
        return np.r_[a.real, a.imag]

    information = np.zeros((12, 12))
    for o in range(6):
        linear = real(np.c_[u + v, 1j * (u - v), np.ones_like(S), S**2], o)
        q = np.linalg.qr(linear / np.linalg.norm(linear, axis=0))[0]
        c = residue[o]
        slopes = real(np.c_[c * u2 + c.conj() * v2,
                            1j * (c * u2 - c.conj() * v2)], o)
        slopes -= q @ (q.T @ slopes)
        information += slopes.T @ slopes
    covariance = np.linalg.inv(information)
    size = np.abs(p)
    deviations = []
    for r in range(6):
        own = covariance[np.ix_([r, r + 6], [r, r + 6])]
        f = np.array([p[r].real, p[r].imag]) / size[r] / (2.0 * np.pi)
        z = np.array([-1.0 / size[r] + p[r].real**2 / size[r] ** 3,
                      p[r].real * p[r].imag / size[r] ** 3])
        deviations.append([np.sqrt(f @ own @ f), np.sqrt(z @ own @ z)])
    return np.array(deviations)


def lscf(h, highest_fixed):
    """Poles of orders 2, 4, ... 60, without those of negative damping."""
    step = np.pi / (2.0 * np.pi * F[-1])
    top = 60
    powers = np.exp(S[:, None] * step * np.arange(top + 1))
    r = (powers.conj().T @ powers).real
    products = []
    for o in range(h.shape[1]):
        y = -powers * h[:, o, None]
        products.append(((powers.conj().T @ y).real, (y.conj().T @ y).real))
    result = []
    for n in range(2, top + 1, 2):
        k = n + 1
        m = np.zeros((k, k))
        for s, t in products:
            m += t[:k, :k] - s[:k, :k].T @ np.linalg.lstsq(
                r[:k, :k], s[:k, :k], rcond=None)[0]
        a = np.ones(k)
        if highest_fixed:
            a[:n] = np.linalg.lstsq(m[:n, :n], -m[:n, n], rcond=None)[0]
        else:
            a[1:] = np.linalg.lstsq(m[1:, 1:], -m[1:, 0], rcond=None)[0]
        s = np.log(np.roots(a[::-1]).astype(complex)) / step
        result.append(s[(s.imag > 0.0) & (s.real < 0.0)])
    return result


def nearest(found):
    """The poles nearest to the exact ones; None: one is missing."""
    chosen = []
    for p in poles():
        if len(found) == 0:
            return None
        k = np.argmin(np.abs(found - p))
        if np.abs(found[k] - p) > 0.02 * np.abs(p):
            return None
        chosen.append(found[k])
    return np.array(chosen)


def to_modes(p):
    return np.c_[np.abs(p) / (2.0 * np.pi), -p.real / np.abs(p)]


def lsfd(h, p):
    """Residues of the poles by least squares, modes x outputs."""
    u = S[:, None] ** 2 / (S[:, None] - p)
    v = S[:, None] ** 2 / (S[:, None] - p.conj())
    a = np.c_[u + v, 1j * (u - v), np.ones_like(S), S**2]
    a = np.r_[a.real, a.imag]
    size = np.linalg.norm(a, axis=0)
    c = np.linalg.lstsq(a / size, np.r_[h.real, h.imag], rcond=None)[0]
    c = c / size[:, None]
    return c[:6] + 1j * c[6:12]


def truth():
    w = 2.0 * np.pi * HZ * np.sqrt(1.0 - RATIO**2)
    return (SHAPES * SHAPES[0] / (2j * w)).T  # modes x outputs


def read(path):
    with open(path, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return [{k: float(v) for k, v in row.items()} for row in rows]


def score(folder, draws, noise):
    exact_modes = np.c_[HZ, np.full(6, RATIO)]
    errors, inside, residues, wrong = [], [], [], 0
    by_lscf = {}
    lscf_residues = {}
    for seed in range(draws):
        modes = read(f"{folder}/{seed}/modes.csv")
        scales = read(f"{folder}/{seed}/residues.csv")
        if len(modes) != 6:
            wrong += 1
        else:
            own = np.array([[m["frequency_hz"], m["damping_ratio"]]
                            for m in modes])
            sigma = np.array([[m["frequency_sigma"], m["damping_sigma"]]
                              for m in modes])
            errors.append(own - exact_modes)
            inside.append(np.abs(own - exact_modes) < 1.96 * sigma)
            for r, row in enumerate(scales):
                for o in range(6):
                    value = truth()[r, o]
                    name = f"u{o + 1}/u1_"
                    residues.append([
                        abs(row[name + "real"] - value.real)
                        < 1.96 * row[name + "sigma_real"],
                        abs(row[name + "imaginary"] - value.imag)
                        < 1.96 * row[name + "sigma_imaginary"]])
        h = draw(seed, noise)
        for highest in (True, False):
            for n, found in enumerate(lscf(h, highest)):
                chosen = nearest(found)
                key = (2 * n + 2, highest)
                by_lscf.setdefault(key, [])
                lscf_residues.setdefault(key, [])
                if chosen is not None:
                    by_lscf[key].append(to_modes(chosen) - exact_modes)
                    lscf_residues[key].append(lsfd(h, chosen) - truth())
    errors, inside = np.array(errors), np.array(inside)
    bound = bounds(noise)
    ratio = np.sqrt(np.mean(errors**2, axis=0)) / bound
    print(f"noise of each {noise}: {draws} draws, {wrong} without six modes")
    print("coverage of 95 % intervals, %, by mode:")
    print("  frequency", np.round(100.0 * inside[:, :, 0].mean(0), 1))
    print("  damping  ", np.round(100.0 * inside[:, :, 1].mean(0), 1))
    print("  over all modes: frequency "
          f"{100.0 * inside[:, :, 0].mean():.1f}, damping "
          f"{100.0 * inside[:, :, 1].mean():.1f}, residues "
          f"{100.0 * np.mean(residues):.1f}")
    print("rmse over the Cramer-Rao bound, by mode:")
    print("  frequency", np.round(ratio[:, 0], 3))
    print("  damping  ", np.round(ratio[:, 1], 3))
    full = {k: v for k, v in by_lscf.items() if len(v) == draws}
    if not full:
        print("LSCF: no order finds six modes in all draws")
        return
    rms = {k: np.sqrt(np.mean(np.array(v) ** 2, axis=0)) for k, v in full.items()}
    best = min(rms, key=lambda k: np.sqrt(np.mean(rms[k][:, 1] ** 2)))
    print(f"LSCF + LSFD at its best order, {best[0]} (coefficient fixed: "
          f"{'highest' if best[1] else 'lowest'}):")
    print("  frequency", np.round(rms[best][:, 0] / bound[:, 0], 3))
    print("  damping  ", np.round(rms[best][:, 1] / bound[:, 1], 3))
    own = np.sqrt(np.mean(np.mean(errors[:, :, 1] ** 2, axis=0)))
    other = np.sqrt(np.mean(rms[best][:, 1] ** 2))
    print(f"root mean square over the modes, damping: {own / other:.3f} of LSCF's")
    print("  residues, rms error of LSFD:",
          f"{np.sqrt(np.mean(np.abs(np.array(lscf_residues[best])) ** 2)):.3g}")


if __name__ == "__main__":
    if sys.argv[1] == "draw":
        write(sys.argv[2], int(sys.argv[3]), sys.argv[4])
    else:
        score(sys.argv[2], int(sys.argv[3]), sys.argv[4])
