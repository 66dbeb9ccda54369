#!/usr/bin/env bash
# Prints what pmac-run is given for every program of the course, a line each, as their heads say but without outputs and pictures.
# Paths are those from the root of the tree.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# The first command line of a head: behind "Run:" and what is further in on the next lines.
command_line() {
  awk '/^(\/\/|;) Run: / { sub(/^.*Run: *pmac-run */, ""); line = $0; next }
       line != "" && /^(\/\/|;)          +/ && !/pmac-run/ { sub(/^[\/;]+ */, ""); line = line " " $0; next }
       line != "" { print line; exit }' "$1" | sed -E 's/ --(plot|record) [^ ]+//g; s/ --stats//g'
}

find programs -name '*.pmc' -o -name '*.plc' -o -name '*.mcx' | sort | while read -r file; do command_line "$file"; done
for number in $(ls programs/acr1000 | grep -oE '^[0-9]+' | sort -un); do
  echo programs/acr1000/"${number}"_*.acr
done
