#!/bin/sh
# Puts the server and its npm packages into a folder; tests that run at the same time may share it.
#   install.sh FOLDER
set -eu
sources=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
cd "$1"
exec 9>../"$(basename "$1")".lock
flock 9

# A file is replaced only if it differs, and in one step: other servers may be reading it.
for file in "$sources"/*.mjs "$sources"/package*.json; do
  name=$(basename "$file")
  cmp -s "$file" "$name" && continue
  cp "$file" "$name.new"
  mv "$name.new" "$name"
done
test -d node_modules/ws && cmp -s package-lock.json installed.json && exit 0
npm ci --no-audit --no-fund
cp package-lock.json installed.json
