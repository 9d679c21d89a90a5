#!/usr/bin/env bash
# Six sensors planned for the frame of data/, and whether a fit of what they
# would measure finds what the plan says.
#
#   tests/programs/plan_frame_test.sh PROGRAM_DIR
#
# Sensors could be at the south-west edges of all columns, in x and y, wherever the
# deck has nodes: 120 places. Every deviation of a group in the fit must be
# within 10 % of the planned one. Prints the table of data/README.md.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/frame" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cp -- "$data"/*.gz "$data"/frame.dof "$data"/frame.inp "$data"/healthy_1.* "$scratch"
cd -- "$scratch"
source "$here/testing.sh"

{
  cat healthy_1.toml
  printf '[plan]\n[[plan.candidate]]\ndofs = ['
  for column in 1 2 3 4; do
    for level in 01 02 03 04 05 06 07 08 09 10 11 12 13 14 15; do
      printf '"%s%s1.1", "%s%s1.2", ' $column $level $column $level
    done
  done
  printf ']\n'
} >plan.toml
Run 0 pinode_check --case=plan.toml --plan=6
cp stdout plan
sed -n '/^Sensors:/,$p' plan
sensors=($(awk '/^  Sensor /{ on = 1; next } on && /^$/ { exit }
  on && $1 ~ /^[0-9]+\.[12]$/ { print $1 }' plan))
noise=$(awk -v name="${sensors[0]}" '$1 == name { print $2; exit }' plan)
[[ ${#sensors[@]} -eq 6 ]] || Fail "six sensors"

# Four modes more than DOFs stay: planned sensors lie close together, and twelve
# modes alone hardly tell them apart (the cost had rounding of 0.3 %).
#
# What the case looks at besides: the forces and the ends of the braces.
kept=("${sensors[@]}")
for dof in 3153.1 2151.2 3054.1 3104.1 5102.2 5264.1 1151.1 1151.2; do
  [[ ${#kept[@]} -lt 12 ]] || break
  [[ " ${kept[*]} " == *" $dof "* ]] || kept+=("$dof")
done
{
  awk -v keep="$(printf '"%s", ' "${kept[@]}")" '
    /^method = / { print "method = \"modal\"\nmodes = 16"; next }
    /^keep = / { print "keep = [" keep "]"; skip = 1; next }
    skip && /^ / { next }
    { skip = 0 }
    /^  \[\[record.channel\]\]/ { exit }
    { print }' healthy_1.toml
  for sensor in "${sensors[@]}"; do
    printf '  [[record.channel]]\n  name = "a_%s"\n' "$sensor"
    printf '  quantity = "absolute_acceleration"\n  dof = "%s"\n' "$sensor"
    printf '  unit = "m/s^2"\n  sigma = %s\n' "$noise"
  done
  printf '[simulate]\nnoise = "sigma"\nseed = 11\n'
} >simulated.toml
Run 0 pinode_simulate --case=simulated.toml --output_dir=S
sed 's|^  name = "\(a_.*\)"|&\n  file = "S/response_healthy_1.csv"\n  column = "\1"|' \
  simulated.toml >fitted.toml
Run 0 pinode_update --case=fitted.toml --output_dir=D --progress=false

# name, own, planned, fitted: half-widths of 95 %.
awk '
  FILENAME == "plan" {
    if (/^Expected uncertainty/) on = 1
    if (on && NF >= 5 && $3 ~ /^[0-9]/) {
      own[$1] = $3
      planned[$1] = $4
      names[++count] = $1
    }
    if (on && /^$/) on = 0
    next
  }
  FNR == 1 { FS = ","; $0 = $0; for (i = 1; i <= NF; ++i) at[$i] = i; next }
  { fitted[$at["name"]] = 1.96 * $at["sigma"] }
  END {
    for (i = 1; i <= count; ++i) {
      name = names[i]
      if (name ~ /^c_/) continue
      off = 100 * (fitted[name] / planned[name] - 1)
      size = off < 0 ? -off : off
      if (size > largest) largest = size
      printf "%-16s own %.3g, planned %.3g, fitted %.3g (%+.1f %%)\n", name,
             own[name], planned[name], fitted[name], off
      ++groups
    }
    printf "farthest from planned: %.1f %%\n", largest
    exit !(groups == 12 && largest <= 10)
  }' plan D/parameters.csv || Fail "not as planned"
