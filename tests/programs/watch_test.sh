#!/usr/bin/env bash
# Years of records in a few seconds: pinode_watch from files to an alarm, killed
# on the way, with records twice and in another order.
#
#   tests/programs/watch_test.sh PROGRAM_DIR [PYTHON]
#
# Skipped (77) where the program or NumPy is not installed.
set -euo pipefail

programs=$(cd -- "$1" && pwd)
python=${2:-/usr/bin/python3}
here=$(cd -- "$(dirname -- "$0")" && pwd)
data=$(cd -- "$here/../../data/watched_bridge" && pwd)
[[ -x $programs/pinode_watch ]] || exit 77
"$python" -c 'import numpy, scipy' 2>/dev/null || exit 77
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cd -- "$scratch"

tested=pinode_watch
source "$here/testing.sh"

# Two days in steps of an hour, short records. A third of the bridge loses 15 %.
"$python" -B "$data/generate.py" --output W --days 2.5 --seconds 40 \
  --scatter 0.0005 --loss 0.15 --loss_day 2 --stuck 5
cd W
sed -i -e 's/^records = .*/records = 40/' -e 's/^max_order = .*/max_order = 16/' \
  watched_bridge.toml
grep -q '^records = 40' watched_bridge.toml || Fail "the structure file differs"

# Bad usage and bad files, in one line, and no store is made by them.
Refused "--structure=FILE is missing" --store=E
Refused "--store=FILE is missing" --structure=watched_bridge.toml
Refused "nothing.toml" --structure=nothing.toml --store=E
Refused "--overwrite needs --output_dir" --structure=watched_bridge.toml \
  --store=E --overwrite
Refused "at least 1" --structure=watched_bridge.toml --store=E \
  --interval_seconds=0
Refused "no such store" --structure=watched_bridge.toml --store=E \
  --mend=reject:a.csv --by=N --why=crane
Refused "expected reject:FILE" --structure=watched_bridge.toml --store=E \
  --mend=lose:a.csv --by=N --why=crane
Refused "leave out --output_dir" --structure=watched_bridge.toml --store=E \
  --mend=reject:a.csv --by=N --why=crane --once
[[ ! -e E ]] || Fail "a refused decision made a store"
sed 's/^pattern/patern/' watched_bridge.toml >bad.toml
Refused "did you mean 'pattern'" --structure=bad.toml --store=E
Run 2 pinode_watch --structure=watched_bridge.toml --store=none/w.db --once
grep -q "cannot be opened" stderr || Fail "no word on the folder of the store"
sed 's/^folder.*/folder = "none"/' watched_bridge.toml >bad.toml
Run 2 pinode_watch --structure=bad.toml --store=bad.db --once
grep -q "correct .folder. in .records." stderr || Fail "no word on the folder"
echo "some text that is not a database, but long enough for one" >text.db
Refused "not a store" --structure=watched_bridge.toml --store=text.db --once

# Killed a few times, then to the end; one file twice, one broken.
cp records/girder_20240101_0000.csv records/twice.csv
echo "nothing" >records/broken.csv
watch=("$programs/pinode_watch" --structure=watched_bridge.toml --store=w.db --once)
for pause in 0.2 0.5 0.9; do
  "${watch[@]}" >/dev/null 2>&1 &
  sleep "$pause"
  kill -KILL $! 2>/dev/null || true
  wait $! 2>/dev/null || true
done
Run 0 pinode_watch --structure=watched_bridge.toml --store=w.db --once \
  --output_dir=D
grep -q '62 files' stdout || Fail "expected 62 files"
grep -q '60 records, 40 in the reference' stdout || Fail "expected 60 records"
grep -qE "^2024-01-03 .* alarm: .*channel 'a5' is left out: it is dead.*mode" stdout ||
  Fail "expected an alarm that names the sensor first"
! grep -q '^2024-01-0[12] .* alarm' stdout || Fail "an alarm before the loss"
for file in histories.csv alarms.csv watch.json watch.prom watch.html; do
  [[ -s D/$file ]] || Fail "no $file"
done
[[ $(wc -l <D/histories.csv) -eq 61 ]] || Fail "expected 60 rows"
[[ $(cut -d, -f1 D/histories.csv | sort | uniq -d | wc -l) -eq 0 ]] ||
  Fail "a record is there twice"
grep -q '"light": "alarm"' D/watch.json || Fail "no alarm in watch.json"
grep -q '<svg' D/watch.html || Fail "no figure"
! grep -q 'could not be drawn' D/watch.html || Fail "a figure is missing"
! grep -qE '(src|href)="?https?:' D/watch.html || Fail "the page loads something"

# A decision about a structure that is not there adds none.
sed 's/^name = "watched_bridge"/name = "other"/' watched_bridge.toml >bad.toml
grep -q '^name = "other"' bad.toml || Fail "the structure file differs"
Run 2 pinode_watch --structure=bad.toml --store=w.db --mend=name:2=a --by=N --why=b
grep -q "no structure 'other' is in this store" stderr || Fail "a structure was added"

# All is known now.
Run 0 pinode_watch --structure=watched_bridge.toml --store=w.db --once
grep -q ' 0 new' stdout || Fail "expected nothing new"
! grep -q ' alarm: ' stdout || Fail "an alarm is printed again"
Run 2 pinode_watch --structure=watched_bridge.toml --store=w.db --once \
  --output_dir=D
grep -q exists stderr || Fail "the folder was replaced"

# The alarm of the store is told once over each way, as soon as a server
# takes it.
export no_proxy=127.0.0.1 NO_PROXY=127.0.0.1
mkdir told
"$python" -B "$here/message_servers.py" told &
servers=$!
trap 'kill -KILL $servers 2>/dev/null || true; rm -rf -- "$scratch"' EXIT
for _ in $(seq 300); do
  [[ ! -s told/ports ]] || break
  sleep 0.1
done
read -r post mail <told/ports
cat watched_bridge.toml - >told.toml <<END
[notify]
webhook = "http://127.0.0.1:$post/hook?key=secret"
mail = "smtp://127.0.0.1:$mail"
mail_tls = false
from = "bridge@example.org"
to = ["engineer@example.org", "owner@example.org"]
END
touch told/closed
Run 1 pinode_watch --structure=told.toml --store=w.db --once
[[ $(wc -l <stderr) -eq 1 ]] || Fail "expected one line on the message"
grep -q "no message could be sent to 127.0.0.1:" stderr || Fail "no word on it"
! grep -q secret stderr || Fail "the key of the webhook is printed"
[[ ! -e told/posts && ! -e told/mails ]] || Fail "a closed server took a message"
rm told/closed
Run 0 pinode_watch --structure=told.toml --store=w.db --once
Run 0 pinode_watch --structure=told.toml --store=w.db --once
[[ $(wc -l <told/posts) -eq 1 ]] || Fail "expected one post"
grep -q '^application/json {"structure":"watched_bridge","text":' told/posts ||
  Fail "the post is not as documented"
[[ $(grep -c '^Subject: watched_bridge: ' told/mails) -eq 1 ]] || Fail "expected one mail"
grep -q 'RCPT TO:<owner@example.org>' told/mails || Fail "a receiver is missing"
grep -q "alarm: .*channel 'a5' is left out" told/mails || Fail "no reason in the mail"
kill -KILL $servers 2>/dev/null || true
wait $servers 2>/dev/null || true
trap 'rm -rf -- "$scratch"' EXIT

# A sensor that is turned is named by the shapes of five more records. The store
# knows the others.
mkdir turned
for hour in 5 6 7 8 9; do
  awk -F, -v OFS=, 'NR > 1 { $3 = -$3 } 1' "records/girder_20240103_0${hour}00.csv" \
    >"turned/girder_20240103_1${hour}00.csv"
done
cp w.db turned.db
Run 0 pinode_watch --structure=watched_bridge.toml --store=turned.db \
  --backfill=turned
grep -q "notice: a sensor has changed: channel 'a2' is turned" stdout ||
  Fail "a turned sensor is not named"

# The later half first, from another folder: the same histories and alarms.
mkdir late
mv records/girder_202401{02,03}*.csv late
Run 0 pinode_watch --structure=watched_bridge.toml --store=other.db --backfill=late
grep -q 'No alarm can be raised: the reference period is not complete' stdout ||
  Fail "expected no chart"
Run 0 pinode_watch --structure=watched_bridge.toml --store=other.db --once \
  --output_dir=F
sed 's/twice/girder_20240101_0000/' F/histories.csv >ordered.csv
cmp <(sed 's/twice/girder_20240101_0000/' D/histories.csv) ordered.csv ||
  Fail "the order of arrival matters"
cmp D/alarms.csv F/alarms.csv || Fail "the order of arrival matters"

# Records of a store are read alike.
sed 's/^max_order.*/max_order = 10/' watched_bridge.toml >bad.toml
Run 2 pinode_watch --structure=bad.toml --store=w.db --once
grep -q 'other settings' stderr || Fail "settings are mixed"

# Without --once it goes on until it is interrupted. An interrupt that comes
# early ends a look with 3; here all looks are over.
"$programs/pinode_watch" --structure=watched_bridge.toml --store=w.db \
  --interval_seconds=600 >stdout 2>stderr &
watcher=$!
trap 'kill -KILL $watcher 2>/dev/null || true; rm -rf -- "$scratch"' EXIT
for _ in $(seq 300); do
  ! grep -q ' 0 new' stdout || break
  sleep 0.2
done
grep -q ' 0 new' stdout || Fail "the watcher does not look"
for _ in $(seq 100); do
  kill -INT $watcher 2>/dev/null || break
  sleep 0.2
done
status=0
wait $watcher || status=$?
[[ $status -eq 0 ]] || Fail "interrupted: status $status"
