#!/usr/bin/env bash
# A frame that follows the temperature, under wind that nobody measured, over
# many realisations of data/three_storey_ambient/seasons.py: whether the 95 %
# intervals of a baseline of three records (-5, 8 and 21 deg C) hold the truth;
# and what pinode_damage says against it of one record at another temperature,
# healthy and with 2 % of the second storey's stiffness lost.
#
#   tests/benchmarks/seasons.sh [SEEDS [TEMPERATURE [FIRST]]]
#
# FIRST: the first of the seeds, default 1. NumPy and SciPy, of PYTHON, default python3.
set -euo pipefail

seeds=${1:-100}
degrees=${2:--12}
first=${3:-1}
source "$(dirname -- "${BASH_SOURCE[0]}")/ambient/setup.sh" \
  "numpy, scipy" pinode_update pinode_damage_program

# records FOLDER SEED TEMPERATURES LOSS
records() {
  "${PYTHON:-python3}" data/three_storey_ambient/seasons.py --output "$1" \
    --seed "$2" --temperatures $3 --loss 2 "$4"
}
run() {
  local folder=$work/$1
  records "$folder/baseline" "$1" "-5 8 21" 0
  "$build/apps/pinode_update" --case="$folder/baseline/seasons.toml" \
    --threads=1 --output_dir="$folder/baseline/result" --noprogress \
    >/dev/null 2>&1 || true
  for state in healthy damaged; do
    local loss=0
    if [[ $state == damaged ]]; then loss=0.02; fi
    records "$folder/$state" "5$1" "$degrees" "$loss"
    "$build/apps/pinode_damage" --baseline="$folder/baseline/result" \
      --case="$folder/$state/seasons.toml" --threads=1 \
      --output_dir="$folder/$state/result" --noprogress >/dev/null 2>&1 || true
  done
  find "$folder" -name '*.gz' -delete
}
export -f run records
export work build degrees PYTHON
seq "$first" "$((first + seeds - 1))" | xargs -P "$(nproc)" -I{} bash -c 'run {}'
"${PYTHON:-python3}" tests/benchmarks/ambient/score_seasons.py "$work"
