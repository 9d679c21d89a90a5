#!/usr/bin/env bash
# Updates the frame of 1620 DOFs in data/frame from frequency response functions
# of six sensors and one hammer: seconds, errors and coverage of 12 groups.
#
#   tests/benchmarks/frame_frf.sh PROGRAM [DRAWS]
#
# PROGRAM is pinode_update. Needs NumPy and SciPy (PYTHON, default python3).
set -euo pipefail

program=$(realpath -- "$1")
draws=${2:-5}
python=${PYTHON:-python3}
here=$(cd -- "$(dirname -- "$0")" && pwd)
frame=$(realpath -- "$here/../../data/frame")
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT

results=()
for ((seed = 1; seed <= draws; ++seed)); do
  "$python" "$here/frame_frf.py" make "$folder/$seed" "$seed" "$frame"
  "$program" --case="$folder/$seed/case.toml" --output_dir="$folder/$seed/out" \
    --progress=false >"$folder/log" 2>&1 || [[ $? == 1 ]] ||
    { cat "$folder/log"; exit 1; }
  results+=("$folder/$seed/out")
done
"$python" "$here/frame_frf.py" score "$frame" "${results[@]}"
