#!/bin/sh
# Calibrates the example robot on a fresh Debian 12 machine, packages included, and shows the result.
set -eu
cd "$(dirname "$0")/.."

echo "Installs what is missing, compiles the program kinecal (some minutes on two cores) and"
echo "calibrates a simulated robot with it."
cmake/install_packages.sh
cmake --preset release -B build/demo -DKINECAL_BUILD_TESTS=OFF -DKINECAL_BUILD_BENCHMARKS=OFF \
  -DKINECAL_X86_64_LEVELS=OFF -DKINECAL_PYTHON=OFF >/dev/null
# The last two are for `cmake --install build/demo`.
cmake --build build/demo --target kinecal_program generate_example_samples kinecal_robot_header \
  kinecal_descriptions

robot=examples/mobile_manipulator
out=build/demo/mobile_manipulator
mkdir -p "$out"
echo
echo "== Samples of a robot whose zeros, frames and camera are wrong, with noise and a bad capture"
build/demo/bin/generate_example_samples "$robot/mobile_manipulator.urdf" "$out"
build/demo/bin/kinecal inspect "$out/samples.yaml"
echo "== kinecal calibrate"
build/demo/bin/kinecal calibrate --urdf "$robot/mobile_manipulator.urdf" \
  --config "$robot/calibrate.yaml" --samples "$out/samples.yaml" --output "$out/calibrated" --force \
  --report "$out/report.html"
echo
echo "Look at it in a browser: $out/report.html"
