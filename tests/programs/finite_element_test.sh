#!/usr/bin/env bash
# A finite-element export, reduced, identified, and handed back.
#
#   tests/programs/finite_element_test.sh PROGRAM_DIR
#
# A rod of seven springs in Matrix Market files, two element sets of which are
# known by exports; the truth, 15 % off in one of them, is simulated.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cd -- "$scratch"

tested=pinode_update
source "$here/testing.sh"

# Rod FILE LOWER UPPER: factors of springs 1 to 4 and 5 to 7; node 1 is the
# support.
Rod() {
  awk -v lower="$2" -v upper="$3" 'BEGIN {
    n = 8
    for (i = 1; i < n; ++i) {
      k = 5e5 * (i <= 4 ? lower : upper)
      d[i] += k; d[i + 1] += k; off[i] = -k
    }
    print "%%MatrixMarket matrix coordinate real symmetric"
    printf "%d %d %d\n", n, n, 2 * n - 1
    for (i = 1; i <= n; ++i) printf "%d %d %.17g\n", i, i, d[i]
    for (i = 1; i < n; ++i) printf "%d %d %.17g\n", i + 1, i, off[i]
  }' >"$1"
}
Rod K.mtx 1 1
Rod K_lower.mtx 1.25 1
Rod K_upper.mtx 0 1
awk 'BEGIN { print "%%MatrixMarket matrix coordinate real symmetric\n8 8 8"
  for (i = 1; i <= 8; ++i) print i, i, 200 }' >M.mtx
seq -f %g.1 8 >dofs.txt
awk 'BEGIN { print "t,ag,u"
  for (i = 0; i < 601; ++i) { t = i / 100
    printf "%.2f,%.8g,0\n", t, sin(11 * t) + 0.7 * sin(31 * t + 1) \
      + 0.5 * sin(3 * t * t) } }' >quake.csv

cat >rod.toml <<'EOF'
title = "Rod"
[model]
damping = {ratios = [0.02]}
[model.finite_element]
mass = "M.mtx"
stiffness = "K.mtx"
dofs = "dofs.txt"
remove_dofs = ["1.1"]
expected_frequencies = [1.663622, 4.918158]
frequency_tolerance = 1e-5
[model.reduction]
method = "craig_bampton"
modes = 3
compare = 4
[[group]]
name = "lower"
adds_to = "stiffness"
changed_export = "K_lower.mtx"
factor = 1.25
initial = 0.0
lower = -0.9
[[group]]
name = "upper"
adds_to = "stiffness"
set_export = "K_upper.mtx"
initial = 0.0
lower = -0.9
[[record]]
name = "quake"
file = "quake.csv"
time = "t"
interpolation = "linear"
start = "rest"
  [[record.ground]]
  direction = "x"
  file = "quake.csv"
  column = "ag"
  unit = "m/s^2"
  [[record.channel]]
  name = "mid"
  column = "u"
  quantity = "absolute_acceleration"
  dof = "4.1"
  unit = "m/s^2"
  [[record.channel]]
  name = "top"
  column = "u"
  quantity = "absolute_acceleration"
  dof = "8.1"
  unit = "m/s^2"
EOF

# The truth, then records of it with 1 % noise.
awk '/^name = "lower"/ { inside = 1 }
  inside && /^initial/ { $0 = "initial = -0.15"; inside = 0 } { print }' \
  rod.toml >truth.toml
Run 0 pinode_simulate --case=truth.toml --output_dir=S --noise_percent=1
awk '/^file = "quake.csv"/ { $0 = "file = \"S/response_quake.csv\"" }
  /^  name = "/ { name = $3 } /^  column = "u"/ { $0 = "  column = " name }
  { print }' rod.toml >fit.toml

# What the export is, against what was expected, and what the reduction costs.
Run 0 pinode_check --case=fit.toml
for text in 'Finite-element model: 8 DOFs, 1 removed' \
  '0 rigid-body modes' 'Reduced by craig_bampton to 5 coordinates: 4.1 8.1 q1'; do
  grep -qF -- "$text" stdout || Fail "pinode_check does not say '$text'"
done
# Mode, Hz, expected, error, error of the reduction, MAC.
awk '/^Mode +full/ { table = 1; next }
  table && $1 == 1 {
    exit !($2 > 1.66 && $2 < 1.67 && $3 == 1.6636 && $4 < 0.001 &&
           $5 >= 0 && $5 < 0.1 && $6 > 0.999) }' stdout ||
  Fail "pinode_check: first mode of the whole model"

Run 0 pinode_update --case=fit.toml --output_dir=D --progress=false
for file in K_full.mtx M_full.mtx dofs_full.txt element_factors.csv K.mtx; do
  [[ -s D/$file ]] || Fail "D lacks $file"
done
[[ ! -e D/C_full.mtx ]] || Fail "a damping matrix that was never exported"
cmp -s D/dofs_full.txt dofs.txt || Fail "order of the DOFs"
# The factors to type back, within 1 %: 0.85 and 1.
awk -F, '
  NR == 1 { next }
  { f[$1] = $3; if (!($5 < $3 && $3 < $6)) bad = 1 }
  END { exit bad || !(f["lower"] > 0.84 && f["lower"] < 0.86 &&
               f["upper"] > 0.99 && f["upper"] < 1.01) }' \
  D/element_factors.csv || Fail "factors: $(cat D/element_factors.csv)"
# They are those of the matrix, which is where the export has it.
factor=$(awk -F, '$1 == "lower" { print $3 }' D/element_factors.csv)
awk -v f="$factor" 'FNR == NR { if (!/^%/ && NF == 3) whole[$1, $2] = $3; next }
  /^%/ { next } !sized { sized = 1; next }
  { ++entries
    if (!(($1, $2) in whole)) bad = 1
    if ($1 == 2 && $2 == 1) { ratio = $3 / whole[2, 1] } }
  END { exit bad || !(entries == 15 && ratio - f < 1e-9 && f - ratio < 1e-9) }' \
  K.mtx D/K_full.mtx || Fail "K_full.mtx is not the export times the factors"
# The matrix is an export again.
sed 's|"K.mtx"|"D/K_full.mtx"|; /^expected/d; /^frequency_t/d' fit.toml |
  awk '/^\[\[group/ { skip = 1 } /^\[\[record\]\]/ && skip { skip = 0
      print "[[group]]\nname = \"g\"\nadds_to = \"stiffness\"\nset_export = \"K_upper.mtx\"" }
    !skip' >again.toml
Run 0 pinode_check --case=again.toml

# With a basis that follows the parameters, and on from its end.
sed 's/^method = "craig_bampton"/method = "modal"\nrenew = true/
  s/^modes = 3/modes = 4/' fit.toml >renewed.toml
Run 0 pinode_update --case=renewed.toml --output_dir=R --progress=false
grep -q 'basis of the reduction was taken again' R/report.html ||
  Fail "does not say that the basis was renewed"
cp R/element_factors.csv first.csv
Run 0 pinode_update --case=renewed.toml --output_dir=R --progress=false --resume
grep -q 'basis of the reduction was taken again' R/report.html ||
  Fail "does not renew the basis after --resume"
join -t, <(sort first.csv) <(sort R/element_factors.csv) |
  awk -F, '$1 != "group" { ++n; d = $3 - $10
      if (d > 1e-4 || d < -1e-4) bad = 1 }
    END { exit bad || n != 2 }' || Fail "--resume ends elsewhere"

# The same record is no change, from the baseline and from the checkpoint.
for resume in '' --resume; do
  Run 0 pinode_damage --baseline=R --case=renewed.toml --output_dir=C \
    --progress=false $resume
  grep -q '"verdict": "no_damage"' C/damage.json || Fail "damage $resume"
done

Bad() { # TEXT SED_SCRIPT
  sed "$2" fit.toml >bad.toml
  Refused "$1" --case=bad.toml --output_dir=E
}
Bad "bad.toml:43: '9.1' is not a DOF of the finite-element model" \
  's/dof = "4.1"/dof = "9.1"/'
Bad "'1.1' is not a DOF of the finite-element model" 's/dof = "4.1"/dof = "1.1"/'
seq -f %g.1 7 >seven.txt
Bad seven.txt 's/dofs.txt/seven.txt/'
Bad 'mode 1 above 0 Hz' 's/1.663622/1.8/'
Bad 'check the factor' 's/factor = 1.25/factor = 1.1/'
head -c 100 K.mtx >cut.mtx
Bad cut.mtx 's/stiffness = "K.mtx"/stiffness = "cut.mtx"/'
echo done
