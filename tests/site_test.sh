#!/usr/bin/env bash
# The documentation site, but for running the tutorials, builds without a
# warning, and has a page for each document, each floor and the Python package.
#
#   tests/site_test.sh BUILD_DIR
#
# Skipped (77) without Sphinx, MyST, breathe, nbconvert or Doxygen, and without
# the Python package in BUILD_DIR.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)

build=$1
if ! /usr/bin/python3 -c 'import sphinx, myst_parser, breathe, nbconvert' \
  2>/dev/null || ! command -v doxygen >/dev/null; then
  echo "not all of pinode/site/packages.txt is there: skipped"
  exit 77
fi
if ! PYTHONPATH=$build/pinode/python /usr/bin/python3 -c 'import pinode' \
  2>/dev/null; then
  echo "no Python package in $build: skipped"
  exit 77
fi
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
"$root/pinode/site/build.sh" "$build" --tutorials_as_they_are "$scratch"
for page in index pinode/theory pinode/case/README pinode/coming_from \
  data/README tests/benchmarks/README third_party_notes/eigen \
  pinode/python/tutorials/unknown_force api_python api/base api/estimate; do
  if ! grep -q '<h1>' "$scratch/$page.html"; then
    echo "the site has no page $page"
    exit 1
  fi
done
grep -q 'coming_from.html' "$scratch/index.html" || {
  echo "the index does not lead to pinode/coming_from"
  exit 1
}
# A class with its comment, and functions with their docstrings.
grep -q 'What the fit says of an ambient record' "$scratch/api/estimate.html" || {
  echo "the API has not what the headers say"
  exit 1
}
for name in identify_modes figures.changes frames.of_plan opensees.read calculix.export; do
  if ! grep -q "id=\"pinode.$name\"" "$scratch/api_python.html"; then
    echo "the API has no pinode.$name"
    exit 1
  fi
done
