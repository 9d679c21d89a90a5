#!/usr/bin/env bash
# From wind to modes, and from modes to storeys, with the programs alone.
#
#   tests/programs/modes_test.sh PROGRAM_DIR
set -euo pipefail

programs=$(cd -- "$1" && pwd)
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/three_storey_ambient" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cp -- "$data"/*.toml "$data"/*.csv "$data"/*.gz "$scratch"
cd -- "$scratch"

tested=pinode_modes
source "$here/testing.sh"

# Value of KEY in line NUMBER of the entries of FILE that are called so.
Entry() {
  grep -E "^ *\"?$1\"? ?[:=]" "$3" | sed -n "$2p" | grep -oE -- '-?[0-9][0-9.e-]*' |
    head -1
}
# Within LIMIT of each other.
Near() {
  awk -v a="$1" -v b="$2" -v limit="$3" \
    'BEGIN { exit !(a - b <= limit && b - a <= limit) }' || Fail "$1, expected $2"
}

Run 0 pinode_modes --case=three_storey_ambient.toml --output_dir=D
for file in modes.json modes.csv modes.toml modes.uff report.html; do
  [[ -s D/$file ]] || Fail "no $file"
done
grep -q '"data_driven"' D/modes.json || Fail "no check"
# Without what the check says.
sed '/"data_driven"/,/}/d' D/modes.json >own.json
[[ $(grep -c '"frequency_hz"' own.json) -eq 3 ]] || Fail "three modes"
Near "$(Entry frequency_hz 1 own.json)" 2.7996 0.03
Near "$(Entry frequency_hz 2 own.json)" 7.6003 0.04
Near "$(Entry frequency_hz 3 own.json)" 11.3994 0.05
grep -q '<svg' D/report.html || Fail "no figure"
grep -q 'Covariance-driven stochastic subspace' D/report.html ||
  Fail "nothing of how it was found"
grep -q 'explained, %' D/report.html || Fail "nothing of what modes explain"
Refused "exists" --case=three_storey_ambient.toml --output_dir=D
Run 0 pinode_modes --case=three_storey_ambient.toml --output_dir=D --overwrite

# The record without a case.
Run 0 pinode_modes --case=wind.csv.gz --columns=a1,a2,a3 \
  --sampling_rate_hz=100 --output_dir=F
cmp <(grep frequency D/modes.json) <(grep frequency F/modes.json) ||
  Fail "a file alone says something else"
# Without a folder the modes are printed alone.
ls >before
Run 0 pinode_modes --case=wind.csv.gz --columns=a1,a2,a3 --sampling_rate_hz=100
grep -q '^3 modes were found' stdout || Fail "no modes are printed"
! grep -q '^Results' stdout || Fail "a folder is named"
cmp <(grep -vE '^(before|stdout|stderr)$' before) \
  <(ls | grep -vE '^(before|stdout|stderr)$') || Fail "files were written"
Refused "--mat needs --output_dir=FOLDER" --case=wind.csv.gz --columns=all \
  --sampling_rate_hz=100 --mat
Refused "a9" --case=wind.csv.gz --columns=a1,a9 --sampling_rate_hz=100 \
  --output_dir=E
Refused "columns" --case=three_storey_ambient.toml --sampling_rate_hz=100 \
  --output_dir=E

# A text file in a form that the flags state: every value is wrong without one.
{
  printf 'made by hand\nuhr|a1|a2|a3\n'
  zcat wind.csv.gz | awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
    {
      s = sprintf("%.2f|%s|%s|%s", NR / 100, $at["a1"], $at["a2"], $at["a3"])
      gsub(/\./, ",", s)
      print s
    }'
} | iconv -t UTF-16LE >form.csv
form=(--case=form.csv --columns=a1,a2,a3 --time=uhr)
Run 0 pinode_modes "${form[@]}" --encoding=UTF-16LE --header_lines=2 \
  --delimiter='|' --decimal=, --time_unit=s
cp stdout expected
# A tenth of the rate gives a tenth of the frequencies.
Run 0 pinode_modes "${form[@]}" --time_unit=ms
! cmp -s stdout expected || Fail "--time_unit changes nothing"
# A column in another unit than the rest.
mkdir half
zcat wind.csv.gz | awk -F, '
  NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; print "a1,a2,a3"; next }
  { printf "%.17g,%.17g,%.17g\n", $at["a1"], $at["a2"] / 2, -$at["a3"] }
' >half/wind.csv
half=(--case=half/wind.csv --columns=a1,a2,a3 --sampling_rate_hz=100)
Run 0 pinode_modes "${half[@]}" --scale=a2=2,a3=-1 --output_dir=half/scaled
Run 0 pinode_modes "${half[@]}" --output_dir=half/raw
Shapes() { grep -vE 'title|"command"|created' "$1/modes.csv"; }
cmp -s <(Shapes half/scaled) <(Shapes F) || Fail "--scale is not the factor"
! cmp -s <(Shapes half/raw) <(Shapes F) || Fail "--scale changes nothing"
Refused "scale: no channel 'a9'" "${half[@]}" --scale=a9=2 --output_dir=E
Refused "--scale: 'two', expected one factor" "${half[@]}" --scale=two \
  --output_dir=E
Refused "--scale needs --columns" --case=three_storey_ambient.toml --scale=2 \
  --output_dir=E
printf 'uhr,a1\n' >clock.csv
awk 'BEGIN { srand(1); for (i = 0; i < 3000; ++i)
  printf "12h%02dm%02d.%02d,%.6f\n", i / 6000, int(i / 100) % 60, i % 100,
    rand() - 0.5 }' >>clock.csv
clock=(--case=clock.csv --columns=a1 --time=uhr --output_dir=E)
"$programs/pinode_modes" "${clock[@]}" --time_format='%Hh%Mm%S.%f' \
  >stdout 2>stderr || [[ $? -eq 1 ]] || Fail "--time_format is not used"
rm -rf E
Refused 'set `time_format`, such as "%Hh%Mm%S.%f"' "${clock[@]}"
Refused "--delimiter: 'x', expected" "${clock[@]}" --delimiter=x
Refused "--decimal: ';', expected" "${clock[@]}" --decimal=';'
Refused "--delimiter: it is the sign of \`decimal\` too" "${clock[@]}" \
  --decimal=, --delimiter=,
Refused "time_unit and sampling_rate_hz are both given" --case=form.csv \
  --columns=a1 --time_unit=ms --sampling_rate_hz=100 --output_dir=E
Refused "--header_lines: '-3', expected" "${clock[@]}" --header_lines=-3
Refused "--time_unit: unit 'parsec' is not known" "${clock[@]}" \
  --time_unit=parsec
Refused "encoding 'no such' is not known" "${clock[@]}" --encoding='no such'
Refused "has fewer lines than" "${clock[@]}" --header_lines=9000
Refused "--encoding needs --columns" --case=three_storey_ambient.toml \
  --encoding=UTF-8 --output_dir=E

# The same motion seen along oblique directions: its modes at the DOFs, drawn.
{
  echo o1,o2,a3
  zcat wind.csv.gz | awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
    { printf "%.9g,%.9g,%s\n", 0.8 * $at["a1"] + 0.6 * $at["a2"],
             0.8 * $at["a2"] - 0.6 * $at["a1"], $at["a3"] }'
} >oblique.csv
{
  echo 'title = "Oblique"'
  sed -n '/^\[units\]/,/^time/p' three_storey_ambient.toml
  cat <<'CASE'
[geometry]
nodes = {g = [0, 0, 0], a = [0, 0, 3], b = [0, 0, 6], c = [0, 0, 9]}
dofs = {u1 = "a.1", u2 = "b.1", u3 = "c.1"}
  [[geometry.line]]
  nodes = ["g", "a", "b", "c"]
[[record]]
name = "wind"
file = "oblique.csv"
sampling_rate_hz = 100
excitation = "ambient"
  [[record.channel]]
  column = "o1"
  quantity = "absolute_acceleration"
  combination = {u1 = 0.8, u2 = 0.6}
  unit = "m/s^2"
  [[record.channel]]
  column = "o2"
  quantity = "absolute_acceleration"
  combination = {u1 = -0.6, u2 = 0.8}
  unit = "m/s^2"
  [[record.channel]]
  column = "a3"
  quantity = "absolute_acceleration"
  dof = "u3"
  unit = "m/s^2"
CASE
} >oblique.toml
Run 0 pinode_modes --case=oblique.toml --output_dir=O
Places() { sed -n '/"places"/,/]/p' "$1" | tr -d ' \n'; }
[[ $(Places O/modes.json) == "$(Places D/modes.json)" ]] || Fail "places"
sed '/"data_driven"/,/}/d' O/modes.json >oblique.json
for entry in 1 2 3 4 5 6 7 8 9; do
  Near "$(Entry real $entry oblique.json)" "$(Entry real $entry own.json)" 0.01
done
grep -q '"marks"' O/report.html || Fail "no structure in the report"
grep -q 'mode_3' O/structure.vtu || Fail "no shapes in structure.vtu"

# The modes in the place of the record: the storeys that the spectra give, too.
{
  sed '/^\[\[record\]\]/,$d; /^name    = "c_/,/^matrix/d' \
    three_storey_ambient.toml | awk '
      /^\[\[group\]\]/ { held = $0; next }
      held != "" { if ($0 ~ /^name/) print held; held = "" }
      { print }'
  cat D/modes.toml
} >modes_case.toml
Run 0 pinode_update --case=modes_case.toml --output_dir=U --progress=false
Run 0 pinode_update --case=three_storey_ambient.toml --output_dir=L \
  --progress=false
for name in k1 k2 k3; do
  by_modes=$(awk -F, -v name="$name" '$1 == name { print $4 }' U/parameters.csv)
  by_spectra=$(awk -F, -v name="$name" '$1 == name { print $4 }' L/parameters.csv)
  Near "$by_modes" "$by_spectra" 0.02
done
# What was found goes on as a case.
Run 0 pinode_check --case=L/model.toml

Refused "missing" --output_dir=E
Refused "two.toml" --case=two.toml --output_dir=E
sed 's/^excitation/window = [0.0, 1.5]\n&/' three_storey_ambient.toml >short.toml
Refused "too few" --case=short.toml --output_dir=E
sed 's/^title/[modes]\nhighest_hz = 80\n[nothing]\n&/; /^\[nothing\]/d' \
  three_storey_ambient.toml >high.toml
Refused "high.toml" --case=high.toml --output_dir=E
tested=pinode_update
sed 's/^excitation.*/&\n  start = "rest"/' three_storey_ambient.toml >start.toml
Refused "has no meaning" --case=start.toml --output_dir=E
tested=pinode_simulate
Refused "cannot be simulated" --case=three_storey_ambient.toml --output_dir=E
