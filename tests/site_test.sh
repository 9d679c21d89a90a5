#!/usr/bin/env bash
# The documentation site builds without a warning, and has a page for each
# document, each floor and the Python package. Two tutorials are run, one with a
# figure and one with a structure, and one report of the gallery is made.
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
"$root/pinode/site/build.sh" "$build" --tutorials=unknown_force,model_updating \
  --reports=impact "$scratch"
for page in index README pinode/site/gallery pinode/theory/README pinode/theory/ambient \
  pinode/case/README pinode/case/recipes pinode/case/first_case/logger \
  pinode/coming_from data/README tests/benchmarks/README \
  third_party_notes/eigen \
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
grep -q 'src="../../_static/reports/impact.html"' "$scratch/pinode/site/gallery.html" &&
  grep -q '<svg' "$scratch/_static/reports/impact.html" || {
  echo "the gallery has no report"
  exit 1
}
# A class with its comment, and functions with their docstrings.
grep -q 'Its grade is the best one that all findings allow' "$scratch/api/problem.html" || {
  echo "the API has not what the headers say"
  exit 1
}
modules=$(PYTHONPATH=$build/pinode/python /usr/bin/python3 -c '
import pinode
print(*(f"pinode.{name}" for name in pinode.MODULES))')
for module in pinode $modules; do
  if ! grep -q "id=\"module-$module\"" "$scratch/api_python.html"; then
    echo "the API has no module $module"
    exit 1
  fi
done
for name in identify_modes figures.changes frames.of_plan opensees.read calculix.export \
  elements.build Fit.save Damage.to_pandas; do
  if ! grep -q "id=\"pinode.$name\"" "$scratch/api_python.html"; then
    echo "the API has no pinode.$name"
    exit 1
  fi
done
# Docstrings: examples can be copied, arguments have what is said of them, and
# `names` are code.
grep -q '<span class="n">pinode</span><span class="o">.</span><span class="n">Case</span>' \
  "$scratch/api_python.html" || {
  echo "the API has no example of Python"
  exit 1
}
if grep -qE '</strong>( \(.*\))? –( |</p>|$)*<|“|”' "$scratch/api_python.html"; then
  echo "the API has arguments of which nothing is said, or quotes that are none"
  exit 1
fi
quoted=$(sed 's/<[^>]*>//g' "$scratch"/api/*.html "$scratch/api_python.html" | grep '`' || true)
if [[ -n $quoted ]]; then
  head -n 3 <<<"$quoted"
  echo "the API has names between backquotes"
  exit 1
fi
if grep -m1 '&amp;lt;' "$scratch"/api/*.html; then
  echo "the API has what stands for <"
  exit 1
fi

picture=$(sed -n 's/.*<img [^>]*src="\([^"]*times[^"]*\)".*/\1/p' \
  "$scratch/tests/benchmarks/README.html")
if [[ -z $picture || ! -s $scratch/tests/benchmarks/$picture ]]; then
  echo "the page of benchmarks has no figure"
  exit 1
fi

# What notebooks show, the pages of the tutorials do.
cd -- "$scratch/pinode/python/tutorials"
for tutorial in unknown_force model_updating; do
  picture=$(sed -n 's/.*<img [^>]*src="\([^"]*\)".*/\1/p' $tutorial.html)
  if [[ -z $picture || ! -s $picture ]]; then
    echo "the tutorial $tutorial has no figure"
    exit 1
  fi
  if grep -qE 'Warning|&lt;Figure|iterations \[' $tutorial.html; then
    echo "the tutorial $tutorial has what nobody wants to see"
    exit 1
  fi
done
# A page inside the page, in one piece.
grep -q '^<iframe title="The structure".*</iframe>' model_updating.html || {
  echo "the tutorial model_updating has no structure"
  exit 1
}

"$root/tests/pages/site_width_test.py" "$scratch" || (($? == 77))
