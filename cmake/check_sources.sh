#!/bin/sh
# clang-tidy, and each header compiled alone.
#   cmake/check_sources.sh [changed|all]    changed: what commits of the day before the last one changed
set -eu
cd "$(dirname "$0")/.."

cmake --preset tidy >/dev/null
objects=$(ninja -C build/tidy -t targets all | sed -n 's/: CXX_COMPILER__.*//p')
if [ "${1:-changed}" = all ]; then
  chosen=$objects
else
  before=$(git rev-list -n 1 --before="$(($(git log -1 --format=%ct) - 86400))" HEAD)
  chosen=""
  for file in $(git diff --name-only --diff-filter=d "${before:-$(git rev-list --max-parents=0 HEAD)}" HEAD -- \
                  'include/*.hpp' 'include/*.ipp' 'include/*.cpp' 'examples/cli/*.cpp'); do
    case $file in
      *.hpp) object="verify_interface_header_sets.dir/.*$(echo "${file#include/}" | sed 's/\./[.]/g')" ;;
      *.ipp) object="/$(echo "${file#include/}" | tr /. __)[.]cpp" ;;
      include/*.cpp) object="/${file%.cpp}[.]cpp" ;;
      *) object="/$(basename "$file" .cpp)[.]cpp" ;;
    esac
    chosen="$chosen $(echo "$objects" | grep -E "$object" || true)"
  done
fi
# shellcheck disable=SC2086  # words on purpose
[ -z "$(echo $chosen)" ] || cmake --build --preset tidy --target $chosen
