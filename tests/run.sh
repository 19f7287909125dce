#!/bin/sh
# Builds and passes all tests on a fresh Debian 12 machine, packages included.
#   tests/run.sh [PRESET...]    dev by default: sanitizers, warnings as errors
set -eu
cd "$(dirname "$0")/.."

echo "Installs what is missing, compiles and tests kinecal: about 25 minutes on two cores."
cmake/install_packages.sh test
for preset in "${@:-dev}"; do
  echo "== $preset, $(date +%H:%M:%S)"
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset"
  echo "== tests of $preset, $(date +%H:%M:%S)"
  ctest --preset "$preset" -j "$(nproc)" && continue
  echo "== once more, so that this ends with what failed"
  ctest --preset "$preset" --rerun-failed --output-on-failure 2>&1 | tail -n 80
  exit 1
done
