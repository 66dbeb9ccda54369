#!/usr/bin/env bash
# callgrind_guard.sh BIN BOUNDS [--record]: counts the instructions of fixed pieces of work (workloads.sh) under callgrind and holds them to
# the bounds: exit 1 where one needs more than 6 % beyond its bound. Counts do not depend on how busy the machine is, but on the compiler;
# where that is another one, exit 77: not compared. --record writes the bounds anew.
set -euo pipefail
bin=$(realpath "$1") bounds=$(realpath "$2") mode=${3:-}
workloads=$(dirname "$(realpath "${BASH_SOURCE[0]}")")/workloads.sh
tolerance_percent=6
command -v valgrind >/dev/null || { echo "valgrind is not installed"; exit 77; }
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT

compiler=$(readelf -p .comment "$bin/pmacc" | grep -oE 'GCC: .*|clang version .*' | sort -u | head -1)
# Library functions for every processor, so that this one's abilities do not count.
export GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX512F,-AVX2,-AVX,-FMA,-FMA4,-ERMS

# count COMMAND...: instructions; nothing where the command fails
count() {
  (cd "$folder" && valgrind --tool=callgrind --callgrind-out-file=/dev/null "$@" 2>counts >/dev/null && awk '/Collected/ { print $4 }' counts)
}

bound_of() { awk -v name="$1" '$1 == name { print $2 }' "$bounds"; }

if [ "$mode" = --record ]; then
  { echo "# Instructions of each piece of work; ./dev guard --record writes this file."; echo "compiler $compiler"; } > "$bounds.new"
elif [ "$(sed -n 's/^compiler //p' "$bounds")" != "$compiler" ]; then
  echo "the bounds are those of another compiler than $compiler"
  exit 77
fi

"$workloads" "$folder" "$bin" > "$folder/list"
status=0
while read -r name command; do
  counted=$(count $command) || { echo "$name failed: $command"; cat "$folder/counts"; exit 1; }
  if [ "$mode" = --record ]; then
    echo "$name $counted" >> "$bounds.new"
    printf '%-10s %15s\n' "$name" "$counted"
    continue
  fi
  bound=$(bound_of "$name")
  percent=$(awk -v c="$counted" -v b="${bound:-0}" 'BEGIN { printf "%.1f", (b > 0 ? 100 * (c / b - 1) : 100) }')
  printf '%-10s %15s  bound %15s  %s %%\n' "$name" "$counted" "${bound:-none}" "$percent"
  if awk -v p="$percent" -v t=$tolerance_percent 'BEGIN { exit !(p > t) }'; then status=1; fi
done < "$folder/list"
[ "$mode" != --record ] || mv "$bounds.new" "$bounds"
[ $status = 0 ] || echo "more instructions than the bound and $tolerance_percent %: find out why, or record new bounds with ./dev guard --record"
exit $status
