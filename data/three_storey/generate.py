#!/usr/bin/env python3
"""Three-storey shear frame with a hardening first storey under ground motion.

Writes train.csv holdout.csv (time, ground acceleration, absolute floor
accelerations), damaged.csv, the damping groups' matrices and truth.json.  Columns of a
record: ag is the ground acceleration that acted, ag_noisy what a sensor read;
a1 a2 a3 are the floor accelerations as read, a1_true a2_true a3_true without
noise.  The seed changes the noise and nothing else.  damaged.csv: under the
ground motion of holdout.csv and without noise, a1_k2 is the first floor's
acceleration where the second storey has lost LOSS of its stiffness, a3_k2_more
the roof's where it has lost LARGER_LOSS.
"""

import argparse
import os
import sys

import numpy as np

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import reference  # noqa: E402

MASS = np.array([2000.0, 2000.0, 2000.0])  # floors, kg
STOREY = np.array([3.04e6, 3.39e6, 2.81e6])  # N/m, from the ground up
CUBIC = 2.0e9  # first storey, N/m^3
PRIOR_STOREY = STOREY * np.array([0.80, 1.15, 1.10])  # what the case knows
# C = a0 M + a1 K with the stiffness of the prior: damping models are built on
# the design, and thus the two factors below can represent it exactly.
DAMPING_RATIO = 0.0185  # of the first and third of HERTZ
PRIOR_DAMPING_FACTOR = 0.70  # what the case knows of a0 and a1
HERTZ = np.array([2.8, 7.6, 11.4])  # undamped, for small amplitudes
RATE = 100.0  # Hz
DURATION = 30.0  # s
PEAK_GROUND_ACCELERATION = 3.0  # m/s^2
MOTION_SEEDS = {"train": 6, "holdout": 5}
NOISE = 0.02  # of each channel's standard deviation
LOSS, LARGER_LOSS = 0.005, 0.02  # of one storey's stiffness, in damaged.csv
HEADER = ["t", "ag", "ag_noisy", "a1", "a2", "a3",
          "a1_true", "a2_true", "a3_true"]


def rayleigh_coefficients():
    """a0, a1 with DAMPING_RATIO at the first and third of HERTZ, rounded."""
    first, third = 2 * np.pi * HERTZ[[0, 2]]
    a0 = 2 * DAMPING_RATIO * first * third / (first + third)
    return float("%.3g" % a0), float("%.3g" % (2 * DAMPING_RATIO /
                                               (first + third)))


def damping_matrix():
    a0, a1 = rayleigh_coefficients()
    return a0 * np.diag(MASS) + a1 * reference.chain(PRIOR_STOREY)


def frequencies(stiffness):
    """Undamped frequencies in Hz and mass-normalised shapes."""
    root = np.sqrt(MASS)
    values, vectors = np.linalg.eigh(stiffness / np.outer(root, root))
    return np.sqrt(values) / (2 * np.pi), vectors / root[:, None]


def restoring_acceleration(h, stiffness, damping, cubic):
    """M^-1 times the forces of springs and dampers: absolute acceleration."""
    force = stiffness @ h[:3] + damping @ h[3:]
    force[0] += cubic * h[0]**3
    return -force / MASS


def response(times, ground, tolerance=1e-12, stiffness=None, damping=None,
             cubic=CUBIC):
    """States and absolute accelerations from rest; ground linear between."""
    stiffness = reference.chain(STOREY) if stiffness is None else stiffness
    damping = damping_matrix() if damping is None else damping
    ag = reference.linear_between(times, ground)
    states = reference.trajectory(
        lambda i, t, h: np.concatenate([
            h[3:],
            restoring_acceleration(h, stiffness, damping, cubic) - ag(i, t)
        ]), np.zeros(6), times, relative=tolerance)
    accelerations = np.array(
        [restoring_acceleration(h, stiffness, damping, cubic) for h in states])
    return states, accelerations


def ground_motion(name):
    times, motion = reference.kanai_tajimi(
        [MOTION_SEEDS[name], 0], DURATION, RATE, ground_hz=3.5,
        ground_damping=0.6, strong_until=14.0, decay=0.2)
    # Rounded before use: the file holds exactly what acted.
    return times, np.round(PEAK_GROUND_ACCELERATION * motion, 5)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="of the noise")
    parser.add_argument("--output", default=HERE, help="folder to write into")
    arguments = parser.parse_args()
    output = arguments.output
    reference.prepare_output(HERE, output)

    stiffness = reference.chain(STOREY)
    damping = damping_matrix()
    hertz, shapes = frequencies(stiffness)
    ratios = np.diag(shapes.T @ damping @ shapes) / (4 * np.pi * hertz)
    assert np.max(np.abs(hertz / HERTZ - 1)) < 0.002, hertz
    assert np.all((ratios > 0.0145) & (ratios < 0.0205)), ratios
    prior = reference.chain(PRIOR_STOREY)
    a0, a1 = rayleigh_coefficients()
    reference.write_matrix(os.path.join(output, "C_mass.csv"),
                           PRIOR_DAMPING_FACTOR * a0 * np.diag(MASS))
    reference.write_matrix(os.path.join(output, "C_stiffness.csv"),
                           PRIOR_DAMPING_FACTOR * a1 * prior)

    truth = {
        "mass": MASS.tolist(),
        "storey_stiffness": STOREY.tolist(),
        "prior_storey_stiffness": PRIOR_STOREY.tolist(),
        "rayleigh": [a0, a1],
        "prior_rayleigh": [PRIOR_DAMPING_FACTOR * a0,
                           PRIOR_DAMPING_FACTOR * a1],
        "hertz": hertz.tolist(),
        "prior_hertz": frequencies(prior)[0].tolist(),
        "modal_damping_ratio": ratios.tolist(),
        "groups": {
            **{f"k{i + 1}": STOREY[i] / PRIOR_STOREY[i] - 1 for i in range(3)},
            "c_mass": 1 / PRIOR_DAMPING_FACTOR - 1,
            "c_stiffness": 1 / PRIOR_DAMPING_FACTOR - 1,
        },
        "elements": {"spring1": {"k3": CUBIC}},
        "noise_seed": arguments.seed,
        "records": {},
    }
    for number, name in enumerate(MOTION_SEEDS):
        times, ground = ground_motion(name)
        states, clean = response(times, ground)
        assert ground[0] == 0 and ground[-1] == 0
        drift = np.max(np.abs(states[:, 0]))
        share = CUBIC * drift**2 / STOREY[0]
        assert 0.10 < share < 0.17, (name, share)
        end = np.max(np.abs(clean[-1])) / np.max(np.abs(clean))
        assert end < 0.05, (name, end)

        noise = np.random.default_rng([arguments.seed, number])
        sigma = NOISE * clean.std(axis=0)
        measured = clean + sigma * noise.standard_normal(clean.shape)
        ground_sigma = NOISE * ground.std()
        ground_measured = ground + ground_sigma * noise.standard_normal(
            ground.shape)
        reference.write_csv(
            os.path.join(output, name + ".csv"), HEADER,
            [times, ground, ground_measured, *measured.T, *clean.T],
            ["%.4g", "%.5f", "%.5f"] + ["%.5f"] * 3 + ["%.12g"] * 3)

        # What the true model leaves: driven by what acted, and by what the
        # ground sensor read.
        driven_by_noisy = response(times, ground_measured, 1e-9)[1]
        truth["records"][name] = {
            "peak_first_storey_drift": drift,
            "peak_cubic_share_of_linear_force": share,
            "sigma": sigma.tolist(),
            "ground_sigma": ground_sigma,
            "noise_floor_nrmse": reference.nrmse(measured, clean).tolist(),
            "noise_floor_nrmse_noisy_ground":
                reference.nrmse(measured, driven_by_noisy).tolist(),
        }
    truth["loss"], truth["larger_loss"] = LOSS, LARGER_LOSS
    reference.write_json(os.path.join(output, "truth.json"), truth)

    # The damping stays: it is built on the design.
    times, ground = ground_motion("holdout")
    names, columns = ["t", "ag"], [times, ground]
    for storey in range(3):
        for loss, floors, end in ((LOSS, range(3), ""),
                                  (LARGER_LOSS, [2], "_more")):
            factors = np.ones(3)
            factors[storey] -= loss
            clean = response(times, ground,
                             stiffness=reference.chain(STOREY * factors))[1]
            for floor in floors:
                names.append(f"a{floor + 1}_k{storey + 1}{end}")
                columns.append(clean[:, floor])
    reference.write_csv(os.path.join(output, "damaged.csv"), names, columns,
                        ["%.4g", "%.5f"] + ["%.9g"] * 12)


if __name__ == "__main__":
    main()
