#!/bin/sh
# Builds and passes all tests on a fresh Debian 12 machine, packages included.
#   tests/run.sh             dev: with sanitizers, warnings as errors; then, in the release, what calibrates so
#                            often that it would take an hour with sanitizers
#   tests/run.sh PRESET...   all that these presets have
set -eu
cd "$(dirname "$0")/.."

echo "Installs what is missing, compiles and tests kinecal: about an hour on two cores."
cmake/install_packages.sh test

# run PRESET [ARGUMENT...]    tests of a preset; those that fail once more, so that this ends with what failed
run() {
  echo "== tests of $1, $(date +%H:%M:%S)"
  ctest -j "$(nproc)" --preset "$@" && return
  echo "== once more"
  ctest --preset "$1" --rerun-failed --output-on-failure 2>&1 | tail -n 80
  exit 1
}

for preset in "${@:-dev}"; do
  echo "== $preset, $(date +%H:%M:%S)"
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset"
  run "$preset"
done
if [ $# = 0 ]; then
  echo "== release, $(date +%H:%M:%S)"
  cmake --preset release -DKINECAL_BUILD_TESTS=ON >/dev/null
  cmake --build --preset release --target release_gate
  run release -L release_gate
fi
