#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Usage: in_display.sh <command>…
# Gives a command an X server of its own. Other than with xvfb-run -a, the server itself picks the
# number of its display, so that two that start at once never pick the same.
set -eu
folder=$(mktemp -d)
mkfifo "$folder/number"
# The server shall not start anew when it has no client: one rank that leaves it would cut off
# another one that is just coming.
Xvfb -displayfd 3 -noreset -nolisten tcp -screen 0 1280x1024x24 \
  3>"$folder/number" >"$folder/log" 2>&1 &
server=$!
trap 'kill $server 2>/dev/null && wait $server || :; rm -r "$folder"' EXIT
if ! read -r number <"$folder/number"; then
  cat "$folder/log" >&2
  exit 1
fi
status=0
DISPLAY=:$number "$@" || status=$?
exit $status
