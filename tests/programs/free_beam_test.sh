#!/usr/bin/env bash
# A free-free beam, hit by a hammer: checked, simulated, identified.
#
#   tests/programs/free_beam_test.sh PROGRAM_DIR
#
# A steel strip of sixty elements of Euler and Bernoulli that nothing holds;
# the truth, 15 % less stiffness in its left half, is simulated with noise.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cd -- "$scratch"

tested=pinode_check
source "$here/testing.sh"

# Beam FILE KIND LEFT: K or M in the lower triangle, the left half's stiffness
# times LEFT.
Beam() {
  awk -v kind="$2" -v left="$3" 'BEGIN {
    elements = 60; h = 1 / elements
    bending = 210e9 * 40e-3 * 5e-3 ^ 3 / 12; mass = 7850 * 40e-3 * 5e-3
    split("12 6 -12 6 6 4 -6 2 -12 -6 12 -6 6 2 -6 4", k)
    split("156 22 54 -13 22 4 13 -3 54 13 156 -22 -13 -3 -22 4", m)
    for (e = 0; e < elements; ++e)
      for (i = 0; i < 4; ++i)
        for (j = 0; j <= i; ++j) {
          units = h ^ (i % 2 + j % 2)
          value = kind == "M" ? m[4 * i + j + 1] * mass * h / 420 : \
            k[4 * i + j + 1] * bending / h ^ 3 * (e < elements / 2 ? left : 1)
          a[2 * e + i, 2 * e + j] += value * units
        }
    n = 2 * (elements + 1)
    for (j = 0; j < n; ++j)
      for (i = j; i < n; ++i)
        if ((i, j) in a) {
          text = text sprintf("%d %d %.17g\n", i + 1, j + 1, a[i, j])
          ++count
        }
    printf "%%%%MatrixMarket matrix coordinate real symmetric\n%d %d %d\n", \
      n, n, count
    printf "%s", text
  }' >"$1"
}
Beam M.mtx M 1
Beam K.mtx K 1
Beam K_left.mtx K 1.1
for ((node = 1; node <= 61; ++node)); do
  printf '%d.3\n%d.5\n' "$node" "$node"
done >dofs.txt
awk 'BEGIN { print "t,F,a1,a31,a61"; pi = atan2(0, -1)
  for (i = 0; i < 1000; ++i) { t = i / 2000
    blow = t > 0.01 && t < 0.014 ? 50 * sin(pi * (t - 0.01) / 0.004) : 0
    printf "%.4f,%.9g,%d,%d,%d\n", t, blow, i % 2, i % 3, i % 5 } }' >hammer.csv

Channel() {
  cat <<EOF2
[[record.channel]]
column = "a$1"
quantity = "absolute_acceleration"
dof = "$1.3"
unit = "m/s^2"
EOF2
}

# Case FILE RECORD INITIAL
Case() {
  cat >"$1" <<EOF2
title = "Free-free beam"
[model]
damping = {ratios = [0.005]}
[model.finite_element]
mass = "M.mtx"
stiffness = "K.mtx"
dofs = "dofs.txt"
# (beta L)^2 sqrt(EI / (m L^4)) / (2 pi), cosh cos (beta L) = 1
expected_frequencies = [26.583006, 73.277081, 143.652377]
frequency_tolerance = 1e-4
[model.reduction]
method = "craig_bampton"
modes = 4
compare = 5
[[group]]
name = "left"
adds_to = "stiffness"
changed_export = "K_left.mtx"
factor = 1.1
initial = $3
[[record]]
name = "hit"
file = "$2"
time = "t"
start = "rest"
interpolation = "linear"
[[record.force]]
dof = "1.3"
file = "hammer.csv"
column = "F"
unit = "N"
$(Channel 1)
$(Channel 31)
$(Channel 61)
EOF2
}
Case truth.toml hammer.csv -0.15
Case beam.toml T/response_hit.csv 0.0

Run 0 pinode_check --case=truth.toml
grep -q '^2 rigid-body modes' stdout || Fail "no rigid-body modes"
[[ $(grep -cE '^ +[12] +0 +-$' stdout) -eq 2 ]] ||
  Fail "expected two modes at 0 Hz without a damping ratio"
grep -qE 'nan|inf' stdout && Fail "not a number"
Run 0 pinode_simulate --case=truth.toml --noise_percent=2 --output_dir=T
Run 0 pinode_update --case=beam.toml --output_dir=D
awk -F, '$1 == "left" { found = 1; exit !($4 > -0.151 && $4 < -0.149) }
  END { exit !found }' D/parameters.csv ||
  Fail "not the truth: $(cat D/parameters.csv)"
# What was found is a case of its own, as free as the model was.
Run 0 pinode_check --case=D/model.toml
[[ $(grep -cE '^ +[12] +0 +-$' stdout) -eq 2 ]] ||
  Fail "the result has other rigid-body modes"

# One DOF does not hold it.
sed 's/^compare = 5/keep = ["1.3"]/; /^\[\[record.channel/,$d' truth.toml \
  >mechanism.toml
cat >>mechanism.toml <<'EOF2'
[[record.channel]]
column = "a1"
quantity = "absolute_acceleration"
dof = "1.3"
unit = "m/s^2"
EOF2
Refused "the kept DOFs hold 1 of them; keep DOFs that hold all, such as" \
  --case=mechanism.toml
