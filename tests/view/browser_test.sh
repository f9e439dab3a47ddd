#!/bin/sh
# Checks or tests the page: browser_test.sh PAGE_FOLDER check, or browser_test.sh PAGE_FOLDER TEST.mjs PROGRAM
# Needs Node 18 or later and the packages that `script/bootstrap` installs; without, it ends with 77: skipped.
set -eu
cd "$1"
command -v npm >/dev/null || { echo "skipped: node is not installed"; exit 77; }
[ -d node_modules/prettier ] || { echo "skipped: the packages of npm are not installed; script/bootstrap test installs them"; exit 77; }
if [ "$2" = check ]; then exec npm run --silent check; fi
page_test=$2
shift 2
exec node "test/$page_test" "$@"
