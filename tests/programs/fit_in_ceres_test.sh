#!/usr/bin/env bash
# The example apps/examples/fit_in_ceres.cc beside the programs.
#
#   tests/programs/fit_in_ceres_test.sh FIT_IN_CERES PROGRAM_DIR
#
# All fit data/four_dof_free/scheme2_groups. The example's springs and dampers
# agree with those of pinode_update within 1e-3 (they are fractions of the true
# values). Its equation has the one term that pinode_discover regresses on the
# network of pinode_update, x1^3; the coefficients, -2 in truth, agree within
# 0.02.
set -euo pipefail

example=$(realpath -- "$1")
programs=$(cd -- "$2" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/four_dof_free" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cp -- "$data"/scheme2_groups.toml "$data"/*.csv "$scratch"
cd -- "$scratch"
source "$here/testing.sh"

# Compare EXAMPLE PROGRAMS: two files of lines "name value"; a name in brackets
# is that of a term. Prints both side by side. Fails where the names differ or a
# value is beyond its tolerance.
Compare() {
  awk '
    NR == FNR { value[$1] = $2; next }
    {
      printf "%-10s example %9.5f, programs %9.5f\n", $1, value[$1], $2
      off = value[$1] - $2
      if (off < 0) off = -off
      if (!($1 in value) || off > ($1 ~ /\[/ ? 0.02 : 1e-3)) bad = 1
      ++compared
      delete value[$1]
    }
    END { exit bad || compared != 9 || length(value) > 0 }' "$1" "$2"
}

status=0
"$example" scheme2_groups.toml >stdout 2>stderr || status=$?
[[ $status -eq 0 ]] || Fail "fit_in_ceres: status $status, expected 0"
awk '$2 == "=" { print $1, $3 } $1 == "N:" { print $3, $2 }' stdout >example

Run 0 pinode_update --case=scheme2_groups.toml --output_dir=D --progress=false
Run 0 pinode_discover --model=D --case=scheme2_groups.toml --output_dir=E \
  --progress=false
awk -F, '
  NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
  $1 ~ /^[kc][1-4]$/ { print $1, $column["value"] }' D/parameters.csv >both
awk -F'[:,] *' '
  { gsub(/["[:blank:]]*$/, ""); gsub(/"/, ""); sub(/^ */, "") }
  $1 == "basis" { basis = $2 }
  $1 == "from_network" { print basis, $2 }' E/discover.json >>both
Compare example both >stdout || Fail "the example and the programs disagree"
cat stdout

# The comparison can fail: a number beyond its tolerance, a term too many, one
# that is missing.
sed 's/^k3 .*/k3 0.302/' example >other
! Compare other both >stdout || Fail "a wrong k3 is not noticed"
{ cat example; echo 'v[x1]^3 0.001'; } >other
! Compare other both >stdout || Fail "a term too many is not noticed"
grep -v '\[' example >other
! Compare other both >stdout || Fail "a missing term is not noticed"

# Bad input is status 2 and one line.
status=0
"$example" nowhere.toml >stdout 2>stderr || status=$?
[[ $status -eq 2 && $(wc -l <stderr) -eq 1 ]] || Fail "bad input: status $status"
