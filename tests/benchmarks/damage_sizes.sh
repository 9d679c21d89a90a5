#!/usr/bin/env bash
# Sizes of damage, over many realisations of damage_sizes.py: how often the true
# place is among the explanations of pinode_damage, and how often its 95 %
# interval holds the true loss of 5 to 50 %.
#
#   tests/benchmarks/damage_sizes.sh [SEEDS [FIRST [KIND...]]]
#
# KIND: supported and cantilever (a beam's frequencies alone), frame (records);
# default all. NumPy and SciPy, of PYTHON, default python3.
set -euo pipefail

seeds=${1:-25}
first=${2:-1}
kinds=("${@:3}")
if ((${#kinds[@]} == 0)); then kinds=(supported cantilever frame); fi
source "$(dirname -- "${BASH_SOURCE[0]}")/ambient/setup.sh" \
  "numpy, scipy" pinode_update pinode_damage_program

run() {
  local folder=$work/$1_$2
  rm -rf -- "$folder"
  "${PYTHON:-python3}" tests/benchmarks/damage_sizes.py make "$1" "$2" "$folder"
  "$build/apps/pinode_update" --case="$folder/healthy.toml" --threads=1 \
    --output_dir="$folder/D" --noprogress >/dev/null 2>&1 || true
  "$build/apps/pinode_damage" --baseline="$folder/D" \
    --case="$folder/damaged.toml" --threads=1 --output_dir="$folder/E" \
    --noprogress >/dev/null 2>&1 || true
}
export -f run
export work build PYTHON
for kind in "${kinds[@]}"; do
  seq "$first" "$((first + seeds - 1))" |
    xargs -P "${JOBS:-$(nproc)}" -I{} bash -c "run $kind {}"
done
"${PYTHON:-python3}" tests/benchmarks/damage_sizes.py score "$work"/*
