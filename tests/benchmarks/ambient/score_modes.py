#!/usr/bin/env python3
"""score_modes.py FOLDER CASE: the modes of FOLDER/*/modes.json against those of
the structure.  Missed are modes in the case's band that make 0.1 % of one
sensor's power or more; spurious are those that are near no mode of the structure
(2 % in frequency, and 0.1 (1 - MAC) together)."""

import glob
import importlib.util
import json
import os
import sys

import numpy as np

sys.dont_write_bytecode = True
DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..",
                    "..", "data")
LEAST_SHARE = 1e-3
APART = 0.02


def generator(case):
    spec = importlib.util.spec_from_file_location(
        "generate", os.path.join(DATA, case, "generate.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def shares(frequency, hertz, ratios, shapes, modal_force):
    """Of each mode the largest part of one sensor's power that it makes.
    modal_force: lines by modes, |.|^2 of the forces on mass-normalised modes."""
    w, natural = 2 * np.pi * frequency[:, None], 2 * np.pi * hertz
    power = (np.abs(w**2 / (natural**2 - w**2 + 2j * ratios * natural * w))**2 *
             modal_force).sum(axis=0)
    by_sensor = np.abs(shapes)**2 * power
    return (by_sensor / by_sensor.sum(axis=1, keepdims=True)).max(axis=0)


def three_storey_ambient(case):
    frame = case.FRAME
    hertz, shapes = frame.frequencies(case.reference.chain(frame.STOREY))
    # Mass-normalised, as damping ratios want them.
    shapes = shapes / np.sqrt(np.einsum("im,i,im->m", shapes, frame.MASS,
                                        shapes))
    ratios = np.diag(shapes.T @ frame.damping_matrix() @ shapes) / (
        4 * np.pi * hertz)
    frequency = np.linspace(0.05, 49.0, 20000)
    force = np.abs(np.einsum("im,kij->kmj", shapes,
                             case.force_root(frequency, False)))**2
    return (hertz, shapes, ["u1", "u2", "u3"], (0.8, 17.0),
            shares(frequency, hertz, ratios, shapes, force.sum(axis=2)))


def frame_ambient(case):
    hertz, own, shared, sensors = case.modes_of({}, None)
    a0, a1 = case.FRAME.RAYLEIGH
    natural = 2 * np.pi * hertz
    frequency = np.linspace(0.05, 49.9, 20000)

    def density(size, corner):
        return size**2 / (corner * np.pi / 2) / (
            1 + (frequency[:, None] / corner)**2)

    force = (density(case.OWN, case.OWN_CORNER) * (own**2).sum(axis=0) +
             density(case.SHARED, case.SHARED_CORNER) *
             (shared**2).sum(axis=0))
    return (hertz, sensors, case.FRAME.SENSORS, (1.0, 40.0),
            shares(frequency, hertz, (a0 / natural + a1 * natural) / 2,
                   sensors, force))


def bridge_ambient(case):
    mass, parts = case.girder()
    built = sum((1 + case.TRUTH[name]) * part for name, part in parts.items())
    a0, a1 = case.rayleigh()
    damping = a0 * mass + a1 * sum(parts.values())
    hertz, ratios, shapes = case.modes(mass, damping, built)
    real = shapes.real / np.sqrt(np.einsum("im,ij,jm->m", shapes.real, mass,
                                           shapes.real))
    stations = sorted(set(sum(case.SETUPS.values(), [])))
    frequency = np.linspace(0.002, case.FLAT, 20000)
    force = np.abs(case.forces(frequency, np.random.default_rng(1)) @ real)**2
    sensors = case.sensors(stations)
    places = [f"1 w{node} + {arm} t{node}" for node in stations
              for arm in ("11", "-11")]
    return (hertz, sensors @ shapes, places, (0.2, 3.0),
            shares(frequency, hertz, ratios, sensors @ real, force))


def entry(entries, place):
    """Of a mode at a place; where the sensors of a station tell its DOFs apart
    these are reported, and 'a u + b v' is their sum."""
    if place in entries:
        return entries[place]
    words = place.split()
    if len(words) != 5 or not {words[1], words[4]} <= entries.keys():
        return np.nan
    return (float(words[0]) * entries[words[1]] +
            float(words[3]) * entries[words[4]])


def mac(a, b):
    return np.abs(np.vdot(a, b))**2 / (np.vdot(a, a).real * np.vdot(b, b).real)


def main():
    folder, name = sys.argv[1:3]
    hertz, shapes, places, band, share = globals()[name](generator(name))
    wanted = np.flatnonzero((hertz > band[0]) & (hertz < band[1]) &
                            (share > LEAST_SHARE))
    missed = {int(i): 0 for i in wanted}
    spurious, reported, records = [], 0, 0
    for path in sorted(glob.glob(os.path.join(folder, "*", "modes.json"))):
        with open(path, encoding="utf-8") as file:
            result = json.load(file)
        records += 1
        reported += len(result["modes"])
        pairs = []
        for m, mode in enumerate(result["modes"]):
            entries = {one["place"]: complex(one["real"], one["imaginary"])
                       for one in mode["shape"]}
            found = np.array([entry(entries, str(place)) for place in places])
            seen = np.isfinite(found)
            for i, f in enumerate(hertz):
                apart = abs(mode["frequency_hz"] / f - 1) + 0.1 * (
                    1 - mac(found[seen], shapes[seen, i]))
                if apart < APART:
                    pairs.append((apart, m, i))
        used, met = set(), set()
        for _, m, i in sorted(pairs):
            if m not in used and i not in met:
                used.add(m)
                met.add(i)
        for i in missed:
            missed[i] += i not in met
        spurious += [round(mode["frequency_hz"], 2)
                     for m, mode in enumerate(result["modes"])
                     if m not in used]
    total = records * len(wanted)
    print(f"{name}: {records} records, {len(wanted)} modes from {band[0]} to "
          f"{band[1]} Hz; missed {sum(missed.values())} of {total} "
          f"({100 * sum(missed.values()) / max(1, total):.1f} %), spurious "
          f"{len(spurious)} of {reported} reported "
          f"({100 * len(spurious) / max(1, reported):.1f} %)")
    for i, count in missed.items():
        if count:
            print(f"  {hertz[i]:.3f} Hz missed in {count}, share of power "
                  f"{100 * share[i]:.2g} %")
    if spurious:
        print("  spurious at", ", ".join(map(str, sorted(spurious))), "Hz")


if __name__ == "__main__":
    main()
