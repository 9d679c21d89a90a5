#!/usr/bin/env bash
# Measured modes without a record, with the programs alone.
#
#   tests/programs/modal_test.sh PROGRAM_DIR
#
# Two masses on springs, K = [300 -100; -100 100], M = diag(2, 1): the modes are
# those of K with the first spring at 180 in place of 200, by their closed form.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cd -- "$scratch"

tested=pinode_discover
source "$here/testing.sh"

# Frequency (Hz) and u2 / u1 of both modes: det(K - l M) = 0 is
# 2 l^2 - (k11 + 2 k22) l + k11 k22 - k12^2 = 0.
Modes() {
  awk -v k="$1" 'BEGIN {
    b = k + 100 + 200; c = (k + 100) * 100 - 10000
    for (s = -1; s <= 1; s += 2) {
      l = (b + s * sqrt(b * b - 8 * c)) / 4
      printf "%.12f %.12f\n", sqrt(l) / 6.283185307179586, (k + 100 - 2 * l) / 100
    }
  }'
}
{
  cat <<'END'
[model]
dofs = ["u1", "u2"]
mass = {diagonal = [2.0, 1.0]}
stiffness = [[300.0, -100.0], [-100.0, 100.0]]
damping = {ratios = [0.01]}
[[group]]
name = "k1"
adds_to = "stiffness"
between = ["ground", "u1"]
scale = 200.0
[[group]]
name = "k2"
adds_to = "stiffness"
between = ["u1", "u2"]
scale = 100.0
END
  while read -r frequency ratio; do
    printf '[[mode]]\nfrequency = %s\nfrequency_sigma = 0.002\n' "$frequency"
    printf 'shape = {u1 = 1.0, u2 = %s}\nshape_sigma = 0.01\n' "$ratio"
  done < <(Modes 180)
} >modes.toml

# Its modes need a model and nothing else; a model that hangs in the air has a
# rigid body without a damping ratio.
cat >alone.toml <<'END'
[model]
dofs = ["u1", "u2"]
mass = {diagonal = [1.0, 1.0]}
stiffness = [[100.0, -100.0], [-100.0, 100.0]]
END
Run 0 pinode_check --case=alone.toml
grep -q "2.251" stdout || Fail "no mode at sqrt(200) / 2 pi Hz"
! grep -qiE "nan|-0( |$)" stdout || Fail "a damping that is none"

Run 0 pinode_check --case=modes.toml
grep -qF "Measured modes, form eigenvector_difference" stdout ||
  Fail "no measured modes"
grep -qF "4 residuals" stdout || Fail "number of residuals"
grep -qF "Every named parameter is determined" stdout || Fail "not determined"

Run 0 pinode_update --case=modes.toml --output_dir=D --progress=false
grep -q "Measured modes" stdout || Fail "no table"
grep -q "<h2>Measured modes" D/report.html || Fail "not in the report"
# 1 + alpha = 0.9 and 1.
awk -F, '$1 == "k1" { exit !(($4 + 0.1)^2 < 1e-14 && $5 > 0 && $5 < 0.01) }' \
  D/parameters.csv || Fail "k1: $(cat D/parameters.csv)"
awk -F, '$1 == "k2" { exit !($4^2 < 1e-14) }' D/parameters.csv ||
  Fail "k2: $(cat D/parameters.csv)"
[[ $(grep -c '"measured_hz"' D/result.json) -eq 4 ]] || Fail "result.json"

# The result is a healthy state as any other.
{
  sed '/^\[\[mode\]\]/,$d' modes.toml
  while read -r frequency ratio; do
    printf '[[mode]]\nfrequency = %s\nfrequency_sigma = 0.002\n' "$frequency"
    printf 'shape = {u1 = 1.0, u2 = %s}\nshape_sigma = 0.01\n' "$ratio"
  done < <(Modes 144)
} >later.toml
Run 0 pinode_damage --baseline=D --case=later.toml --output_dir=damage \
  --progress=false
grep -qF '"verdict": "damage"' damage/damage.json || Fail "no damage"
awk '$1 == "k1" { exit !(($2 + 20)^2 < 0.01) }' stdout || Fail "change of k1"

# Nothing to discover from, nothing to simulate.
Refused "no training record" --model=D --case=modes.toml --output_dir=E
tested=pinode_simulate
Refused "[[record]]" --case=modes.toml --output_dir=E
tested=pinode_update
sed -e 's/u2 = /u3 = /' modes.toml >bad.toml
Refused "bad.toml:19" --case=bad.toml --output_dir=E
