#!/usr/bin/env bash
# A fit that is stopped on its way, and how it goes on.
#
#   tests/programs/interrupt_test.sh PROGRAM_DIR
#
# SIGINT and SIGTERM: status 3 and a complete folder that says so; SIGKILL: the
# partial folder with a checkpoint. From either, --resume begins where the fit
# was and ends with a complete folder.
set -euo pipefail

update=$(cd -- "$1" && pwd)/pinode_update
data=$(cd -- "$(dirname -- "$0")/../../data/four_dof_free" && pwd)
scratch=$(mktemp -d)
running=
Clean() {
  [[ -z $running ]] || kill -KILL "$running" 2>/dev/null || true
  rm -rf -- "$scratch"
}
trap Clean EXIT

case=$scratch/scheme1.toml
output=$scratch/results/D
patience=300  # tenths of a second

Fail() {
  echo "$trial: $1; standard error was:"
  cat -- "$scratch/stderr"
  ls -lA -- "$scratch/results" "$output" 2>/dev/null || true
  exit 1
}

# The case with a limit of iterations, which is an option and so may differ
# between a fit and its continuation. A network without any physics takes
# hundreds of iterations; every scheme is far from its end after some tens.
WriteCase() {
  cp -- "$data"/*.csv "$scratch"
  { cat -- "$data/scheme1.toml"; echo; } |
    awk -v limit="max_iterations = $1" '
      /^max_iterations/ { next }
      { print }
      /^\[options\]/ { print limit; done = 1 }
      END { if (!done) print "\n[options]\n" limit }' >"$case"
}

Start() {
  "$update" --case="$case" --output_dir="$output" "$@" \
    >"$scratch/stdout" 2>"$scratch/stderr" &
  running=$!
}

Finish() {
  status=0
  wait "$running" || status=$?
  running=
}

Number() { sed -nE 's/.*"'"$2"'": ?([-+0-9.e]+).*/\1/p' "$1" | head -1; }

# Waits for a checkpoint of the $1-th iteration or a later one.
AwaitIteration() {
  local checkpoint iteration
  for ((i = 0; i < patience; ++i)); do
    checkpoint=$(echo "$output".partial-*/checkpoint.json)
    if [[ -s $checkpoint ]]; then
      iteration=$(Number "$checkpoint" iteration)
      [[ ${iteration:-0} -lt $1 ]] || return 0
    fi
    kill -0 "$running" 2>/dev/null || Fail "the fit ended before its signal"
    sleep 0.1
  done
  Fail "no checkpoint of iteration $1"
}

Complete() {
  local file
  for file in result.json parameters.csv covariance.csv history.csv \
    prediction_{h1,h2,h1_late,h2_late,h3}.csv initial_states.csv M.mtx C.mtx \
    K.mtx model.toml network_nn1.json checkpoint.json report.html; do
    [[ -s $output/$file ]] || Fail "no $file"
  done
  [[ $(ls -A -- "$scratch/results") == D ]] || Fail "a partial folder is left"
}

# The cost before the first step; what Identify would begin with by itself is
# thousands of times what it has after some tens of iterations.
FirstCost() { sed -n 2p "$output/history.csv" | cut -d, -f4; }

Resume() {
  WriteCase 60
  Start --resume
  Finish
  [[ $status -le 1 ]] || Fail "--resume: status $status, expected 0 or 1"
  Complete
  ! grep -q '"termination": "interrupted"' "$output/result.json" ||
    Fail "--resume: still says interrupted"
  awk -v cost="$(FirstCost)" -v fresh="$fresh" \
    'BEGIN { exit !(cost > 0 && cost < 1e-3 * fresh) }' ||
    Fail "--resume: begins at a cost of $(FirstCost), a new fit at $fresh"
}

# What a new fit begins with.
trial="new fit"
WriteCase 1
mkdir -- "$scratch/results"
Start
Finish
[[ $status -eq 1 ]] || Fail "status $status after one iteration, expected 1"
Complete
fresh=$(FirstCost)

# A second signal, as timeout and a closing terminal send it, changes nothing.
for signal in INT TERM HUP; do
  trial=SIG$signal
  rm -rf -- "$output"
  WriteCase 100000
  Start
  AwaitIteration 40
  kill -"$signal" "$running"
  kill -"$signal" "$running" || true
  Finish
  [[ $status -eq 3 ]] || Fail "status $status, expected 3"
  tail -n 1 -- "$scratch/stderr" | grep -q -e "$output; continue with --resume" ||
    Fail "its last line does not say what is left"
  Complete
  grep -q '"usable": false' "$output/result.json" || Fail "is usable"
  grep -q '"termination": "interrupted"' "$output/result.json" ||
    Fail "does not say interrupted"
  grep -qE '"message": ".*interrupted' "$output/result.json" ||
    Fail "its message does not say interrupted: $(grep message "$output/result.json")"
  iteration=$(Number "$output/checkpoint.json" iteration)
  [[ $iteration -ge 40 ]] || Fail "checkpoint of iteration $iteration"
  # Nobody's work is thrown away without being told to.
  Start
  Finish
  [[ $status -eq 2 ]] || Fail "without --resume: status $status, expected 2"
  Resume
done

trial=SIGKILL
rm -rf -- "$output"
WriteCase 100000
Start
AwaitIteration 40
kill -KILL "$running"
Finish 2>/dev/null
[[ $status -eq 137 ]] || Fail "status $status, expected 137"
[[ ! -e $output ]] || Fail "left an output folder"
checkpoint=$(echo "$output".partial-*/checkpoint.json)
[[ -s $checkpoint ]] || Fail "left no checkpoint"

# Another problem does not take it over, and leaves it where it is.
sed -i 's/^layers .*/layers = [29]/' "$case"
Start --resume
Finish
[[ $status -eq 2 ]] || Fail "another problem: status $status, expected 2"
[[ $(wc -l <"$scratch/stderr") -eq 1 ]] || Fail "expected one line"
grep -q 'checkpoint\.json: belongs to another case' "$scratch/stderr" ||
  Fail "does not say that the checkpoint is another case's"
[[ -s $(echo "$output".partial-*/checkpoint.json) ]] ||
  Fail "another problem: the checkpoint is gone"
Resume
