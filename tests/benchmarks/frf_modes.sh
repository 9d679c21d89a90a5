#!/usr/bin/env bash
# Modes of drawn FRFs: coverage of the intervals, errors over the Cramer-Rao
# bound, and the same for LSCF + LSFD in NumPy.
#
#   tests/benchmarks/frf_modes.sh PROGRAM [DRAWS]
#
# PROGRAM is pinode_modes. Needs NumPy (PYTHON, default python3).
set -euo pipefail

program=$(realpath -- "$1")
draws=${2:-100}
python=${PYTHON:-python3}
here=$(cd -- "$(dirname -- "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT

for noise in channel line; do
  mkdir "$folder/$noise"
  for ((seed = 0; seed < draws; ++seed)); do
    "$python" "$here/frf_modes.py" draw "$folder" "$seed" "$noise"
    "$program" --frf="$(printf "$folder/u%d.txt," 1 2 3 4 5)$folder/u6.txt" \
      --frf_responses=u1,u2,u3,u4,u5,u6 --frf_references=u1 \
      --frf_quantity=acceleration --output_dir="$folder/$noise/$seed" \
      >"$folder/log" || { cat "$folder/log"; exit 1; }
  done
  "$python" "$here/frf_modes.py" score "$folder/$noise" "$draws" "$noise"
done
