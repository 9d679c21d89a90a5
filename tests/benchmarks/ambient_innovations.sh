#!/usr/bin/env bash
# Storeys from loads that nobody measured, by the likelihood of spectra, which is
# pinode's, and by that of the innovations of a Kalman filter (SciPy), over many
# realisations: intervals that hold the truth, errors, and how far apart the two
# are.
#
#   tests/benchmarks/ambient_innovations.sh [SEEDS]
#
# NumPy and SciPy, of PYTHON, default python3.
set -euo pipefail

seeds=${1:-40}
source "$(dirname -- "${BASH_SOURCE[0]}")/ambient/setup.sh" \
  "numpy, scipy" pinode_update
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

run() {
  local folder=$work/$1
  "${PYTHON:-python3}" data/three_storey_ambient/generate.py \
    --output "$folder" --seed "$1" --white
  innovations=tests/benchmarks/ambient/innovations.py
  "${PYTHON:-python3}" "$innovations" make "$folder" "$1"
  "${PYTHON:-python3}" "$innovations" fit "$folder"
  for case in independent three_storey_ambient; do
    "$build/apps/pinode_update" --case="$folder/$case.toml" --threads=1 \
      --output_dir="$folder/$case" --noprogress >/dev/null 2>&1 || true
  done
  rm -f "$folder/wind.csv.gz"
}
export -f run
export work build PYTHON
seq "$seeds" | xargs -P "$(nproc)" -I{} bash -c 'run {}'
"${PYTHON:-python3}" tests/benchmarks/ambient/innovations.py score "$work"
