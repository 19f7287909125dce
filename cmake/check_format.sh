#!/bin/sh
# Lists the sources that clang-format would change, and fails if there are any.
#   cmake/check_format.sh [--fix]    with --fix, formats them
set -eu
cd "$(dirname "$0")/.."

if [ "${1:-}" = --fix ]; then
  git ls-files --cached --others --exclude-standard -z '*.hpp' '*.ipp' '*.cpp' | xargs -0 clang-format-14 -i
  exit 0
fi
git ls-files --cached --others --exclude-standard -z '*.hpp' '*.ipp' '*.cpp' | xargs -0 -n 20 -P "$(nproc)" clang-format-14 --dry-run -Werror
