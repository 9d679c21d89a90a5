#!/usr/bin/env bash
# From a bare Debian 12 to the first report: installs what is missing, builds
# the programs, and follows a steel frame from its finite-element export over
# three healthy records to a verdict on a damaged one.
#
#   apps/quickstart.sh
#
# Runs from any directory and as often as you like; everything it makes is
# under build-quickstart/.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
cd -- "$root"
build=$root/build-quickstart
frame=data/frame

apps/install_packages.sh apps/packages.txt

jobs=$(nproc)
apps/new_compiler.sh "$build"
cmake --preset quickstart -DPINODE_UNITY_BATCH="$(apps/unity_batch.sh "$jobs")"
cmake --build --preset quickstart --parallel "$jobs"

began=$SECONDS
echo
echo "== pinode_check: modes, sizes, and what the sensors determine"
"$build/apps/pinode_check" --case="$frame/healthy_1.toml"

# The three side by side, each with one thread. What is started in the background
# does not hear of an interrupt.
baselines=
running=()
trap 'kill "${running[@]}" 2>/dev/null || true' EXIT
for number in 1 2 3; do
  folder=$build/frame_healthy_$number
  "$build/apps/pinode_update" --case="$frame/healthy_$number.toml" \
    --output_dir="$folder" --overwrite --threads=1 --progress=false \
    >"$folder.log" 2>&1 &
  running+=($!)
  baselines+=${baselines:+,}$folder
done
for number in 1 2 3; do
  status=0
  wait "${running[number - 1]}" || status=$?
  echo
  echo "== pinode_update: baseline record $number"
  cat "$build/frame_healthy_$number.log"
  [[ $status -eq 0 ]] || exit "$status"
done
trap - EXIT

echo
echo "== pinode_damage: a record after a column lost a fifth of its stiffness"
"$build/apps/pinode_damage" --baseline="$baselines" \
  --case="$frame/column_20.toml" --output_dir="$build/frame_damage" --overwrite

echo
echo "From sensors to verdict in $((SECONDS - began)) s."
echo "The report: $build/frame_damage/report.html"
