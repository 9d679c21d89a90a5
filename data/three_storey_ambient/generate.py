#!/usr/bin/env python3
"""The frame of three_storey, linear, under wind that nobody measures.

Writes wind.csv.gz (accelerations of the floors), C_mass.csv, C_stiffness.csv and
truth.json.  --seed gives another realisation, --white forces of flat spectra
that have nothing to do with each other, --peak 2.5 forces that are so many
decibels stronger at 5 Hz, within an octave and a half, --loss 2 0.1 a structure whose second
storey has lost a tenth of its stiffness.  --shaker noise 3 adds a measured force
on the top floor, column F, whose response is three times as strong as the
wind's: noise from 0.5 to 20 Hz that has acted before the record too, a sweep
from 1 to 15 Hz from rest, or fifteen blows.  shaker.toml is the case with it;
--gain 1.1 records a tenth too much of it.

The wind's force on floor j has the one-sided spectrum of a longitudinal gust
after von Karman, S(f) ~ 1 / (1 + 70.8 (f L / U)^2)^(5/6), which falls with
f^(-5/3), and the coherence exp(-C f |z_i - z_j| / U) of Davenport with that of
floor i.  Forces and responses are made at once in the frequency domain, over
a period twice as long as the record, of which the second half is left out: they
are stationary, and have nothing above half the sampling rate, as a logger
behind its filter leaves them.
"""

import argparse
import gzip
import importlib.util
import os
import sys

import numpy as np

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import reference  # noqa: E402

SPEC = importlib.util.spec_from_file_location(
    "three_storey", os.path.join(HERE, "..", "three_storey", "generate.py"))
FRAME = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(FRAME)

RATE = 100.0  # Hz
DURATION = 600.0  # s
NOISE = 0.02  # of each channel's standard deviation
HEIGHT = np.array([3.5, 7.0, 10.5])  # floors above the ground, m
WIND, LENGTH, DECAY = 20.0, 60.0, 8.0  # U m/s, L m, C
FORCE = np.array([1.0, 1.3, 0.9]) * 400.0  # standard deviations, N
PEAK = 5.0  # Hz


def peaked(frequency, decibels):
    """Amplitudes beside those without the peak."""
    ratio, root = frequency / PEAK, 10 ** (decibels / 40)
    return np.abs((1 - ratio**2 + 1j * ratio * root) /
                  (1 - ratio**2 + 1j * ratio / root))


def force_root(frequency, white, peak=0.0):
    """Per frequency a lower root of the forces' spectral matrix, N^2/Hz."""
    by_peak = peaked(frequency, peak)[:, None, None]
    if white:
        return np.sqrt(2.0 / RATE) * by_peak * np.diag(FORCE)
    gust = 4 * LENGTH / WIND / (
        1 + 70.8 * (frequency * LENGTH / WIND)**2)**(5 / 6)
    apart = np.abs(HEIGHT[:, None] - HEIGHT[None, :])
    coherence = np.exp(-DECAY * frequency[:, None, None] * apart / WIND)
    return by_peak * np.linalg.cholesky(
        gust[:, None, None] * coherence * np.outer(FORCE, FORCE))


def responses(force, period, storey):
    """Accelerations of the floors over a period; `force`: one-sided spectra of
    its inner lines, lines by floors."""
    frequency = np.fft.rfftfreq(period, 1 / RATE)[1:-1]
    w = 2 * np.pi * frequency[:, None, None]
    dynamic = (reference.chain(storey) - w**2 * np.diag(FRAME.MASS) +
               1j * w * FRAME.damping_matrix())
    motion = np.linalg.solve(dynamic, force[:, :, None])[:, :, 0]
    spectrum = np.zeros((period // 2 + 1, 3), dtype=complex)
    spectrum[1:-1] = -w[:, :, 0]**2 * motion
    return np.fft.irfft(spectrum, period, axis=0)


def shaker(seed, kind):
    """A measured force over twice the record, in any unit."""
    rng = np.random.default_rng(1000 + seed)
    samples = int(round(DURATION * RATE))
    time = np.arange(samples) / RATE
    force = np.zeros(2 * samples)
    if kind == "noise":
        frequency = np.fft.rfftfreq(2 * samples, 1 / RATE)
        normal = rng.standard_normal((len(frequency), 2)) @ [1, 1j]
        force = np.fft.irfft(
            np.where((frequency > 0.5) & (frequency < 20), normal, 0),
            2 * samples)
    elif kind == "sweep":
        force[:samples] = np.sin(
            2 * np.pi * time * (1 + 7 * time / DURATION)) * np.minimum(
                1, time / 5)
    else:
        for at in np.arange(7, DURATION, 40) + rng.uniform(0, 5, 15):
            force[:samples] += np.exp(-0.5 * ((time - at) / 0.025)**2)
    return force


def record(seed, white, storey, peak=0.0):
    """Accelerations (samples by floors) with noise, and the noise's sigma."""
    rng = np.random.default_rng(seed)
    samples = int(round(DURATION * RATE))
    period = 2 * samples
    frequency = np.fft.rfftfreq(period, 1 / RATE)[1:-1]
    normal = rng.standard_normal((len(frequency), 3, 2)) @ [1, 1j]
    # Half the one-sided density on either side.
    force = 0.5 * np.sqrt(period * RATE) * np.einsum(
        "kij,kj->ki", force_root(frequency, white, peak), normal)
    values = responses(force, period, storey)[:samples]
    sigma = NOISE * values.std(axis=0)
    return values + sigma * rng.standard_normal(values.shape), sigma


def add_shaker(seed, kind, ratio, gain, storey, values):
    """What `record` gives, with its force as a fourth column."""
    force = shaker(seed, kind)
    lines = np.fft.rfft(force)[1:-1]
    zero = np.zeros_like(lines)
    motion = responses(np.stack([zero, zero, lines], axis=1), len(force),
                       storey)[:len(values)]
    factor = ratio * values.std() / motion.std()
    return np.column_stack([values + factor * motion,
                            gain * factor * force[:len(values)]])


def write_shaker_case(folder):
    with open(os.path.join(HERE, "three_storey_ambient.toml")) as file:
        case = file.read()
    line = 'excitation = "ambient"\n'
    assert line in case
    with open(os.path.join(folder, "shaker.toml"), "w") as file:
        file.write(case.replace(line, line + """interpolation = "band_limited"

  [[record.force]]
  dof    = "u3"
  column = "F"
  unit   = "N"
"""))


def write_record(path, values):
    lines = ["a1,a2,a3,F" if values.shape[1] > 3 else "a1,a2,a3"]
    lines += [",".join("%.5g" % v for v in row) for row in values]
    data = ("\n".join(lines) + "\n").encode()
    with open(path, "wb") as file:
        file.write(gzip.compress(data, 9, mtime=0))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", default=HERE)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--white", action="store_true")
    parser.add_argument("--peak", type=float, default=0.0)
    parser.add_argument("--loss", type=float, nargs=2, default=[1, 0.0])
    parser.add_argument("--shaker", nargs=2, metavar=("KIND", "RATIO"),
                        help="noise, sweep or blows")
    parser.add_argument("--gain", type=float, default=1.0)
    args = parser.parse_args()
    storey = FRAME.STOREY.copy()
    storey[int(args.loss[0]) - 1] *= 1 - args.loss[1]
    reference.prepare_output(HERE, args.output)
    values, sigma = record(args.seed, args.white, storey, args.peak)
    if args.shaker:
        values = add_shaker(args.seed, args.shaker[0], float(args.shaker[1]),
                            args.gain, storey, values)
        write_shaker_case(args.output)
    write_record(os.path.join(args.output, "wind.csv.gz"), values)
    a0, a1 = FRAME.rayleigh_coefficients()
    prior = FRAME.PRIOR_DAMPING_FACTOR
    reference.write_matrix(os.path.join(args.output, "C_mass.csv"),
                           prior * a0 * np.diag(FRAME.MASS))
    reference.write_matrix(
        os.path.join(args.output, "C_stiffness.csv"),
        prior * a1 * reference.chain(FRAME.PRIOR_STOREY))
    hertz, shapes = FRAME.frequencies(reference.chain(storey))
    damping = np.diag(shapes.T @ FRAME.damping_matrix() @ shapes)
    truth = {
        "hertz": list(hertz),
        "modal_damping_ratio": list(damping / (4 * np.pi * hertz)),
        "groups": dict(zip(
            ["k1", "k2", "k3"],
            storey / FRAME.PRIOR_STOREY - 1.0)),
        "noise_sigma": list(sigma),
    }
    truth["groups"].update(c_mass=1 / prior - 1, c_stiffness=1 / prior - 1)
    assert args.loss[1] > 0 or abs(hertz[0] - 2.8) < 0.01
    reference.write_json(os.path.join(args.output, "truth.json"), truth)


if __name__ == "__main__":
    main()
