#!/bin/sh
# Drives the page in Chromium, or reads recordings with other programs: browser_test.sh PAGE_FOLDER TEST PROGRAM.
# Needs Node 18 or later and the packages that `script/bootstrap` installs; without, it ends with 77: skipped.
set -eu
cd "$1"
command -v node >/dev/null || { echo "skipped: node is not installed"; exit 77; }
[ -d node_modules/playwright-core ] || { echo "skipped: the packages of npm are not installed; script/bootstrap test installs them"; exit 77; }
exec node "test/$2" "$3"
