#!/usr/bin/env bash
# Structures of any size: pinode_update, sensors to report, beside a program
# that was written for these linear shear buildings alone and does nothing but
# their fit; with cubic springs (20cubic) beside itself by Runge-Kutta with half
# the steps that it would choose. CPU seconds of one thread, peak memory, and
# the ratio.
#
#   tests/benchmarks/scale.sh [CASE ...]
#
# CASE is one of 20, 20cubic, 100, 100long, 100wide, 10long. Generator and reference are
# those of PINODE_SCALE (default: ../shared/scale beside the project; NumPy and
# SciPy, of PYTHON, default python3); without them there is nothing to do.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
cd -- "$root"
scale=${PINODE_SCALE:-$root/../shared/scale}
if [[ ! -f $scale/generate.py ]] ||
  ! "${PYTHON:-python3}" -c 'import numpy, scipy' 2>/dev/null; then
  echo "skipped: no generator in $scale (PINODE_SCALE), or no SciPy"
  exit 0
fi

build=${PINODE_BUILD_DIR:-build-release}
if [[ -z ${PINODE_BUILD_DIR:-} ]]; then
  apps/install_packages.sh apps/packages.txt tests/packages.txt
  cmake --preset release >/dev/null
  cmake --build --preset release --parallel "$(nproc)" --target pinode_update
fi

work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
"${CXX:-c++}" -O3 -march=native -I/usr/include/eigen3 \
  "$scale/linear_limit.cc" -o "$work/linear_limit"

# cpu OUTPUT COMMAND...: CPU seconds of a command; what it prints to OUTPUT.
cpu() {
  local output=$1 user system TIMEFORMAT='%U %S'
  shift
  read -r user system < <({ time "$@" >"$output" 2>"$output.err"; } 2>&1)
  awk -v a="$user" -v b="$system" 'BEGIN {printf "%.2f", a + b}'
}

printf '%-9s %9s %9s %9s %7s  %s\n' case pinode reference ratio MB verdict
# run NAME ARGUMENT...: of the generator.
run() {
  local name=$1 ours theirs memory=-
  shift
  "${PYTHON:-python3}" "$scale/generate.py" "$@" --output "$work/$name" >/dev/null
  local update=("$build/apps/pinode_update" --case="$work/$name/case.toml"
    --output_dir="$work/out" --overwrite --progress=false --threads=1)
  ours=$(cpu "$work/ours" "${update[@]}")
  if [[ $* == *--cubic* ]]; then
    sed 's/^\[\[record\]\]/[[record]]\nintegrator = "rk4"\nsubsteps = 8/' \
      "$work/$name/case.toml" >"$work/$name/rk4.toml"
    theirs=$(cpu "$work/theirs" "${update[@]/case.toml/rk4.toml}")
  else
    theirs=$(cpu "$work/theirs" "$work/linear_limit" "$work/$name")
  fi
  if [[ -x /usr/bin/time ]]; then
    /usr/bin/time -f %M -o "$work/memory" "${update[@]}" >/dev/null 2>&1
    memory=$(awk '{printf "%.0f", $1 / 1024}' "$work/memory")
  fi
  printf '%-9s %9s %9s %9s %7s  %s\n' "$name" "$ours" "$theirs" \
    "$(awk -v a="$ours" -v b="$theirs" 'BEGIN {printf "%.1f", a / b}')" \
    "$memory" "$(grep -m 1 -oE '^(Not u|U)sable' "$work/ours" || echo none)"
  rm -rf -- "${work:?}/$name" "$work/out"
}

all="20 20cubic 100 100long 100wide 10long"
for each in "${@:-$all}"; do
  for name in $each; do
    case $name in
      20) run 20 --storeys 20 --samples 6000 ;;
      20cubic) run 20cubic --storeys 20 --samples 6000 --cubic 3,9,15 ;;
      100) run 100 --storeys 100 --samples 20000 --sensors 20 --groups 20 \
        --spread 0.1 ;;
      100long) run 100long --storeys 100 --samples 100000 --sensors 20 \
        --groups 20 --spread 0.1 ;;
      100wide) run 100wide --storeys 100 --samples 20000 --sensors 100 \
        --groups 100 --spread 0.02 ;;
      10long) run 10long --storeys 10 --samples 1000000 ;;
      *)
        echo "no case '$name', expected one of $all" >&2
        exit 2
        ;;
    esac
  done
done
