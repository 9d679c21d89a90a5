#!/usr/bin/env bash
# Prepares a build folder for clang, the compiler of the presets.
#
#   apps/new_compiler.sh BUILD_DIR
#
# CMake loses all settings of a folder whose compiler changes. If another
# compiler was used there, this removes what CMake remembers.
set -euo pipefail

cache=$1/CMakeCache.txt
if [[ -f $cache ]] && ! grep -q '^CMAKE_CXX_COMPILER:.*clang' "$cache"; then
  rm -rf -- "$cache" "$1/CMakeFiles"
fi
