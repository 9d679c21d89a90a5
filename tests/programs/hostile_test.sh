#!/usr/bin/env bash
# Programs with inputs of strangers, limits of the system, and signals.
#
#   tests/programs/hostile_test.sh PROGRAM_DIR
#
# Makes its inputs itself. tests/fuzz/hostile.sh tries many more by hand.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
tested=pinode_check
# shellcheck source=tests/programs/testing.sh
source "$(dirname -- "$0")/testing.sh"
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cd -- "$scratch"

# Two storeys, a decay of 1000 samples.
awk 'BEGIN {
  print "t,a1,a2"
  for (k = 0; k < 1000; ++k) {
    t = k / 100
    decay = exp(-0.3 * t)
    printf "%.2f,%.9f,%.9f\n", t, decay * sin(12 * t), 1.6 * decay * sin(12 * t)
  }
}' >record.csv
# Case NAME-OF-GROUP NAME-OF-CHANNEL
Case() {
  cat <<EOF
[model]
damping = {ratios = [0.015]}
[model.shear_building]
masses = [2000, 2000]
stiffnesses = [800000, 900000]
[[group]]
name = "$1"
adds_to = "stiffness"
storey = 1
[[record]]
name = "r"
file = "record.csv"
sampling_rate_hz = 100.0
start = "free"
  [[record.channel]]
  name = "$2"
  column = "a1"
  quantity = "absolute_acceleration"
  dof = "u1"
  unit = "m/s^2"
  [[record.channel]]
  column = "a2"
  quantity = "absolute_acceleration"
  dof = "u2"
  unit = "m/s^2"
[options]
max_iterations = 3
threads = 1
multistart = 1
EOF
}

# 1. Names: escapes, line ends, marks of the writing direction, many letters.
letters=$(printf 'a%.0s' {1..10000})
Case k1 a1 | sed 's/quantity = "absolute_acceleration"/quantity = "a\\nb\\u001b[2J\\u202ec"/' >case.toml
Refused '\n' --case=case.toml
grep -qF 'b\x1B[2J\u{202E}c' stderr || Fail "expected escapes that can be read"
! grep -q $'\x1b' stderr || Fail "an escape reached the terminal"
Case k1 a1 | sed "s/dof = \"u1\"/dof = \"$letters\"/" >case.toml
Refused 'more)...' --case=case.toml
[[ $(wc -c <stderr) -lt 1000 ]] || Fail "$(wc -c <stderr) letters"
{
  echo 'title = "t\u001b[2J"'
  Case k1 '=1+1'
} >case.toml
Run 0 pinode_check --case=case.toml
! grep -q $'\x1b' stdout || Fail "an escape reached the terminal"
grep -qF 't\x1B[2J' stdout || Fail "expected the escaped title"
status=0
"$programs/pinode_update" --case=case.toml --output_dir=D >stdout 2>stderr ||
  status=$?
[[ $status -le 1 ]] || Fail "status $status of a fit"
! grep -q $'\x1b' stdout || Fail "an escape reached the terminal"
! grep -qE "(^|,)\"?=" D/*.csv || Fail "a formula in a CSV file"
grep -qF "'=1+1_measured" D/prediction_r.csv || Fail "no channel =1+1"

# 2. Nesting and numbers beyond use.
{
  printf 'a.%.0s' {1..20000}
  echo 'a = 1'
} >case.toml
Refused 'levels of keys' --case=case.toml
Case k1 a1 | sed 's/max_iterations = 3/max_iterations = 4000000000/' >case.toml
Refused "'max_iterations'" --case=case.toml
Case k1 a1 | sed 's/start = "free"/start = "free"\nsubsteps = 1000000/' >case.toml
Refused "'substeps'" --case=case.toml
{
  Case k1 a1
  printf '[[mode]]\nfrequency = 1e-308\nfrequency_sigma = 0.01\n'
} >case.toml
Refused "'frequency'" --case=case.toml

# 3. Code that a case brings.
{
  Case k1 a1
  printf '[[element]]\nname = "soil"\nfile = "soil.so"\ntype = "soil"\nbetween = ["ground", "u1"]\n'
} >case.toml
: >soil.so
Refused 'soil.so: runs code of its own' --case=case.toml --no-code
Refused 'soil.so: runs code of its own' --case=case.toml --no_code
PINODE_NO_CODE=1 Refused 'runs code of its own' --case=case.toml
Refused 'soil.so' --case=case.toml
! grep -q 'runs code' stderr || Fail "refused without being asked to"

# 4. Limits of the system.
Case k1 a1 >case.toml
ln -s nothing link
tested=pinode_update
Refused 'link to something that does not exist' --case=case.toml \
  --output_dir=link
(
  ulimit -f 8
  Run 1 pinode_update --case=case.toml --output_dir=E
  [[ $(tail -n 1 stderr) == *"File too large"* ]] || Fail "expected the reason"
)
rm -rf E E.partial-*
Refused '--unpacked_gb' --case=case.toml --output_dir=E --unpacked_gb=0

# 5. Signals end programs that save nothing on their way at once, with one line.
# A long search for modes: 40 channels, which take some seconds.
awk 'BEGIN {
  line = "t"
  for (c = 1; c <= 40; ++c) line = line ",a" c
  print line
  for (k = 0; k < 20000; ++k) {
    line = sprintf("%.2f", k / 100)
    for (c = 1; c <= 40; ++c) {
      line = line sprintf(",%.5f", sin(k * (0.1 + 0.03 * c)) + sin(k * k + c))
    }
    print line
  }
}' >long.csv
for signal in INT TERM HUP; do
  status=0
  "$programs/pinode_modes" --case=long.csv --columns=all --output_dir=M \
    >stdout 2>stderr &
  running=$!
  sleep 0.7
  kill -"$signal" "$running"
  wait "$running" || status=$?
  [[ $status -eq 3 ]] || Fail "SIG$signal: status $status, expected 3"
  [[ $(cat stderr) == "interrupted; nothing was written" ]] ||
    Fail "SIG$signal: expected one line"
  [[ ! -e M ]] && ! compgen -G 'M.partial-*' >stdout ||
    Fail "SIG$signal: something was written"
done
echo "passed"
