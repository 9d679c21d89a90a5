#!/usr/bin/env bash
# The same fit on one thread, on several, and on several ranks of an MPI job:
# seconds of wall time an iteration and for all of them, how many times faster
# than one thread, and by how much the parameters differ. Rounds of all in turns
# (PINODE_ROUNDS, 5), of which medians. The rows "apart" are so many processes
# that know nothing of each other: how many times one thread's work the machine
# does at the same time, which no sharing can pass.
#
#   tests/benchmarks/ranks.sh [CASE_FILE ...]
#
# Without a case: a hundred storeys with 100 000 samples (generator as for
# scale.sh) and case 1's third scheme, whose network's Gram matrix is large.
# PINODE_WORKERS (default: "2") says how many threads and ranks are tried.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
cd -- "$root"
build=${PINODE_BUILD_DIR:-build-release}
if [[ -z ${PINODE_BUILD_DIR:-} ]]; then
  apps/install_packages.sh apps/packages.txt tests/packages.txt
  cmake --preset release >/dev/null
  cmake --build --preset release --parallel "$(nproc)" --target pinode_update
fi
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1

work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
cases=("$@")
if [[ ${#cases[@]} -eq 0 ]]; then
  cases=(data/four_dof_free/scheme3.toml)
  scale=${PINODE_SCALE:-$root/../shared/scale}
  if [[ -f $scale/generate.py ]] &&
    "${PYTHON:-python3}" -c 'import numpy' 2>/dev/null; then
    "${PYTHON:-python3}" "$scale/generate.py" --storeys 100 --samples 100000 \
      --sensors 20 --groups 20 --spread 0.1 --output "$work/100long" >/dev/null
    cases=("$work/100long/case.toml" "${cases[@]}")
  fi
fi

# Seconds an iteration, and for all, in folder $1.
times() {
  awk -F, 'NR == 2 {first = $10} {last = $10}
    END {printf "%.4f %.2f", (last - first) / (NR - 2), last}' "$1/history.csv"
}
# The largest difference of a parameter, by its size or 1e-3.
difference() {
  paste -d, <(cut -d, -f4 "$work/one/parameters.csv") \
    <(cut -d, -f4 "$1/parameters.csv") | awk -F, '
    NR > 1 {
      size = ($1 < 0 ? -$1 : $1) + 1e-3
      off = ($1 > $2 ? $1 - $2 : $2 - $1) / size
      if (off > most) most = off
    }
    END {printf "%.1e", most}'
}
# Of the numbers in column $2 of file $1.
median() {
  awk -v c="$2" '{print $c}' "$1" | sort -g |
    awk '{v[NR] = $1} END {print v[int((NR + 1) / 2)]}'
}
# One run of `what`, whose times go to their file.
run() {
  local what=$1 folder=$2
  shift 2
  "$@" --output_dir="$folder" >/dev/null 2>&1 || true
  { times "$folder"; echo; } >>"$work/$what"
}
# What several processes that have nothing to do with each other take at the
# same time: more than one alone where they share memory or a core.
side_by_side() {
  local count=$1
  for ((k = 1; k <= count; ++k)); do
    "${update[@]}" --threads=1 --output_dir="$work/apart$k" \
      >/dev/null 2>&1 &
  done
  wait
  for ((k = 1; k <= count; ++k)); do
    { times "$work/apart$k"; echo; } >>"$work/$count apart"
  done
}
show() {
  local what=$1 folder=$2 each all share=${3:-1}
  each=$(median "$work/$what" 1) all=$(median "$work/$what" 2)
  printf '  %-10s %10s %8s %8s %8s  %s\n' "$what" "$each" "$all" \
    "$(awk -v a="$one_each" -v b="$each" -v s="$share" \
      'BEGIN {printf "%.2f", s * a / b}')" \
    "$(awk -v a="$one_all" -v b="$all" -v s="$share" \
      'BEGIN {printf "%.2f", s * a / b}')" \
    "$(difference "$folder")"
}

for case in "${cases[@]}"; do
  echo "$case"
  printf '  %-10s %10s %8s %8s %8s  %s\n' '' 's each' 's all' times times differs
  update=("$build/apps/pinode_update" --case="$case" --overwrite
    --progress=false)
  rm -f -- "$work"/*' thread'* "$work"/*' ranks' "$work"/*' apart'
  for ((round = 1; round <= ${PINODE_ROUNDS:-5}; ++round)); do
    run '1 thread' "$work/one" "${update[@]}" --threads=1
    for count in ${PINODE_WORKERS:-2}; do
      run "$count threads" "$work/threads$count" "${update[@]}" \
        --threads="$count"
      run "$count ranks" "$work/ranks$count" mpirun -n "$count" \
        "${update[@]}" --threads=1
      side_by_side "$count"
    done
  done
  one_each=$(median "$work/1 thread" 1) one_all=$(median "$work/1 thread" 2)
  show '1 thread' "$work/one"
  for count in ${PINODE_WORKERS:-2}; do
    show "$count threads" "$work/threads$count"
    show "$count ranks" "$work/ranks$count"
    show "$count apart" "$work/apart1" "$count"
  done
done
