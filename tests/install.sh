#!/bin/sh
# README's Install, word for word; then the package is used as its users do: a calibration from photographs,
# a report, and programs of their own against the libraries.  Afterwards the package is removed.
#   tests/install.sh    as root, or as somebody who may use sudo
set -eu
cd "$(dirname "$0")/.."

as_root=""
[ "$(id -u)" = 0 ] || as_root=sudo
sudo() { $as_root env DEBIAN_FRONTEND=noninteractive "$@"; }
work=$(mktemp -d)
trap 'sudo dpkg --remove python3-kinecal kinecal-robot-calibration kinecal-mpi kinecal-opencv libkinecal-dev kinecal >/dev/null 2>&1 || true; rm -rf "$work"' EXIT

dpkg -s libopencv-dev >/dev/null 2>&1 || sudo apt-get install -y -qq libopencv-dev >/dev/null
echo "== README, Install, $(date +%H:%M:%S)"
rm -f build/release/*kinecal*.deb
commands=$(sed -n '/^## Install/,/^## [^I]/s/^    //p' README.md | sed 's/apt install/apt install -y -qq/')
[ -n "$commands" ]
echo "$commands"
(eval "set -e; $commands") >"$work/log" 2>&1 || { tail -n 60 "$work/log"; exit 1; }
if grep -A 5 'warning:' "$work/log"; then
  echo "The build gives warnings." >&2
  exit 1
fi

echo "== kinecal as it is installed, $(date +%H:%M:%S)"
source=$PWD
cd "$work"
kinecal --version | tee version.txt
grep -q '^finds checkerboards (OpenCV), grids of discs (OpenCV), ChArUco boards (OpenCV)' version.txt
if ldd "$(command -v kinecal)" | grep opencv; then
  echo "The program links OpenCV: it shall load it when it needs it." >&2
  exit 1
fi
ldd "$(command -v kinecal)" | grep -q libkinecal_evaluation  # at this processor's level
for target in apriltag checkerboard; do
  rm -rf sim samples.yaml
  kinecal simulate "$source/examples/mobile_manipulator/mobile_manipulator.urdf" --target $target --poses 30 -o sim >/dev/null
  kinecal detect sim/capture.yaml --images sim/images --poses sim/poses.csv --camera sim/camera.yaml \
    --frame head_camera_rgb_optical_frame -o samples.yaml
done
kinecal calibrate --urdf sim/robot.urdf --config sim/calibrate.yaml --samples samples.yaml \
  --output calibrated --report report.html >calibrate.txt
head -n 3 calibrate.txt
grep -qE '^verdict: (good|use with care)' calibrate.txt
grep -q '</html>' report.html
man -w kinecal >/dev/null 2>&1 || [ -e /usr/share/man/man1/kinecal.1 ] || [ -e /usr/share/man/man1/kinecal.1.gz ]

echo "== where ROS looks, $(date +%H:%M:%S)"
[ -e /usr/share/ament_index/resource_index/packages/kinecal ] && [ -e /usr/share/kinecal/package.xml ]
/usr/lib/kinecal/kinecal --version >/dev/null
sudo apt-get install -y -qq "$source"/build/release/kinecal-robot-calibration_*_all.deb >/dev/null
# shellcheck disable=SC2016  # bash expands it
[ "$(bash -c '. /usr/lib/kinecal/robot_calibration/setup.bash; "${AMENT_PREFIX_PATH%%:*}"/lib/robot_calibration/to_rpy 0 0 0.25')" = "0, 0, 0.25" ]

echo "== Python, $(date +%H:%M:%S)"
sudo apt-get install -y -qq "$source"/build/release/python3-kinecal_*.deb >/dev/null
export PYTHONDONTWRITEBYTECODE=1
(cd "$source/tests/python" && /usr/bin/python3 -m unittest -q)
for example in "$source"/examples/python/*.py; do
  /usr/bin/python3 "$example" >/dev/null
done
sudo dpkg --remove python3-kinecal >/dev/null
/usr/bin/python3 -m venv --system-site-packages venv  # NumPy is Debian's
venv/bin/pip install -q --no-index "$source"
venv/bin/python -c 'import kinecal; print(kinecal.__version__, kinecal.__file__)' | grep -q venv
venv/bin/kinecal --version >/dev/null

echo "== programs of a user's own, $(date +%H:%M:%S)"
cmake -S "$source/tests/consumer" -B consumer -G Ninja -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build consumer
consumer/consumer
consumer/finders >finders.txt
if grep OpenCV finders.txt; then
  echo "The library does not find its plug-in of OpenCV." >&2
  exit 1
fi
# shellcheck disable=SC2046  # words on purpose
g++ -std=c++20 "$source/tests/consumer/io.cpp" -o by_pkg_config $(pkg-config --cflags --libs kinecal-io)
./by_pkg_config "$source/tests/consumer/pendulum.urdf"
