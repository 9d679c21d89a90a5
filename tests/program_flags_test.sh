#!/usr/bin/env bash
# What every program owes to whoever drives it from a script.
#
#   tests/program_flags_test.sh PROGRAM
#
# --help exits 0 and shows --case, or --folder of pinode_app and --structure of
# pinode_watch, which take no case. An unknown flag exits 2 with one line on standard error that names it,
# and so does a call without a case. In neither is anything else written.
# Standard output that cannot be written is status 1 and one line that says so.
set -euo pipefail

program=$1
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
mkdir -- "$scratch/run"
cd -- "$scratch/run"

Run() {
  status=0
  "$program" "$@" >"$scratch/out" 2>"$scratch/err" || status=$?
}

Fail() {
  echo "$1; it left with $status and wrote:"
  cat -- "$scratch/out" "$scratch/err"
  exit 1
}

# The flag that names its input, and a call that is refused without a right one.
input=case
refused=()
if [[ ${program##*/} == pinode_app ]]; then
  input=folder
  refused=(--port=-1)
elif [[ ${program##*/} == pinode_watch ]]; then
  input=structure
fi

Run --help
[[ $status -eq 0 ]] || Fail "--help: expected status 0"
grep -q -e "-$input" "$scratch/out" || Fail "--help: expected --$input"

# Programs that cannot be several ranks have no flag for it.
if grep -q -e '-rank_timeout' "$scratch/out"; then
  case ${program##*/} in
    pinode_update | pinode_damage | pinode_discover) ;;
    *) Fail "--help: expected no --rank_timeout" ;;
  esac
fi

Run --no_such_flag=1
[[ $status -eq 2 ]] || Fail "unknown flag: expected status 2"
[[ $(wc -l <"$scratch/err") -eq 1 ]] || Fail "unknown flag: expected one line"
grep -q no_such_flag "$scratch/err" || Fail "unknown flag: expected its name"

Run "${refused[@]}"
[[ $status -eq 2 ]] || Fail "no case: expected status 2"
[[ $(wc -l <"$scratch/err") -eq 1 ]] || Fail "no case: expected one line"

status=0
"$program" --help >/dev/full 2>"$scratch/err" || status=$?
[[ $status -eq 1 ]] || Fail "a full standard output: expected status 1"
[[ $(wc -l <"$scratch/err") -eq 1 ]] ||
  Fail "a full standard output: expected one line"
grep -q 'standard output .*: No space left' "$scratch/err" ||
  Fail "a full standard output: expected it to be named, and why"

[[ -z $(ls -A) ]] || Fail "expected no file, found $(ls -A)"
