#!/usr/bin/env bash
# Modes that pinode_modes, as it comes, misses in the ambient cases of data/, and
# modes that it sees and that are not there, over realisations.
#
#   tests/benchmarks/ambient_modes.sh [SEEDS [CASE...]]
#
# CASE: three_storey_ambient, frame_ambient, bridge_ambient; default all. NumPy
# and SciPy, of PYTHON, default python3. With KEEP=FOLDER the modes stay there,
# and what is there already is not made again.
set -euo pipefail

seeds=${1:-100}
shift || true
cases=${*:-three_storey_ambient frame_ambient bridge_ambient}
source "$(dirname -- "${BASH_SOURCE[0]}")/ambient/setup.sh" \
  "numpy, scipy" pinode_modes

# run CASE SEED: leaves modes.json.
run() {
  local folder=$work/$1/$2 cache=()
  [[ ! -e $folder/modes.json ]] || return 0
  [[ $1 != frame_ambient ]] || cache=(--cache "$work/cache")
  rm -rf "$folder"
  mkdir -p "$folder"
  "${PYTHON:-python3}" "data/$1/generate.py" --output "$folder/made" \
    --seed "$2" "${cache[@]}"
  "$build/apps/pinode_modes" --case="$folder/made/$1.toml" \
    --output_dir="$folder/found" >"$folder/log" 2>&1 || true
  [[ ! -e $folder/found/modes.json ]] ||
    cp "$folder/found/modes.json" "$folder/modes.json"
  rm -rf "$folder/made" "$folder/found"
}
export -f run
export work build PYTHON
for case in $cases; do
  run "$case" 1
  for seed in $(seq 2 "$seeds"); do echo "$case $seed"; done |
    xargs -r -P "$(nproc)" -L1 bash -c 'run "$0" "$1"'
  "${PYTHON:-python3}" tests/benchmarks/ambient/score_modes.py "$work/$case" \
    "$case"
done
