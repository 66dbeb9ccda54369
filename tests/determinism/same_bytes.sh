#!/usr/bin/env bash
# same_bytes.sh BIN_A BIN_B RANDOM_PROGRAMS COUNT: object files, records, printed results and traces of every program of the course and of
# COUNT random programs of two kinds must be the same from pmacc and pmac-run of both folders. Exit 1 where one byte differs.
set -euo pipefail
bin_a=$(realpath "$1") bin_b=$(realpath "$2") random_programs=$(realpath "$3") count=${4:-50}
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
scratch=$(mktemp -d); trap 'rm -rf "$scratch"' EXIT
compared=0 different=0

# both WHAT COMMAND...: runs it with $bin and $out set for each side, then compares all that stands in the two folders.
both() {
  local what=$1 side bin out; shift
  for side in a b; do
    out=$scratch/$side; rm -rf "$out"; mkdir "$out"
    if [ $side = a ]; then bin=$bin_a; else bin=$bin_b; fi
    bin=$bin out=$out timeout -s KILL 600 bash -c "$*" > "$out/stdout" 2> "$out/stderr" || echo "exit $?" >> "$out/stdout"
  done
  compared=$((compared + 1))
  diff -rq "$scratch/a" "$scratch/b" > "$scratch/differences" && return
  different=$((different + 1))
  echo "differs: $what"; sed 's/^/  /' "$scratch/differences"
}

while read -r line; do
  both "$line" '"$bin"/pmac-run '"$line"' --record "$out/record.csv"'
done < <(programs/command_lines.sh)
while read -r file; do
  both "pmacc $file" '"$bin"/pmacc -o "$out/module.pmx" '"$file"
done < <(find programs -name '*.pmc')

mkdir "$scratch/random"
"$random_programs" "$count" "$scratch/random"
cd "$scratch/random"
for seed in $(seq "$count"); do
  both "motion_$seed.pmc" '"$bin"/pmacc -o "$out/module.pmx" motion_'"$seed"'.pmc && "$bin"/pmac-run "$out/module.pmx" -e "&1 b1r" --record "$out/record.npz" --json'
  both "script_$seed.pmc" '"$bin"/pmacc -o "$out/module.pmx" script_'"$seed"'.pmc && "$bin"/pmac-run "$out/module.pmx" -e "&1 b1r" --max-instructions 200000 --trace --trace-limit 5000'
done
echo "$compared runs compared, $different different"
[ $different = 0 ]
