#!/usr/bin/env bash
# Where pinode_check puts sensors, on a small frame.
#
#   tests/programs/plan_test.sh PROGRAM_DIR
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/three_storey" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cp -- "$data"/*.toml "$data"/*.csv "$scratch"
cd -- "$scratch"

tested=pinode_check
source "$here/testing.sh"

# Column COLUMN of the line of NAME in the table of FILE that begins with TITLE.
Cell() {
  awk -F '  +' -v title="$1" -v name="$2" -v column="$3" '
    index($0, title) { inside = 1 }
    inside && $0 == "" { inside = 0 }
    inside && $2 == name { print $column; exit }' "$4"
}

# No response has been measured yet: only the ground motion. Steps are given: the
# plan, which knows no noise before it has run, would choose finer ones than the
# fit.
sed '/^\[\[record\]\]/,$d' three_storey.toml >model.toml
{
  cat model.toml
  sed -n '/^name  = "train"/,/unit      = "m\/s^2"/p' three_storey.toml |
    sed '1i [[record]]' | sed '2a substeps = 4'
} >loads.toml
Run 0 pinode_check --case=loads.toml --plan=2
cp stdout plan
grep -q '^Sensors: 2 of 3 places, largest determinant for k1, k2, k3$' plan ||
  Fail "what is planned"
sensors=($(awk -F '  +' '/^  Sensor /{ on = 1; next }
  on && /^$/ { exit } on && $2 ~ /^u[1-3]$/ { print $2 }' plan))
[[ ${#sensors[@]} -eq 2 ]] || Fail "two sensors"
noise=$(Cell "Sensor" "${sensors[0]}" 3 plan)
[[ $noise == *" m/s^2" ]] || Fail "noise and its unit"

# A fit of what they would measure finds the deviations that were planned.
{
  cat loads.toml
  for sensor in "${sensors[@]}"; do
    printf '  [[record.channel]]\n  name = "%s"\n' "a_$sensor"
    printf '  quantity = "absolute_acceleration"\n  dof = "%s"\n' "$sensor"
    printf '  unit = "m/s^2"\n  sigma = %s\n' "${noise% m/s^2}"
  done
  printf '[simulate]\nnoise = "sigma"\nseed = 7\n'
} >simulated.toml
Run 0 pinode_simulate --case=simulated.toml --output_dir=S
sed 's|^  name = "\(a_.*\)"|&\n  file = "S/response_train.csv"\n  column = "\1"|' \
  simulated.toml >fitted.toml
Run 0 pinode_update --case=fitted.toml --output_dir=D --progress=false
for name in k1 k2 k3; do
  planned=$(Cell "Expected uncertainty" $name 4 plan)
  awk -F, -v name=$name -v planned="$planned" '
    NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
    $at["name"] == name {
      ratio = 1.96 * $at["sigma"] / planned
      printf "%s: planned %s, fitted %.3g\n", name, planned,
             1.96 * $at["sigma"]
      found = ratio > 0.9 && ratio < 1.1
    }
    END { exit !found }' D/parameters.csv || Fail "$name: not as planned"
done

# Where to hit, and for how long.
{
  sed 's/record.ground/record.force/; s/direction = "x"/dof = "u1"/
    s|"m/s^2"|"N"|' loads.toml
  printf '[plan]\nexcite = ["u1", "u3"]\ndurations = [2, 10]\n'
  printf 'criterion = "worst_deviation"\n'
} >hits.toml
Run 0 pinode_check --case=hits.toml --plan=1
grep -q 'smallest worst deviation' stdout || Fail "criterion"
[[ $(grep -cE '^ +(2\.000|10\.00) s  ' stdout) -eq 2 ]] || Fail "durations"
grep -q '^  u1  .*  u[1-3]$' stdout || Fail "hits"

Refused "expected 1 to 3" --case=loads.toml --plan=4
Refused "negative" --case=loads.toml --plan=-1
sed '/^excite/s/"u3"/"u9"/' hits.toml >bad.toml
Refused "bad.toml:" --case=bad.toml --plan=1
sed 's/durations = .*/durations = [200]/' hits.toml >bad.toml
Refused "not more than" --case=bad.toml --plan=1
sed 's/excite = .*/excites = 1/' hits.toml >bad.toml
Refused "excites" --case=bad.toml --plan=1
Refused "record" --case=model.toml --plan=1
tested=pinode_simulate
sed '0,/  sigma = .*/s///' simulated.toml >bad.toml
Refused "'sigma' is missing" --case=bad.toml --output_dir=E
