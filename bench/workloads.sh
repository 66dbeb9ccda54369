#!/usr/bin/env bash
# workloads.sh FOLDER BIN: writes the fixed pieces of work that the guard counts and that train a PGO build, and prints a line for each:
# its name, then the command, which runs in FOLDER with the tools of BIN.
set -euo pipefail
folder=$1 bin=$(realpath "$2")
cd "$folder"

# 20,000 plain moves on a spiral of coarse numbers, as a CAM system writes them
awk 'BEGIN { print "&1\n#1->1000X\n#2->1000Y\nopen prog 1\nlinear abs ta5 ts0 F50"
             for (i = 0; i < 20000; ++i) printf "X%.3f Y%.3f\n", (i * 37 % 1000) / 8, (i * 91 % 1000) / 16
             print "close" }' > lines.pmc

# 60 s of short lines and arcs under lookahead, output off; the same is recorded
cat > contour.pmc <<'TEXT'
&1
#1->1000X
#2->1000Y
Motor[1].MaxSpeed=300
Motor[2].MaxSpeed=300
Motor[1].InvAmax=2
Motor[2].InvAmax=2
Motor[1].InvDmax=2
Motor[2].InvDmax=2
Coord[1].SegMoveTime=5
&1 define lookahead 2000
Coord[1].LHDistance=200
open prog 1
linear abs ta20 ts0 F100
while (1)
{
linear X10 Y0
circle1 X20 Y10 I0 J10
linear X20 Y30
linear X0 Y30
circle2 X0 Y0 R15
}
close
TEXT

# four assignments and a test on locals, without yielding
cat > loop.pmc <<'TEXT'
open prog 1
local a, b, c, i;
Coord[1].GoBack = 1000000
a = 1; b = 2; c = 0; i = 0;
while (i < 500000)
{
c = a + b;
a = b - c * 0.5;
b = c + 1;
i = i + 1;
}
P1 = c
close
TEXT

"$bin"/pmacc -o contour.pmx contour.pmc
"$bin"/pmacc -o loop.pmx loop.pmc
echo "compile $bin/pmacc -o lines.pmx lines.pmc"
echo "contour $bin/pmac-run contour.pmx -q -e &1b1r --until 60"
echo "loop $bin/pmac-run loop.pmx -q -e &1b1r"
echo "record $bin/pmac-run contour.pmx -q -e &1b1r --until 20 --record record.csv"
