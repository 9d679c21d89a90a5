#!/usr/bin/env bash
# Shows that floors_check.sh can fail: on the fixture it must refuse exactly the
# lines marked `// refused`, and nothing there is too little to check.
set -euo pipefail

here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
check=$here/floors_check.sh
fixture=$here/floors_fixture
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT

status=0
"$check" "$fixture" >"$scratch/messages" || status=$?
if [[ $status -ne 1 ]]; then
  echo "floors_check.sh left with $status on the fixture, expected 1"
  exit 1
fi

(cd -- "$fixture" && grep -rn '// refused$' --include='*.cc' --include='*.h' .) |
  sed -E 's|^\./([^:]+:[0-9]+):.*|\1|' | LC_ALL=C sort >"$scratch/expected"
sed -E 's|^([^:]+:[0-9]+): .*|\1|' "$scratch/messages" | LC_ALL=C sort -u \
  >"$scratch/refused"
if ! diff "$scratch/expected" "$scratch/refused"; then
  echo "expected (<) and refused (>) lines differ; the messages were:"
  cat -- "$scratch/messages"
  exit 1
fi

mkdir -p -- "$scratch/empty/pinode"
status=0
"$check" "$scratch/empty" 2>/dev/null || status=$?
if [[ $status -ne 2 ]]; then
  echo "floors_check.sh left with $status on a tree without sources, expected 2"
  exit 1
fi
echo "refused all $(wc -l <"$scratch/expected") marked lines and no other"
