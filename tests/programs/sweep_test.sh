#!/usr/bin/env bash
# Harmonic sweeps of pinode_simulate.
#
#   tests/programs/sweep_test.sh PROGRAM_DIR
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/duffing" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cp -- "$data"/single.toml "$data"/*.csv "$scratch"
cd -- "$scratch"

tested=pinode_simulate
source "$here/testing.sh"

# Without its spring the oscillator has a response in closed form.
awk '/^\[\[element\]\]/ { skip = 1 } /^\[\[record\]\]/ { skip = 0 } !skip' \
  single.toml >linear.toml
Run 0 pinode_simulate --case=linear.toml --output_dir=linear \
  --sweep=force_y --sweep_hz=40:110 --sweep_amplitude=0.2 --sweep_points=50
awk -F, '
  NR == 1 {
    if ($0 != "frequency_hz,y,y_amplitude,y_phase_deg,largest_multiplier," \
              "num_harmonics,neglected") { print "columns " $0; exit failed = 1 }
    next
  }
  {
    w = 8 * atan2(1, 1) * $1
    expected = 0.2 / sqrt((1 - 5e-6 * w * w)^2 + (2e-4 * w)^2)
    if (($3 / expected - 1)^2 > 1e-18 || ($2 / expected - 1)^2 > 1e-8) {
      print "at " $1 " Hz: " $2 ", " $3 ", expected " expected
      exit failed = 1
    }
    if ($5 >= 1) { print "not stable at " $1 " Hz"; exit failed = 1 }
    ++points
  }
  END { exit failed || points < 50 }' linear/sweep.csv || Fail "linear sweep"
grep -qF '"finished": true' linear/simulate.json || Fail "not finished"

# With it, the curve turns back, and the part in between is not stable.
Run 0 pinode_simulate --case=single.toml --output_dir=hard \
  --sweep=force_y --sweep_hz=40:160 --sweep_amplitude=0.05
grep -qF "not stable from" stdout || Fail "stable"
awk -F, 'NR > 2 { back += $1 < before } { before = $1 }
  END { exit back < 3 }' hard/sweep.csv || Fail "the curve does not turn back"

# Flags that make no sweep.
for hz in "" 5 5:5 0:5 a:b 5:inf; do
  Refused "" --case=single.toml --output_dir=E --sweep=force_y --sweep_hz="$hz"
done
Refused "the case has 'force_y'" --case=single.toml --output_dir=E \
  --sweep=shaker --sweep_hz=40:80
Refused "expected a positive number" --case=single.toml --output_dir=E \
  --sweep=force_y --sweep_hz=40:80 --sweep_amplitude=-1
for points in 1 200000000; do
  Refused "expected 2 to 100000" --case=single.toml --output_dir=E \
    --sweep=force_y --sweep_hz=40:80 --sweep_points=$points
done
for flag in sweep_hz=40:80 sweep_amplitude=2 sweep_points=9; do
  Refused "need --sweep" --case=single.toml --output_dir=E --$flag
done
Refused "no noise" --case=single.toml --output_dir=E --sweep=force_y \
  --sweep_hz=40:80 --seed=3
sed 's|^  unit     = "m"|&\n  name = "neglected"|' single.toml >name.toml
Refused "two columns 'neglected'" --case=name.toml --output_dir=E \
  --sweep=force_y --sweep_hz=40:80
