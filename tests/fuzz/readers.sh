#!/usr/bin/env bash
# Fuzzes the readers of files, one after the other, under the sanitizers.
#
#   tests/fuzz/readers.sh [SECONDS [NAME...]]
#
# SECONDS is the time of each reader, 600 unless given. Without names every
# reader of corpus/ runs. The fuzzers are built by clang in build-fuzz, or in
# the folder that PINODE_FUZZ_BUILD names. Each starts from its committed corpus
# and from what earlier runs found, which stays in BUILD/fuzz/NAME/inputs. It
# stops at its first finding; the file that shows it stays beside the log in
# BUILD/fuzz/NAME. Prints one table; exits 1 if there is a finding.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
corpus=$root/tests/fuzz/corpus
build=${PINODE_FUZZ_BUILD:-$root/build-fuzz}
seconds=${1:-600}
if [[ ! $seconds =~ ^[1-9][0-9]*$ ]]; then
  echo "usage: $0 [SECONDS [NAME...]]" >&2
  exit 2
fi
shift || true
names=("$@")
if [[ ${#names[@]} -eq 0 ]]; then
  mapfile -t names < <(ls -- "$corpus")
fi
for name in "${names[@]}"; do
  if [[ ! -d $corpus/$name ]]; then
    echo "$0: no reader '$name'. Readers are: $(ls -- "$corpus" | xargs)" >&2
    exit 2
  fi
done

mkdir -p -- "$build"
if ! (cd -- "$root" && cmake --preset fuzz -B "$build" &&
  nice cmake --build "$build" --parallel "${PINODE_FUZZ_JOBS:-1}" \
    --target "${names[@]/%/_fuzzer}") >"$build/readers.log" 2>&1; then
  tail -n 20 -- "$build/readers.log" >&2
  echo "$0: the fuzzers cannot be built, see $build/readers.log" >&2
  exit 2
fi

# Prints the value of a final statistic of libFuzzer, or a hyphen.
statistic() {
  sed -nE "s/^stat::$1: +([0-9]+).*/\1/p" "$2" | tail -n 1 | grep . || echo -
}

findings=0
printf '%-14s %8s %12s %8s %9s\n' \
  reader seconds executions 'peak MB' findings
for name in "${names[@]}"; do
  work=$build/fuzz/$name
  mkdir -p -- "$work/inputs"
  begin=$SECONDS
  found=0
  # A timeout kills what libFuzzer itself does not end.
  if ! timeout --kill-after=60 $((seconds + 300)) \
    nice "$build/tests/fuzz/${name}_fuzzer" -max_total_time="$seconds" \
    -max_len=16384 -timeout=20 -rss_limit_mb=2048 -print_final_stats=1 \
    -artifact_prefix="$work/" "$work/inputs" "$corpus/$name" \
    >"$work/log" 2>&1; then
    found=1
    findings=$((findings + 1))
  fi
  printf '%-14s %8d %12s %8s %9d\n' "$name" $((SECONDS - begin)) \
    "$(statistic number_of_executed_units "$work/log")" \
    "$(statistic peak_rss_mb "$work/log")" "$found"
  if [[ $found == 1 ]]; then
    { grep -m 3 -E 'ERROR|SUMMARY|runtime error|Test unit written' \
      "$work/log" || tail -n 5 -- "$work/log"; } | sed 's/^/    /'
  fi
done
((findings == 0))
