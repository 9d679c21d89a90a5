#!/usr/bin/env bash
# A backfill of pinode_watch that is killed 100 times, with a full disk, a locked
# store, and records twice and out of order: every record is stored once, and
# the result is that of a run without all this.
#
#   tests/programs/watch_load.sh PROGRAM_DIR [PYTHON] [KILLS]
#
# Skipped (77) where the program or NumPy is not installed.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
python=${2:-/usr/bin/python3}
kills=${3:-100}
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/watched_bridge" && pwd)
[[ -x $programs/pinode_watch ]] || exit 77
"$python" -c 'import numpy, scipy' 2>/dev/null || exit 77
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cd -- "$scratch"

tested=pinode_watch
source "$here/testing.sh"

"$python" -B "$data/generate.py" --output W --days 6 --seconds 40 \
  --scatter 0.0005 --loss 0.15 --loss_day 5
cd W
sed -i -e 's/^records = .*/records = 100/' -e 's/^max_order = .*/max_order = 16/' \
  watched_bridge.toml
cp records/girder_20240102_0000.csv records/twice.csv
watch=("$programs/pinode_watch" --structure=watched_bridge.toml)

# The result without any trouble.
"${watch[@]}" --store=calm.db --once --output_dir=calm >/dev/null
[[ $(wc -l <calm/histories.csv) -eq 145 ]] || Fail "expected 144 records"
grep -q '"light": "alarm"' calm/watch.json || Fail "expected an alarm"

# The later half first, and killed at random. The pause grows from nothing to
# the length of a whole run, so that all stages are met.
mkdir late
mv records/girder_202401{04,05,06}*.csv late
RANDOM=7
sources=(--backfill=late --once)
for ((i = 0; i < kills; ++i)); do
  "${watch[@]}" --store=w.db "${sources[i * 2 / kills]}" >/dev/null 2>&1 &
  sleep "$(awk -v r=$RANDOM 'BEGIN { print 0.02 + 0.8 * (r / 32768) ^ 2 }')"
  kill -KILL $! 2>/dev/null || true
  wait $! 2>/dev/null || true
done

Stored() {
  "$python" - "$1" <<'END'
import sqlite3, sys
store = sqlite3.connect(sys.argv[1])
assert store.execute("PRAGMA integrity_check").fetchone()[0] == "ok"
print(store.execute("SELECT count(*) FROM record").fetchone()[0],
      store.execute("SELECT count(DISTINCT content) FROM record").fetchone()[0],
      store.execute("SELECT count(*) FROM record WHERE id NOT IN "
                    "(SELECT record FROM channel)").fetchone()[0])
END
}
read -r count different without <<<"$(Stored w.db)"
echo "$kills kills: $count records stored"
[[ $count -eq $different ]] || Fail "a record is stored twice"
[[ $without -eq 0 ]] || Fail "$without records are stored in part"

# A full disk: no file may grow beyond 300 kB, which the store needs. One line,
# and what was stored before is whole.
status=0
(ulimit -f 300 && exec "${watch[@]}" --store=full.db --once) >/dev/null 2>stderr ||
  status=$?
[[ $status -eq 2 || $status -eq 153 ]] || Fail "full disk: status $status"
[[ $status -ne 2 || $(wc -l <stderr) -eq 1 ]] || Fail "full disk: several lines"
read -r count different without <<<"$(Stored full.db)"
echo "full disk: status $status, $count records stored"
[[ $count -gt 0 && $count -lt 145 ]] || Fail "the disk was not full: $count"
[[ $count -eq $different && $without -eq 0 ]] || Fail "full disk: not whole"

# A store that another process locks for three seconds is waited for.
"$python" - <<'END' &
import sqlite3, time
store = sqlite3.connect("w.db", isolation_level=None)
store.execute("BEGIN EXCLUSIVE")
open("locked", "w").close()
time.sleep(3)
store.execute("ROLLBACK")
END
until [[ -e locked ]]; do sleep 0.05; done
"${watch[@]}" --store=w.db --backfill=late >/dev/null || Fail "a lock ended it"
wait

# Two at a time, then both stores to the end.
"${watch[@]}" --store=w.db --once >/dev/null &
other=$!
"${watch[@]}" --store=w.db --backfill=late >/dev/null || Fail "two at a time"
wait $other || Fail "two at a time"
for store in w full; do
  "${watch[@]}" --store=$store.db --backfill=late >/dev/null
  "${watch[@]}" --store=$store.db --once --output_dir=$store >/dev/null
  # The same content has two names.
  for result in calm $store; do
    sed 's/twice/girder_20240102_0000/' $result/histories.csv >$result.csv
  done
  cmp calm.csv $store.csv || Fail "$store: other histories"
  cmp calm/alarms.csv $store/alarms.csv || Fail "$store: other alarms"
  read -r count different without <<<"$(Stored $store.db)"
  [[ $count -eq 144 && $different -eq 144 && $without -eq 0 ]] ||
    Fail "$store: $count records, $different different, $without in part"
done
