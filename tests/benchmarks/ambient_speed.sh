#!/usr/bin/env bash
# What a likelihood fit of an ambient record costs: a shear building of 15
# storeys, 12 of them free, 12 accelerometers at 20 Hz, one hour and four; CPU
# seconds of one thread and peak memory of the whole program. Memory is flat but
# for the record itself (file and samples).
#
#   tests/benchmarks/ambient_speed.sh
#
# NumPy, of PYTHON, default python3.
set -euo pipefail

source "$(dirname -- "${BASH_SOURCE[0]}")/ambient/setup.sh" \
  "numpy" pinode_update
for hours in 1 4; do
  "${PYTHON:-python3}" tests/benchmarks/ambient/tower.py "$work/$hours" "$hours"
  "${PYTHON:-python3}" tests/benchmarks/ambient/time_program.py \
    "$hours h, fit" "$build/apps/pinode_update" \
    "--case=$work/$hours/tower.toml" "--output_dir=$work/$hours/out" \
    --threads=1 --noprogress
  "${PYTHON:-python3}" tests/benchmarks/ambient/time_program.py \
    "$hours h, check alone" "$build/apps/pinode_check" \
    "--case=$work/$hours/tower.toml"
done
