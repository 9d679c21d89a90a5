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

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
cd -- "$root"
if ! "${PYTHON:-python3}" -c 'import numpy' 2>/dev/null; then
  echo "skipped: no NumPy"
  exit 0
fi
build=${PINODE_BUILD_DIR:-build-release}
if [[ -z ${PINODE_BUILD_DIR:-} ]]; then
  apps/install_packages.sh apps/packages.txt tests/packages.txt
  cmake --preset release >/dev/null
  cmake --build --preset release --parallel "$(nproc)" --target pinode_update
fi
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
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
