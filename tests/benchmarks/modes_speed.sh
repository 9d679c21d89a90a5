#!/usr/bin/env bash
# Modes with uncertainty of 16 channels, 30 min at 100 Hz, orders 2 to 60: CPU
# seconds of one thread of pinode_modes, reading its file and writing its report
# included, and of the same published algorithm in NumPy on samples in memory.
#
#   tests/benchmarks/modes_speed.sh
#
# NumPy, of PYTHON, default python3.
set -euo pipefail

source "$(dirname -- "${BASH_SOURCE[0]}")/ambient/setup.sh" \
  "numpy" pinode_modes
"${PYTHON:-python3}" - "$work" <<'PY'
import sys
import numpy as np
folder = sys.argv[1]
rng = np.random.default_rng(3)
masses, rate, count = 16, 100.0, 180000
k = 2 * np.eye(masses) - np.eye(masses, k=1) - np.eye(masses, k=-1)
k[-1, -1] = 1
values, shapes = np.linalg.eigh(k)
natural = np.sqrt(values) * 2 * np.pi * 38 / np.sqrt(values[-1])
period = 2 * count
f = np.fft.rfftfreq(period, 1 / rate)[1:-1]
spectrum = np.zeros((period // 2 + 1, masses), dtype=complex)
for begin in range(0, len(f), 50000):
    w = 2 * np.pi * f[begin:begin + 50000, None]
    force = rng.standard_normal((len(w), masses, 2)) @ [1, 1j]
    spectrum[1 + begin:1 + begin + len(w)] = (
        -w**2 * (force @ shapes) /
        (natural**2 - w**2 + 0.02j * w * natural)) @ shapes.T
x = np.fft.irfft(spectrum, period, axis=0)[:count]
x += 0.05 * x.std() * rng.standard_normal(x.shape)
np.save(folder + "/record.npy", np.ascontiguousarray(x.T))
np.savetxt(folder + "/record.csv", x, fmt="%.6g", delimiter=",", comments="",
           header=",".join(f"a{i + 1}" for i in range(masses)))
lines = ['[units]', 'force = "N"', 'length = "m"', 'time = "s"', '[modes]',
         # One rate, for NumPy looks at one.
         'lowest_hz = 10.0', 'max_order = 60', '[[record]]', 'name = "chain"',
         'file = "record.csv"', 'sampling_rate_hz = 100']
for i in range(masses):
    lines += ['  [[record.channel]]', f'  column = "a{i + 1}"',
              '  quantity = "absolute_acceleration"', '  unit = "m/s^2"']
open(folder + "/chain.toml", "w").write("\n".join(lines) + "\n")
PY
"${PYTHON:-python3}" tests/benchmarks/ambient/time_program.py pinode_modes \
  "$build/apps/pinode_modes" "--case=$work/chain.toml" \
  "--output_dir=$work/out" --threads=1
"${PYTHON:-python3}" - "$work/out/modes.json" <<'PY'
import json
import sys
with open(sys.argv[1], encoding="utf-8") as file:
    modes = json.load(file)["modes"]
print("pinode:", ", ".join("%.3f (%.1e)" % (m["frequency_hz"], m["frequency_sigma"])
                           for m in modes))
PY
"${PYTHON:-python3}" tests/benchmarks/ambient/subspace.py "$work/record.npy" 100
