#!/usr/bin/env bash
# From a finite-element model and records to a verdict: the frame of data/.
#
#   tests/programs/frame_test.sh PROGRAM_DIR STATE...
#
# Three healthy records make the baseline. Of each state the groups that
# truth.json names must be the only ones that changed, each within one point of
# the truth, which is CalculiX'.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
shift
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/frame" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cd -- "$scratch"
source "$here/testing.sh"

for n in 1 2 3; do
  Run 0 pinode_update --case="$data/healthy_$n.toml" --output_dir=D$n \
    --progress=false
done

# The design model, updated, is the structure as it was built.
python3 - "$data/truth.json" D1 D2 D3 <<'EOF' || Fail "baseline"
import csv, json, sys
truth = json.load(open(sys.argv[1]))
for folder in sys.argv[2:]:
    found = {row["name"]: float(row["value"])
             for row in csv.DictReader(open(folder + "/parameters.csv"))}
    off = {name: 100 * (found[name] - value)
           for name, value in truth["as_built"].items()}
    worst = max(off, key=lambda name: abs(off[name]))
    print("%s: farthest from as built: %s, %.2f points" %
          (folder, worst, off[worst]))
    if abs(off[worst]) > 1.0:
        sys.exit(1)
EOF

missed=()
for state in "$@"; do
  Run 0 pinode_damage --baseline=D1,D2,D3 --case="$data/$state.toml" \
    --output_dir="$state" --progress=false
  python3 - "$data/truth.json" "$state" <<'EOF' || missed+=("$state")
import json, sys
state = sys.argv[2]
truth = json.load(open(sys.argv[1]))["states"][state]
damage = json.load(open(state + "/damage.json"))
print("%s: %s" % (state, damage["verdict"]))
if state == "gap":
    nonlinearity = damage["nonlinearity"]
    print("   force at %s, %.2f %% of the restoring force" %
          (nonlinearity["place"], 100 * nonlinearity["force_share"]))
    sys.exit(damage["verdict"] != "nonlinear" or
             nonlinearity["place"] != truth["gap"]["joint"])
changes = truth["changes"]
verdict = ("no_damage" if not changes else
           "damage" if min(changes.values()) < 0 else "other_change")
good = damage["verdict"] == verdict
for group in damage["groups"]:
    name = group["name"]
    if group["damaged"] != (name in changes):
        print("   wrongly %s: %s, %.2f %%" %
              ("changed" if group["damaged"] else "unchanged", name,
               100 * group["change"]))
        good = False
    if name in changes:
        off = 100 * (group["change"] - changes[name])
        print("   %s: %.2f points off" % (name, off))
        good = good and abs(off) <= 1.0
sys.exit(not good)
EOF
done
[[ ${#missed[@]} -eq 0 ]] || Fail "not as the truth: ${missed[*]}"
