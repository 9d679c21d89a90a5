"""Two files of a data logger: a frame of three storeys, before and after its
second storey has lost 15 % of its stiffness.

The frame is integrated exactly in its modes between samples of 1/2000 s. The
noise is 0.05 mg at the base and 0.5 mg above. Three storeys and motion
below 6.4 Hz keep the comparison short. It takes 1.3 s of one processor; with
five storeys and 14 Hz it took 23 s.
"""

import numpy as np
from scipy import signal

STANDARD_GRAVITY = 9.80665
WEIGHTS_KN = [900.0, 900.0, 700.0]
STIFFNESSES_KN_M = [180e3, 150e3, 120e3]
STOREYS = len(WEIGHTS_KN)
DAMAGED_STOREY = 2
LOST = 0.15
SECONDS = 20


def ground_motion(times, random):
    """A sum of 90 sines from 0.4 to 6.4 Hz that begins at rest."""
    lines = 90
    omega = 2 * np.pi * (0.4 + (np.arange(1, lines + 1) - random.random(lines)) * 6 / lines)
    phase = 2 * np.pi * random.random(lines)
    amplitude = 0.12 / (1 + (omega / 40) ** 2)
    motion = np.zeros_like(times)
    for a, w, p in zip(amplitude, omega, phase):
        motion += a * np.sin(w * times + p)
    return motion * np.minimum(times / 4, 1) ** 2


def write(path, seed, stiffnesses):
    """Writes base and floors in mg at 100 Hz, as a German logger does."""
    random = np.random.default_rng(seed)
    mass = np.array(WEIGHTS_KN) / STANDARD_GRAVITY
    k = np.array(stiffnesses)
    n = len(k)
    stiffness = np.diag(k) + np.diag(np.append(k[1:], 0))
    stiffness -= np.diag(k[1:], 1) + np.diag(k[1:], -1)
    damping = 0.0012 * stiffness + 0.12 * np.diag(mass)
    inverse = np.diag(1 / mass)
    a = np.block([[np.zeros((n, n)), np.eye(n)],
                  [-inverse @ stiffness, -inverse @ damping]])
    b = np.vstack([np.zeros((n, 1)), -np.ones((n, 1))])
    c = np.hstack([-inverse @ stiffness, -inverse @ damping])
    fine = np.arange(SECONDS * 2000) / 2000
    ground = ground_motion(fine, random)
    _, response, _ = signal.lsim((a, b, c, np.zeros((n, 1))), ground, fine)
    rows = slice(None, None, 20)
    milli = 1000 / STANDARD_GRAVITY
    times, base, floors = fine[rows], milli * ground[rows], milli * response[rows]
    base = base + 0.05 * random.standard_normal(base.shape)
    floors = floors + 0.5 * random.standard_normal(floors.shape)
    floor_names = [f"Etage {i + 1}" for i in range(n)]
    with open(path, "w", encoding="utf-8") as file:
        file.write("Logger ACME DX-800;SN 00412" + ";" * n + "\n"
                   "Sample rate [Hz];100" + ";" * n + "\n" +
                   ";".join(["Zeit", "Boden"] + floor_names) + "\n" +
                   ";".join(["s"] + ["mg"] * (n + 1)) + "\n")
        for t, g, f in zip(times, base, floors):
            text = ";".join([f"{t:.2f}", f"{g:.2f}"] + [f"{v:.2f}" for v in f])
            file.write(text.replace(".", ",") + "\n")


def write_both(before, after):
    damaged = list(STIFFNESSES_KN_M)
    damaged[DAMAGED_STOREY - 1] *= 1 - LOST
    write(before, 1, STIFFNESSES_KN_M)
    write(after, 2, damaged)
