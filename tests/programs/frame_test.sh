#!/usr/bin/env bash
# From a finite-element model and records to a verdict: the frame of data/.
#
#   tests/programs/frame_test.sh PROGRAM_DIR [--report=FILE] STATE...
#
# Three healthy records make the baseline. Of each state the groups that
# truth.json names must be the only ones that changed, each within 0.3 points of
# the truth, which is CalculiX'. The last state's report is left as FILE.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
shift
report=
if [[ $1 == --report=* ]]; then
  report=${1#--report=}
  shift
fi
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/frame" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cd -- "$scratch"
source "$here/testing.sh"

for n in 1 2 3; do
  Run 0 pinode_update --case="$data/healthy_$n.toml" --output_dir=D$n \
    --progress=false --deck="$data/frame.inp"
done

# CalculiX exports from the updated deck what pinode makes of the matrices.
if command -v ccx >/dev/null; then
  mkdir ccx
  cp D1/frame_updated.inp ccx/deck.inp
  (cd ccx && ccx deck >log 2>&1) || Fail "ccx"
  for pair in sti:K_full mas:M_full; do
    awk -v name="${pair#*:}" '
      NR == FNR { exported[$1 " " $2] = $3; next }
      /^%/ || ++line == 1 { next }
      {
        # Upper triangle there, lower one here.
        value = exported[$2 " " $1]
        off = value > $3 ? value - $3 : $3 - value
        if (off > worst) worst = off
        if ($3 > largest) largest = $3
        ++count
      }
      END {
        printf "updated deck: %s off by %.1e\n", name, worst / largest
        exit !(count > 10000 && worst <= 1e-12 * largest)
      }' "ccx/deck.${pair%:*}" "D1/${pair#*:}.mtx" || Fail "updated deck"
  done
else
  echo "no ccx: the updated deck was not run"
fi
tested=pinode_update
sed 's/ELSET=brace_2/ELSET=brace_9/' "$data/frame.inp" >other.inp
Refused "'brace_2' cannot be changed" --case="$data/healthy_1.toml" \
  --output_dir=E --deck=other.inp
Refused "nowhere.inp: cannot open" --case="$data/healthy_1.toml" \
  --output_dir=E --deck=nowhere.inp
mkdir folder.inp
Refused "folder.inp: is a folder" --case="$data/healthy_1.toml" \
  --output_dir=E --deck=folder.inp
if [[ $(id -u) -ne 0 ]]; then
  chmod a-r other.inp
  Refused "other.inp: cannot open" --case="$data/healthy_1.toml" \
    --output_dir=E --deck=other.inp
else
  echo "skipped: a deck that may not be read; root may read anything"
fi

# A deck that goes wrong after the fit costs the deck alone: status 1, one line,
# and a folder that is complete without it. DeckLost DECK.
DeckLost() {
  [[ $(wc -l <stderr) -eq 1 ]] || Fail "expected one line"
  grep -q '^no updated deck: .*cannot' stderr || Fail "expected a reason"
  [[ -s E/report.html && -z $(find . -path './E*' -name '*.inp*') &&
    $(find . -maxdepth 1 -name 'E*') == ./E ]] || Fail "not a folder without"
  grep -q 'No updated deck' E/result.json || Fail "no remark"
}
# The deck's name is good, that of the updated one too long for a file.
long=$(printf 'n%.0s' {1..245}).inp
cp -- "$data/frame.inp" "$long"
cp -r D1 E
rm E/*.inp
Run 1 pinode_update --case="$data/healthy_1.toml" --output_dir=E --resume \
  --progress=false --deck="$long"
DeckLost
rm -r E
# The deck is gone when it is read again.
cp -- "$data/frame.inp" gone.inp
Vanish() {
  for _ in {1..500}; do
    compgen -G 'E.partial-*' >vanish && break
    sleep 0.02
  done
  rm gone.inp
}
Vanish &
Run 1 pinode_update --case="$data/healthy_1.toml" --output_dir=E \
  --progress=false --deck=gone.inp
wait
DeckLost
rm -r E

# "name value" of each entry of the object KEY in truth.json: of STATE, or, with
# "", at the top. One entry a line is how the generator writes them.
Truth() {
  awk -v state="$1" -v key="$2" '
    BEGIN { indent = state == "" ? "  " : "      " }
    state != "" && $0 ~ "^    \"" state "\": \\{" { here = 1 }
    here && /^    },?$/ { here = 0 }
    (here || state == "") && $0 ~ "^" indent "\"" key "\": \\{" {
      inside = $0 !~ /}/
      next
    }
    inside && /}/ { exit }
    inside { gsub(/[",:]/, " "); print $1, $2 }' "$data/truth.json"
}

# The design model, updated, is the structure as it was built.
Truth "" as_built >as_built
[[ $(wc -l <as_built) -eq 12 ]] || Fail "truth.json: not 12 groups as built"
for folder in D1 D2 D3; do
  awk -v folder=$folder '
    NR == FNR { truth[$1] = $2; next }
    FNR == 1 { FS = ","; $0 = $0; for (i = 1; i <= NF; ++i) at[$i] = i; next }
    $at["name"] in truth {
      off = 100 * ($at["value"] - truth[$at["name"]])
      size = off < 0 ? -off : off
      if (size >= largest) { largest = size; worst = off; name = $at["name"] }
      ++count
    }
    END {
      printf "%s: farthest from as built: %s, %.2f points\n", folder, name, worst
      exit !(count == length(truth) && largest <= 0.3)
    }' as_built $folder/parameters.csv || Fail "baseline $folder"
done

# Another structure in place of the first baseline: one entry of its stiffness.
cp -r D1 other
awk '!/^%/ && ++line == 2 { $3 *= 1.01 } { print }' D1/K_full.mtx \
  >other/K_full.mtx
tested=pinode_damage
Refused 'other/K_full.mtx: cannot be the updated matrix' --baseline=other \
  --case="$data/healthy_4.toml" --output_dir=E
Refused "'brace_2' cannot be changed" --baseline=D1 \
  --case="$data/healthy_4.toml" --output_dir=E --deck=other.inp

missed=()
for state in "$@"; do
  Run 0 pinode_damage --baseline=D1,D2,D3 --case="$data/$state.toml" \
    --output_dir="$state" --progress=false --deck="$data/frame.inp"
  # With the factors that the folder has, as pinode_update writes it.
  [[ -s $state/frame_updated.inp ]] || Fail "no updated deck of $state"
  ! cmp -s "$state/frame_updated.inp" D1/frame_updated.inp ||
    Fail "the deck of $state is that of the baseline"
  Truth "$state" changes >changes
  Groups "$state" >groups
  [[ -s groups ]] || Fail "no groups in $state/damage.json"
  expected=no_damage
  if [[ $state == gap ]]; then
    expected=nonlinear
  elif [[ -s changes ]]; then
    expected=other_change
    ! grep -q -e ' -' changes || expected=damage
  fi
  good=1
  grep -E '"(verdict|place|force_share)"' "$state/damage.json" |
    sed "s/^ */$state: /"
  grep -qF "\"verdict\": \"$expected\"" "$state/damage.json" || good=
  if [[ $state == gap ]]; then
    joint=$(Truth gap gap | awk '$1 == "joint" { print $2 }')
    grep -qF "\"place\": \"$joint\"" "$state/damage.json" || good=
    # A loose joint is none of the forms that are tried.
    grep -qF "A part of the change is of a kind that was not looked for." stdout || good=
  else
    awk -v state="$state" '
      FILENAME == "changes" { truth[$1] = $2; next }
      {
        if (($3 == "true") != ($1 in truth)) {
          printf "%s: wrongly %s: %s, %.2f %%\n", state,
                 $3 == "true" ? "changed" : "unchanged", $1, 100 * $2
          bad = 1
        }
        if ($1 in truth) {
          ++count
          off = 100 * ($2 - truth[$1])
          printf "%s: %s %.2f points off\n", state, $1, off
          if (off > 0.3 || off < -0.3) bad = 1
        }
      }
      END { exit bad || count != length(truth) }' changes groups || good=
  fi
  [[ -n $good ]] || missed+=("$state")
done
[[ ${#missed[@]} -eq 0 ]] || Fail "not as the truth: ${missed[*]}"
[[ -z $report ]] || cp -- "${!#}/report.html" "$report"
