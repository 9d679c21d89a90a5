#!/usr/bin/env bash
# A small loss in the steel frame from forces that nobody measured
# (data/frame_ambient): columns_1_east less 3 % against three ambient baselines,
# and healthy records, by pinode_damage as it comes: from the likelihood of the
# records, and from their modes alone (pinode_modes, [[mode]] with covariances).
#
#   tests/benchmarks/frame_ambient.sh [SETS [DAMAGED [HEALTHY [WAYS]]]]
#
# SETS of three baselines (default 4), and so many runs against each (default 25
# and 50); WAYS: "ambient modes" (default) or one of the two. NumPy and SciPy, of
# PYTHON, default python3. With KEEP=FOLDER the verdicts stay there, and what
# is there already is not made again.
set -euo pipefail

sets=${1:-4}
damaged=${2:-25}
healthy=${3:-50}
ways=${4:-ambient modes}
source "$(dirname -- "${BASH_SOURCE[0]}")/ambient/setup.sh" \
  "numpy, scipy" pinode_update pinode_damage_program pinode_modes
mkdir -p "$work/results"

# make FOLDER SEED [CHANGE]
make() {
  "${PYTHON:-python3}" data/frame_ambient/generate.py --output "$1" \
    --seed "$2" --cache "$work/modes" ${3:+--change "$3"}
}
# The case of modes alone from a record's case.
find_modes() {
  "$build/apps/pinode_modes" --case="$1/frame_ambient.toml" \
    --output_dir="$1/identified" >/dev/null 2>&1 || true
  cat "$1/frame_modes.toml" "$1/identified/modes.toml" >"$1/frame_by_modes.toml"
}
case_of() {
  [[ $1 == ambient ]] && echo frame_ambient || echo frame_by_modes
}
baseline() {
  local folder=$work/baseline_$1_$2 way
  [[ ! -e $folder/done ]] || return 0
  make "$folder" $((1000 * $1 + $2))
  for way in $ways; do
    [[ $way == ambient ]] || find_modes "$folder"
    "$build/apps/pinode_update" --case="$folder/$(case_of "$way").toml" \
      --threads=1 --output_dir="$folder/$way" --noprogress >/dev/null 2>&1 || true
  done
  touch "$folder/done"
}
# run KIND SET NUMBER
run() {
  local folder=$work/$1_$2_$3 change='' seed=$((1000 * $2 + 100 + $3)) way
  [[ ! -e $work/results/$1_$2_$3.done ]] || return 0
  if [[ $1 == damaged ]]; then
    change=columns_1_east=-0.03
    seed=$((seed + 400))
  fi
  rm -rf "$folder"
  make "$folder" "$seed" $change
  local from=$work/baseline_$2
  for way in $ways; do
    [[ $way == ambient ]] || find_modes "$folder"
    "$build/apps/pinode_damage" \
      --baseline="${from}_1/$way,${from}_2/$way,${from}_3/$way" --threads=1 \
      --case="$folder/$(case_of "$way").toml" --output_dir="$folder/$way" \
      --noprogress >"$folder/$way.log" 2>&1 || true
    if [[ -e $folder/$way/damage.json ]]; then
      cp "$folder/$way/damage.json" "$work/results/${way}_$1_$2_$3.json"
    else
      cp "$folder/$way.log" "$work/results/${way}_$1_$2_$3.none"
    fi
  done
  rm -rf "$folder"
  touch "$work/results/$1_$2_$3.done"
}
export -f make find_modes case_of baseline run
export work build ways PYTHON
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
for way in $ways; do
  echo "by $way:"
  "${PYTHON:-python3}" tests/benchmarks/ambient/score_damage.py \
    "$work/results" "$way" columns_1_east -0.03
done
