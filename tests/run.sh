#!/bin/sh
# Builds and passes all tests on a fresh Debian 12 machine, packages included.
#   tests/run.sh             all tests, optimized: the preset `test`
#   tests/run.sh PRESET...   the tests of other presets, such as `dev`: with sanitizers
set -eu
cd "$(dirname "$0")/.."

echo "Installs what is missing, compiles and tests kinecal: 20 to 40 minutes on two cores."
cmake/install_packages.sh test

for preset in "${@:-test}"; do
  echo "== $preset, $(date +%H:%M:%S)"
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset"
  echo "== tests of $preset, $(date +%H:%M:%S)"
  ctest -j "$(nproc)" --preset "$preset" && continue
  echo "== once more, $(date +%H:%M:%S)"  # so that this ends with what failed
  ctest --preset "$preset" --rerun-failed --output-on-failure 2>&1 | tail -n 80
  exit 1
done
