#!/usr/bin/env bash
# Builds the documentation site: the project's documents as they are, the
# tutorials as they run, and the API of both languages.
#
#   pinode/site/build.sh BUILD_DIR [--tutorials=NAME,...] [--reports=NAME,...] [OUTPUT]
#
# BUILD_DIR: a build folder with the programs, which write the reports of the
# gallery, and the Python package, which the tutorials run and whose docstrings
# are read. OUTPUT: where the pages go, BUILD_DIR/site unless given. --tutorials:
# only these are run, the others have no figures. --reports: only these are in the
# gallery. What Sphinx warns of is an error. Installs nothing; the packages are in
# pinode/site/packages.txt.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
build=
output=
options=()
for argument in "$@"; do
  case $argument in
    --tutorials=* | --reports=*) options+=("$argument") ;;
    *) if [[ -z $build ]]; then build=$argument; else output=$argument; fi ;;
  esac
done
if [[ -z $build ]]; then
  sed -n '2,/^set/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
  exit 2
fi
build=$(cd -- "$build" && pwd)
output=${output:-$build/site}
# Debian's own, for which its packages are.
python=/usr/bin/python3
export PYTHONPATH=$build/pinode/python${PYTHONPATH:+:$PYTHONPATH}
export PYTHONDONTWRITEBYTECODE=1 MPLBACKEND=Agg
export PINODE_SOURCE_DIR=$root PINODE_BUILD_DIR=$build

source=$build/site_source
rm -rf -- "$source"
mkdir -p -- "$source"
mkdir -p -- "$build/site_doxygen"
(
  cd -- "$root"
  OUTPUT=$build/site_doxygen doxygen pinode/site/Doxyfile
)
"$python" "$root/pinode/site/stage.py" "${options[@]}" "$root" "$build" "$source"
# Once a header, the namespace is one and the same.
"$python" -m sphinx -q -b html -w "$source/warnings" "$source" "$output" 2>/dev/null
if grep -v -e 'namespacepinode' -e 'Duplicate C++ declaration' -e '^Declaration is' \
  -e '^$' "$source/warnings" >&2; then
  exit 1
fi
echo "$output/index.html"
