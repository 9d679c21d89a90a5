#!/usr/bin/env bash
# Runs every fuzzer of a build for a time, from the committed corpus.
#
#   tests/fuzz/run.sh BUILD_DIR SECONDS [NAME...]
#
# New inputs stay in BUILD_DIR/fuzz; a finding stops with its file there. Exits
# 1 if a fuzzer found something.
set -euo pipefail

if [[ $# -lt 2 ]]; then
  echo "usage: $0 BUILD_DIR SECONDS [NAME...]" >&2
  exit 2
fi
corpus=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/corpus" && pwd)
build=$(cd -- "$1" && pwd)
seconds=$2
shift 2
names=("$@")
if [[ ${#names[@]} -eq 0 ]]; then
  mapfile -t names < <(ls -- "$corpus")
fi

failed=()
for name in "${names[@]}"; do
  work=$build/fuzz/$name
  mkdir -p -- "$work/inputs"
  echo "== $name, $seconds s"
  if ! nice "$build/tests/fuzz/${name}_fuzzer" -max_total_time="$seconds" \
    -max_len=16384 -timeout=20 -rss_limit_mb=2048 -print_final_stats=1 \
    -artifact_prefix="$work/" "$work/inputs" "$corpus/$name" \
    >"$work/log" 2>&1; then
    failed+=("$name")
    grep -E 'ERROR|SUMMARY|runtime error' "$work/log" || tail -n 5 "$work/log"
  fi
  grep -E 'stat::(number_of_executed_units|peak_rss_mb)' "$work/log" || true
done
if [[ ${#failed[@]} -gt 0 ]]; then
  echo "findings: ${failed[*]}"
  exit 1
fi
