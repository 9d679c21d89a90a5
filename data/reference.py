"""What the generators of the case data share.

Reference trajectories come from SciPy's DOP853, restarted at every sample: the
excitation has a kink (linear between samples) or a jump (held) there, and only
then does the tolerance hold.  Nothing here uses pinode.
"""

import filecmp
import json
import os
import re
import shutil
import tomllib

import numpy as np
from scipy.integrate import solve_ivp
from scipy.signal import bilinear, lfilter


def chain(values):
    """Matrix of springs in series: ground-1, 1-2, ... (n values, n by n)."""
    values = np.asarray(values, dtype=float)
    matrix = np.diag(values)
    matrix[:-1, :-1] += np.diag(values[1:])
    matrix -= np.diag(values[1:], 1) + np.diag(values[1:], -1)
    return matrix


def trajectory(rhs, start, times, relative=1e-12, absolute=1e-15):
    """States at `times` (len(times) by len(start)) of dh/dt = rhs(i, t, h).

    i is the sampling interval that t lies in, so that rhs never has to look
    across a kink of the excitation.
    """
    states = np.empty((len(times), len(start)))
    states[0] = start
    for i in range(len(times) - 1):
        step = solve_ivp(lambda t, h: rhs(i, t, h), (times[i], times[i + 1]),
                         states[i], method="DOP853", rtol=relative,
                         atol=absolute)
        if not step.success:
            raise RuntimeError(f"t = {times[i]:g} s: {step.message}")
        states[i + 1] = step.y[:, -1]
    return states


def linear_between(times, samples):
    """u(i, t): linear between samples, on interval i."""
    slopes = np.diff(samples) / np.diff(times)
    return lambda i, t: samples[i] + slopes[i] * (t - times[i])


def kanai_tajimi(seed, duration, rate, ground_hz, ground_damping,
                 corner_hz=0.3, rise=2.0, strong_until=10.0, decay=0.25,
                 taper=2.0):
    """Filtered noise with the spectrum of Kanai and Tajimi, peak 1.

    White noise through the ground's second-order filter
    (2 zeta w s + w^2) / (s^2 + 2 zeta w s + w^2) and, after Clough and Penzien,
    s^2 / (s^2 + 2 zeta_c w_c s + w_c^2), which takes out the static part.  The
    envelope rises as t^2, stays at one until `strong_until`, then decays
    exponentially; a cosine over the last `taper` seconds brings it to zero.
    """
    count = int(round(duration * rate)) + 1
    times = np.arange(count) / rate
    noise = np.random.default_rng(seed).standard_normal(count)
    w, zeta = 2 * np.pi * ground_hz, ground_damping
    wc, zeta_c = 2 * np.pi * corner_hz, 0.7
    ground = bilinear([2 * zeta * w, w**2], [1, 2 * zeta * w, w**2], rate)
    corner = bilinear([1, 0, 0], [1, 2 * zeta_c * wc, wc**2], rate)
    filtered = lfilter(*corner, lfilter(*ground, noise))
    envelope = np.minimum(1.0, (times / rise)**2)
    envelope *= np.exp(-decay * np.maximum(0.0, times - strong_until))
    left = np.clip((duration - times) / taper, 0.0, 1.0)
    envelope *= 0.5 * (1.0 - np.cos(np.pi * left))
    motion = filtered * envelope
    return times, motion / np.max(np.abs(motion))


def nrmse(measured, predicted):
    """|y - yhat| / |y - mean(y)|, 2-norms, per column."""
    centred = measured - measured.mean(axis=0)
    return (np.linalg.norm(measured - predicted, axis=0) /
            np.linalg.norm(centred, axis=0))


def write_csv(path, header, columns, formats):
    """One line of names, then one line a sample; `formats` one a column."""
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        file.write(",".join(header) + "\n")
        for row in zip(*columns):
            file.write(",".join(f % (v + 0.0) for f, v in zip(formats, row)) +
                       "\n")


def write_matrix(path, matrix):
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        for row in np.atleast_2d(matrix):
            file.write(",".join("%.12g" % value for value in row) + "\n")


def rounded(content):
    """`content` with every float at 12 significant digits."""
    if isinstance(content, dict):
        return {key: rounded(value) for key, value in content.items()}
    if isinstance(content, (list, tuple)):
        return [rounded(value) for value in content]
    return float("%.12g" % content) if isinstance(content, float) else content


def write_json(path, content):
    text = json.dumps(rounded(content), indent=2)
    # A list of numbers stays on one line.
    text = re.sub(r"\[[^][{}\"]*\]",
                  lambda m: " ".join(m[0].split()).replace("[ ", "[").replace(
                      " ]", "]"), text)
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        file.write(text + "\n")


def prepare_output(source, output):
    """Makes `output` and puts the hand-written case files of `source` there."""
    os.makedirs(output, exist_ok=True)
    for name in sorted(os.listdir(source)):
        if not name.endswith(".toml"):
            continue
        target = os.path.join(output, name)
        if os.path.exists(target) and filecmp.cmp(
                os.path.join(source, name), target, shallow=False):
            continue
        shutil.copyfile(os.path.join(source, name), target)


def read_case(path):
    with open(path, "rb") as file:
        return tomllib.load(file)
