#!/bin/sh
# docs.sh DOXYGEN DOXYFILE FOLDER: writes the API reference; fails with the list of what is not documented.
set -eu
mkdir -p "$3"
"$1" "$2" 2>"$3/warnings.txt"
# Members that say all by name and type, and copies and moves, need no words.
if grep -E 'warning:|error:' "$3/warnings.txt" |
  grep -vE 'Member .*((\(variable\))|operator=\(.*|&&\) noexcept).* is not documented'; then
  exit 1
fi
