#!/usr/bin/env bash
# A fit that cannot stay finite says where, and leaves its files.
#
#   tests/programs/divergence_test.sh PROGRAM_DIR
#
# The frame with fixed, strongly negative storey stiffnesses: what is free
# (damping, the cubic spring) cannot hold it.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
data=$(cd -- "$(dirname -- "$0")/../../data/three_storey" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cp -- "$data"/*.toml "$data"/*.csv "$scratch"
cd -- "$scratch"
sed -i -e 's/^adds_to = "stiffness"/&\ninitial = -3\nfree = false/' \
  -e '/^lower /d' three_storey.toml
{ cat three_storey.toml; printf '\n[options]\nshooting = "single"\n'; } \
  >single.toml
# It will not come to an end; thirty iterations are enough to say so.
printf '\n[options]\nmax_iterations = 30\n' >>three_storey.toml

Fail() {
  echo "$1; it left with $status and wrote:"
  head -30 stdout stderr
  grep -s '"message"' D/result.json
  ls -A . D 2>/dev/null
  exit 1
}

Run() {
  rm -rf D
  status=0
  "$programs/$1" --case="$2" --output_dir=D >stdout 2>stderr || status=$?
  [[ $status -eq 1 ]] || Fail "$1 --case=$2: expected status 1"
  [[ -z $(find . -name '*.partial*') ]] || Fail "$1: a partial folder is left"
}

# Over the whole record at once there is no trajectory to begin with.
Run pinode_update single.toml
where="record 'train' is not finite in segment 1 at t = [0-9.]+ s, .*\[u[123]\]"
grep -qE "\"message\": \".*$where" D/result.json ||
  Fail "result.json does not name record, segment, time and DOF"
grep -qE "$where" stdout ||
  Fail "the console does not name record, segment, time and DOF"
grep -q '"termination": "failure"' D/result.json || Fail "not a failure"
grep -q '"usable": false' D/result.json || Fail "not unusable"
for file in parameters.csv history.csv {M,C,K}.mtx model.toml checkpoint.json \
  report.html; do
  [[ -s D/$file ]] || Fail "no $file"
done

# Short segments stay finite; the free run does not.
Run pinode_update three_storey.toml
grep -qE "\"message\": \".*record 'train' is not finite" D/result.json ||
  Fail "result.json does not name the record"
grep -q '"usable": false' D/result.json || Fail "not unusable"
grep -q "record 'train'" stdout || Fail "the console does not name the record"
[[ -s D/prediction_train.csv && -s D/report.html ]] || Fail "files are missing"

Run pinode_simulate three_storey.toml
grep -qE "^record train: .*not finite from t = [0-9.]+" stderr ||
  Fail "does not name record and time"
grep -q '"finite": false' D/simulate.json || Fail "simulate.json says finite"
[[ -s D/response_train.csv ]] || Fail "no response_train.csv"
