#!/usr/bin/env bash
# A small loss in the steel frame from forces that nobody measured
# (data/frame_ambient): columns_1_east less 3 % against three ambient baselines,
# and healthy records, by pinode_damage as it comes.
#
#   tests/benchmarks/frame_ambient.sh [SETS [DAMAGED [HEALTHY]]]
#
# SETS of three baselines (default 4), and so many runs against each (default 25
# and 50). Some 30 s of one core a run. NumPy and SciPy, of PYTHON, default
# python3.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
cd -- "$root"
sets=${1:-4}
damaged=${2:-25}
healthy=${3:-50}
if ! "${PYTHON:-python3}" -c 'import numpy, scipy' 2>/dev/null; then
  echo "skipped: no SciPy"
  exit 0
fi
build=${PINODE_BUILD_DIR:-build-release}
if [[ -z ${PINODE_BUILD_DIR:-} ]]; then
  apps/install_packages.sh apps/packages.txt tests/packages.txt
  cmake --preset release >/dev/null
  cmake --build --preset release --parallel "$(nproc)" \
    --target pinode_update pinode_damage_program
fi
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT

# make FOLDER SEED [CHANGE]
make() {
  "${PYTHON:-python3}" data/frame_ambient/generate.py --output "$1" \
    --seed "$2" --cache "$work/modes" ${3:+--change "$3"}
}
baseline() {
  local folder=$work/baseline_$1_$2
  make "$folder" $((1000 * $1 + $2))
  "$build/apps/pinode_update" --case="$folder/frame_ambient.toml" --threads=1 \
    --output_dir="$folder/out" --noprogress >/dev/null 2>&1 || true
}
# run KIND SET NUMBER
run() {
  local folder=$work/$1_$2_$3 change='' seed=$((1000 * $2 + 100 + $3))
  if [[ $1 == damaged ]]; then
    change=columns_1_east=-0.03
    seed=$((seed + 400))
  fi
  make "$folder" "$seed" $change
  local from=$work/baseline_$2
  "$build/apps/pinode_damage" \
    --baseline="${from}_1/out,${from}_2/out,${from}_3/out" --threads=1 \
    --case="$folder/frame_ambient.toml" --output_dir="$folder/out" \
    --noprogress >/dev/null 2>&1 || true
  mkdir -p "$work/results"
  cp "$folder/out/damage.json" "$work/results/$1_$2_$3.json" || true
  rm -rf "$folder"
}
export -f make baseline run
export work build PYTHON
# The modes of both states are kept before runs share them.
make "$work/first" 1
make "$work/first" 1 columns_1_east=-0.03
for set in $(seq "$sets"); do
  for n in 1 2 3; do echo "$set $n"; done
done | xargs -P "$(nproc)" -L1 bash -c 'baseline "$0" "$1"'
for set in $(seq "$sets"); do
  for n in $(seq "$damaged"); do echo "damaged $set $n"; done
  for n in $(seq "$healthy"); do echo "healthy $set $n"; done
done | xargs -P "$(nproc)" -L1 bash -c 'run "$0" "$1" "$2"'
"${PYTHON:-python3}" tests/benchmarks/ambient/score_damage.py \
  "$work/results" columns_1_east -0.03
