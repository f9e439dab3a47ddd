#!/bin/sh
# Whether the page that ships was made from the sources that lie beside it, and is small enough. Needs no
# Node.
set -eu
cd "$1"
sha256sum --check --quiet built/sources.sha256
listed=$(grep -c '  src/' built/sources.sha256)
there=$(find src -type f | wc -l)
[ "$listed" -eq "$there" ] || { echo "src has $there files, the page was built from $listed"; exit 1; }
size=$(wc -c <built/index.html.gz)
[ "$size" -le 120000 ] || { echo "the page has $size bytes compressed; at most 120000 are allowed"; exit 1; }
echo "the page was built from its $there sources, $size bytes compressed"
