#!/usr/bin/env bash
# Storeys from wind that nobody measured, over many realisations: how often the
# 95 % intervals of data/three_storey_ambient hold the truth, and how far the
# errors are from the Cramer-Rao bound of the spectrum that acted.
#
#   tests/benchmarks/ambient.sh [SEEDS [--white [--peak DB] |
#                                       --shaker KIND RATIO [--gain G]]]
#
# --white: forces that are white and independent, as the case then says; with
# --peak they are stronger at 5 Hz, and the case says that they are independent.
# --shaker: a measured force beside the wind (KIND noise, sweep or blows), whose
# response is RATIO times as strong; the bound is that of the wind alone. --gain:
# what is recorded of that force, times G. NumPy and SciPy, of PYTHON, default
# python3.
set -euo pipefail

seeds=${1:-100}
options=${*:2}
cases="three_storey_ambient independent"
if [[ $options == *--shaker* ]]; then cases=shaker; fi
if [[ $options == *--peak* ]]; then cases=uncorrelated; fi
source "$(dirname -- "${BASH_SOURCE[0]}")/ambient/setup.sh" \
  "numpy, scipy" pinode_update

# run SEED: its records, and the fit of each of the case's descriptions.
run() {
  local seed=$1 folder=$work/$1
  "${PYTHON:-python3}" data/three_storey_ambient/generate.py \
    --output "$folder" --seed "$seed" $options
  # The same record by a case that takes the loads as white and independent.
  sed 's/^excitation = "ambient"/&\n[record.ambient]\nknots = 1\ncorrelated = false/' \
    "$folder/three_storey_ambient.toml" >"$folder/independent.toml"
  sed '/^knots = 1$/d' "$folder/independent.toml" >"$folder/uncorrelated.toml"
  for case in $cases; do
    "$build/apps/pinode_update" --case="$folder/$case.toml" --threads=1 \
      --output_dir="$folder/$case" --noprogress >/dev/null 2>&1 || true
  done
  rm -f "$folder/wind.csv.gz"
}
export -f run
export work build options cases PYTHON
seq "$seeds" | xargs -P "$(nproc)" -I{} bash -c 'run {}'
"${PYTHON:-python3}" tests/benchmarks/ambient/score.py "$work" $options
