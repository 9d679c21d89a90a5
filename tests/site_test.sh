#!/usr/bin/env bash
# The documentation site, without its API and without running the tutorials,
# builds without a warning, and has a page for each document.
#
#   tests/site_test.sh
#
# Skipped (77) without Sphinx, MyST and nbconvert.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)

if ! /usr/bin/python3 -c 'import sphinx, myst_parser, nbconvert' 2>/dev/null; then
  echo "no Sphinx, MyST or nbconvert (pinode/site/packages.txt): skipped"
  exit 77
fi
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
"$root/pinode/site/build.sh" "$scratch" --quick
for page in index pinode/theory pinode/case/README pinode/coming_from \
  data/README tests/benchmarks/README third_party_notes/eigen \
  pinode/python/tutorials/unknown_force; do
  if ! grep -q '<h1>' "$scratch/site/$page.html"; then
    echo "the site has no page $page"
    exit 1
  fi
done
grep -q 'coming_from.html' "$scratch/site/index.html" || {
  echo "the index does not lead to pinode/coming_from"
  exit 1
}
