#!/bin/sh
# Installs the Debian 12 packages that kinecal needs, without asking; nothing if all are there.
#   cmake/install_packages.sh [test]    with `test`, also what the tests need
set -eu

packages="g++ cmake ninja-build libeigen3-dev libceres-dev liburdfdom-dev libyaml-dev pkg-config \
libpugixml-dev libfmt-dev zlib1g-dev libcli11-dev libbz2-dev liblz4-dev libzstd-dev libsqlite3-dev \
libpng-dev libjpeg-dev libtiff-dev libapriltag-dev libboost-dev nlohmann-json3-dev libssl-dev dpkg-dev file \
pybind11-dev python3-dev python3-numpy"
if [ "${1:-}" = test ]; then
  packages="$packages ccache lld clang-14 libclang-rt-14-dev clang-format-14 clang-tidy-14 libgtest-dev libgmock-dev libbenchmark-dev liborocos-kdl-dev \
libopenmpi-dev openmpi-bin doxygen libfastcdr-dev libyaml-cpp-dev libopencv-dev python3 python3-jsonschema python3-yaml python3-venv mypy chromium"
  command -v npm >/dev/null || packages="$packages nodejs npm"  # others ship both as one package
fi

missing=""
for package in $packages; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' ||
    missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=""
[ "$(id -u)" = 0 ] || as_root=sudo
echo "Installing:$missing"
$as_root apt-get update -qq
# shellcheck disable=SC2086  # words on purpose
$as_root env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -qq --no-install-recommends $missing >/dev/null
