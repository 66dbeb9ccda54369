#!/usr/bin/env bash
# training.sh BIN: what a PGO build learns from: the pieces of work of the guard, and every program of the course.
set -euo pipefail
bin=$(realpath "$1")
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
"$here/workloads.sh" "$folder" "$bin" | while read -r _ command; do (cd "$folder" && $command >/dev/null 2>&1); done
cd "$here/.."
programs/command_lines.sh | while read -r line; do eval "\"$bin\"/pmac-run $line" >/dev/null 2>&1 </dev/null || true; done
