#!/bin/sh
# One design, one mesh, one core: pneulab-solve against CalculiX on the exported deck, in one run.
# Needs ccx (Debian: calculix-ccx); says so and succeeds without it.
set -eu
command -v ccx >/dev/null || { echo "ccx is not installed: no comparison with CalculiX"; exit 0; }
solve=$(pwd)/pneulab-solve
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
cat >job.json <<'JOB'
{ "kind": "response", "name": "three chambers",
  "actuator": { "family": "pneunet", "chamber_length": "8 mm", "width": "30 mm",
    "height": "20 mm", "chambers": [{ "config": "B", "count": 3 }], "chamber_gap": "2 mm",
    "side_wall": "2 mm", "gap_wall": "2 mm", "top_wall": "1.5 mm", "bottom_layer": "6 mm" },
  "material": { "model": "yeoh", "C": ["0.25 MPa", "-0.05 MPa", "0.005 MPa"],
    "density": "1080 kg/m3", "bulk_ratio": 1000 },
  "load": { "pressure": { "to": "20 kPa", "steps": 10 } }, "contact": false,
  "accuracy": "fine" }
JOB
seconds() { date +%s.%N; }
"$solve" --deck deck.inp job.json
# Ten increments for ten recorded pressures.
sed -i 's/^0.02, 1., 1e-6, 0.02/0.1, 1., 1e-6, 0.1/' deck.inp
a=$(seconds)
"$solve" job.json >result.json
b=$(seconds)
OMP_NUM_THREADS=1 ccx deck >ccx.log 2>&1
c=$(seconds)
unknowns=$(sed -n 's/.*"unknowns": *\([0-9]*\).*/\1/p' result.json)
awk -v a="$a" -v b="$b" -v c="$c" -v n="$unknowns" 'BEGIN {
  printf "3 chambers, %d unknowns, ten load steps: %.2f s; CalculiX (C3D20R, same mesh) %.1f s: %.0f times\n",
    n, b - a, c - b, (c - b) / (b - a) }'
