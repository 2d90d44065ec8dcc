#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Usage: in_empty_folder.sh <folder> <command>…
# A file left by the last run would be taken up again by the filters that resume.
set -eu
folder=$1
shift
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
exec "$@"
