#!/usr/bin/env python3
"""Scores the results that ambient.sh has left in a folder: score.py FOLDER
[options of ambient.sh].  The Cramer-Rao bound is that of the record's spectrum
with the loads' as they are, known (Whittle's information, by differences)."""

import glob
import json
import os
import sys

import numpy as np

sys.dont_write_bytecode = True
from case_generator import CASE, NAMES  # noqa: E402


def spectra(alpha, frequency, loads, noise):
    frame, chain = CASE.FRAME, CASE.reference.chain
    a0, a1 = frame.rayleigh_coefficients()
    part = frame.PRIOR_DAMPING_FACTOR
    stiffness = chain(frame.PRIOR_STOREY * (1 + alpha[:3]))
    damping = (part * a0 * (1 + alpha[3]) * np.diag(frame.MASS) +
               part * a1 * (1 + alpha[4]) * chain(frame.PRIOR_STOREY))
    w = 2 * np.pi * frequency[:, None, None]
    h = -w**2 * np.linalg.inv(stiffness - w**2 * np.diag(frame.MASS) +
                              1j * w * damping)
    g = h @ CASE.force_root(frequency, *loads)
    return (g @ np.conj(np.swapaxes(g, 1, 2)) +
            2 / CASE.RATE * np.diag(noise**2))


def bound(truth, loads):
    alpha = np.array([truth["groups"][n] for n in NAMES])
    frequency = np.arange(1 / CASE.DURATION, 17.0, 1 / CASE.DURATION)
    frequency = frequency[frequency > 0.8]
    noise = np.array(truth["noise_sigma"])
    inverse = np.linalg.inv(spectra(alpha, frequency, loads, noise))
    slopes = []
    for i in range(len(alpha)):
        step = np.zeros(len(alpha))
        step[i] = 1e-5
        slopes.append(inverse @ (spectra(alpha + step, frequency, loads, noise) -
                                 spectra(alpha - step, frequency, loads,
                                         noise)) / 2e-5)
    information = np.array([[np.einsum("kij,kji->", a, b).real for b in slopes]
                            for a in slopes])
    return np.sqrt(np.diag(np.linalg.inv(information)))


def main():
    folder, options = sys.argv[1], sys.argv[2:]
    peak = (float(options[options.index("--peak") + 1])
            if "--peak" in options else 0.0)
    loads = ("--white" in options, peak)  # as CASE.force_root has them
    cases = (["shaker"] if "--shaker" in options else
             ["uncorrelated"] if peak else
             ["three_storey_ambient", "independent"])
    for case in cases:
        errors, sigmas, usable, probability, seconds = [], [], 0, [], []
        truth = None
        for path in sorted(glob.glob(os.path.join(folder, "*", case,
                                                  "result.json"))):
            with open(path, encoding="utf-8") as file:
                result = json.load(file)
            with open(os.path.join(os.path.dirname(path), "..", "truth.json"),
                      encoding="utf-8") as file:
                truth = json.load(file)
            found = {p["name"]: p for p in result["parameters"]}
            errors.append([found[n]["value"] - truth["groups"][n]
                           for n in NAMES])
            sigmas.append([(found[n]["upper95"] - found[n]["lower95"]) / 3.92
                           for n in NAMES])
            usable += result["usable"]
            score = result["ambient"][0]
            probability.append(min(score["probability"],
                                   score.get("coherence_probability", 1)))
            seconds.append(result["solver"]["seconds"])
        if not errors:
            print(case + ": no results")
            continue
        errors, sigmas = np.array(errors), np.array(sigmas)
        crb = bound(truth, loads)
        inside = np.abs(errors) <= 1.96 * sigmas
        print("%s: %d records, %d usable, probability %.2g (median), %.1f s "
              "(median)" % (case, len(errors), usable, np.median(probability),
                            np.median(seconds)))
        for i, name in enumerate(NAMES):
            print("  %-12s inside %5.1f %%, bias %+.2f deviations, rmse %.4f, "
                  "%.2f of the bound" %
                  (name, 100 * inside[:, i].mean(),
                   errors[:, i].mean() / sigmas[:, i].mean(),
                   np.sqrt(np.mean(errors[:, i]**2)),
                   np.sqrt(np.mean(errors[:, i]**2)) / crb[i]))


if __name__ == "__main__":
    main()
