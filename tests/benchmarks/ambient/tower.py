#!/usr/bin/env python3
"""tower.py FOLDER HOURS: a shear building of 15 storeys under coloured forces
at all floors, which nobody measures; accelerations of 12 floors at 20 Hz, 2 %
noise, and a case for them. Made in the frequency domain, as data/
three_storey_ambient/generate.py does."""

import os
import sys

import numpy as np

STOREYS, RATE, NOISE = 15, 20.0, 0.02
MASS, STIFFNESS = 2.0e5, 3.2e8
FREE = range(1, 13)
SENSORS = [1, 2, 3, 4, 5, 7, 8, 9, 11, 12, 13, 15]

folder, hours = sys.argv[1], float(sys.argv[2])
os.makedirs(folder, exist_ok=True)
rng = np.random.default_rng(5)
change = rng.uniform(-0.1, 0.1, STOREYS)
change[[i for i in range(STOREYS) if i + 1 not in FREE]] = 0.0
springs = STIFFNESS * (1 + change)
k = np.diag(springs)
k[:-1, :-1] += np.diag(springs[1:])
k -= np.diag(springs[1:], 1) + np.diag(springs[1:], -1)
values, shapes = np.linalg.eigh(k / MASS)
natural = np.sqrt(values)
a0, a1 = 0.06, 0.0009  # about one per cent
samples = int(hours * 3600 * RATE)
period = 2 * samples
frequency = np.fft.rfftfreq(period, 1 / RATE)[1:-1]
spectrum = np.zeros((period // 2 + 1, len(SENSORS)), dtype=complex)
for begin in range(0, len(frequency), 100000):
    f = frequency[begin:begin + 100000]
    w = 2 * np.pi * f[:, None]
    normal = rng.standard_normal((len(f), STOREYS, 2)) @ [1, 1j]
    normal += rng.standard_normal((len(f), 1, 2)) @ [1, 1j]  # shared
    force = normal / (1 + (f[:, None] / 0.5)**2)**(5 / 12)
    modal = (force @ shapes) / (
        natural**2 - w**2 + 1j * w * (a0 + a1 * natural**2))
    spectrum[1 + begin:1 + begin + len(f)] = (
        -w**2 * modal) @ shapes[[s - 1 for s in SENSORS]].T
values = np.fft.irfft(spectrum, period, axis=0)[:samples]
values /= values.std()
values += NOISE * values.std(axis=0) * rng.standard_normal(values.shape)
with open(os.path.join(folder, "record.csv"), "w", encoding="ascii") as file:
    file.write(",".join(f"a{s}" for s in SENSORS) + "\n")
    np.savetxt(file, values, fmt="%.5g", delimiter=",")
lines = ['[units]', 'force = "N"', 'length = "m"', 'time = "s"', '[model]',
         'damping = {rayleigh = [0.08, 0.0007]}', '[model.shear_building]',
         'masses = [%s]' % ", ".join([str(MASS)] * STOREYS),
         'stiffnesses = [%s]' % ", ".join([str(STIFFNESS)] * STOREYS)]
for storey in FREE:
    lines += ['[[group]]', f'name = "k{storey}"', 'adds_to = "stiffness"',
              f'storey = {storey}', 'lower = -0.9']
for of, scale in (("mass", 0.08), ("stiffness", 0.0007)):
    lines += ['[[group]]', f'name = "c_{of}"', 'adds_to = "damping"',
              f'proportional_to = "{of}"', f'scale = {scale}', 'lower = -0.99']
lines += ['[[record]]', 'name = "ambient"', 'file = "record.csv"',
          f'sampling_rate_hz = {RATE}', 'excitation = "ambient"']
for s in SENSORS:
    lines += ['  [[record.channel]]', f'  column = "a{s}"', f'  dof = "u{s}"',
              '  quantity = "absolute_acceleration"', '  unit = "m/s^2"']
with open(os.path.join(folder, "tower.toml"), "w", encoding="utf-8") as file:
    file.write("\n".join(lines) + "\n")
np.savetxt(os.path.join(folder, "truth.csv"), change)
