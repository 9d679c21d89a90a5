"""A frame of three storeys, and measurements of it that the library did not
make."""

import numpy as np
import scipy.linalg

STEP = 0.01  # s, of the records
FINE = 10  # steps of the simulation a sample


def spring(n, i):
    """K of a unit spring between floor i - 1 (the ground for 0) and i."""
    matrix = np.zeros((n, n))
    matrix[i, i] = 1.0
    if i > 0:
        matrix[i - 1, i - 1] = 1.0
        matrix[i - 1, i] = matrix[i, i - 1] = -1.0
    return matrix


MASS = 2000.0 * np.eye(3)  # kg
STOREYS = [3e6 * spring(3, i) for i in range(3)]  # N/m
STIFFNESS = sum(STOREYS)
DAMPING = 1e-3 * STIFFNESS


def measure(losses=(0.0, 0.0, 0.0), seed=1, samples=1500, noise=0.05):
    """Accelerations of the ground (samples) and of the floors (samples x 3),
    with noise (m/s^2), where storeys have lost these fractions. Exact between
    steps of 1 ms in which the ground is linear."""
    stiffness = STIFFNESS - sum(f * k for f, k in zip(losses, STOREYS))
    h = STEP / FINE
    t = h * np.arange(FINE * samples)
    ground = 3.0 * np.sin(9.0 * t) + 2.0 * np.sin(17.0 * t + 0.8 * t * t)
    inverse = np.linalg.inv(MASS)
    a = np.block([[np.zeros((3, 3)), np.eye(3)],
                  [-inverse @ stiffness, -inverse @ DAMPING]])
    b = np.concatenate([np.zeros(3), -np.ones(3)])
    # Of the state, the ground's acceleration and its slope, over a step.
    block = np.zeros((8, 8))
    block[:6, :6], block[:6, 6], block[6, 7] = h * a, h * b, 1.0
    power = scipy.linalg.expm(block)
    step, held, slope = power[:6, :6], power[:6, 6], power[:6, 7]
    state = np.zeros(6)
    absolute = np.zeros((samples, 3))
    resist = -np.hstack([inverse @ stiffness, inverse @ DAMPING])
    for i in range(len(t) - 1):
        if i % FINE == 0:
            absolute[i // FINE] = resist @ state
        state = step @ state + held * ground[i] + slope * (ground[i + 1] - ground[i])
    random = np.random.default_rng(seed)
    return ground[::FINE], absolute + noise * random.standard_normal(absolute.shape)
