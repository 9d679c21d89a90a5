# Sourced by scripts of the folder above:
#
#   source "$(dirname -- "${BASH_SOURCE[0]}")/ambient/setup.sh" MODULES TARGET...
#
# Goes to the project's root. Ends the script where Python (PYTHON, default
# python3) has not the modules ("numpy, scipy"). Sets `build`, the folder
# PINODE_BUILD_DIR or that of the release preset with the targets built in it;
# and `work`, a folder that goes with the script, or KEEP, which stays.
# shellcheck shell=bash

cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../../.."
if ! "${PYTHON:-python3}" -c "import $1" 2>/dev/null; then
  echo "skipped: no $1"
  exit 0
fi
shift
build=${PINODE_BUILD_DIR:-build-release}
if [[ -z ${PINODE_BUILD_DIR:-} ]]; then
  apps/install_packages.sh apps/packages.txt tests/packages.txt
  cmake --preset release >/dev/null
  cmake --build --preset release --parallel "$(nproc)" --target "$@"
fi
if [[ -n ${KEEP:-} ]]; then
  work=$KEEP
  mkdir -p "$work"
else
  work=$(mktemp -d)
  trap 'rm -rf -- "$work"' EXIT
fi
