#!/bin/sh
# The files of a run, read back: VTU, PVD and CSV against the result document and each other,
# and the deck by CalculiX, for every material law and for every job that comes along.
set -eu
command -v python3 >/dev/null || exit 77
solve=$(pwd)/pneulab-solve
source=$(cd "${srcdir:-.}" && pwd)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"

# job MATERIAL PRESSURE [GRAVITY]: three chambers that touch at the end of the second step.
job() {
  cat <<JOB
{ "kind": "response", "name": "files\nof a run",
  "actuator": { "family": "pneunet", "chamber_length": "8 mm", "width": "30 mm",
    "height": "20 mm", "chambers": [{ "config": "B", "count": 3 }], "chamber_gap": "1 mm",
    "side_wall": "2 mm", "gap_wall": "2 mm", "top_wall": "1.5 mm", "bottom_layer": "6 mm" },
  "material": $1,
  "load": { "pressure": { "to": "$2", "steps": 2 }, "gravity": [0, 0, ${3:-0}] },
  "accuracy": "fast" }
JOB
}

yeoh='{ "model": "yeoh", "C": ["0.25 MPa", "-0.05 MPa", "0.005 MPa"], "density": "1080 kg/m3" }'
job "$yeoh" "20 kPa" >job.json
"$solve" --out out job.json >result.json
python3 "$source/tests/physics/check_files.py" result.json out
# A second run replaces the files.
"$solve" --out out job.json >again.json
python3 "$source/tests/physics/check_files.py" again.json out

# Where nothing can be written the solver says so and gives no result.
status=0
"$solve" --out job.json job.json >refused.json 2>/dev/null || status=$?
[ "$status" = 4 ] && grep -q io_error refused.json

command -v ccx >/dev/null || { echo "ccx is not installed: the decks were not run"; exit 0; }

# run_deck FILE: CalculiX solves the deck as it is, in a single increment of a small load.
run_deck() {
  sed 's/^0.02, 1., 1e-6, 0.02/1., 1., 1e-6, 1./' "$1" >deck.inp
  rm -f deck.dat
  OMP_NUM_THREADS=1 ccx deck >ccx.log 2>&1 || { tail ccx.log >&2; return 1; }
  ! grep -E '\*(ERROR|WARNING)' ccx.log || return 1
  awk 'NF == 4 { z = $4 } END { exit !(z < 0) }' deck.dat
}

for material in "$yeoh" '{ "model": "neo-hooke", "mu": "0.4 MPa" }' \
  '{ "model": "mooney-rivlin", "C10": "0.2 MPa", "C01": "0.02 MPa" }' \
  '{ "model": "ogden", "mu": ["0.63 MPa", "0.0012 MPa", "-0.01 MPa"], "alpha": [1.3, 5, -2] }'; do
  job "$material" "0.5 kPa" '"-9.80665 m/s2"' | sed 's/"density"/"bulk_ratio": 20, "density"/' >deck.json
  "$solve" --deck full.inp deck.json
  run_deck full.inp
done
for file in "$source"/jobs/*/*.json; do
  # The body, mesh and sets of the job, at a thousandth of its pressure.
  python3 - "$file" >deck.json <<'PYTHON'
import json, sys
job = json.load(open(sys.argv[1]))
if job["kind"] != "response":
    sys.exit()
job["load"] = {"pressure": {"to": "0.05 kPa", "steps": 1}}
job["accuracy"] = "fast"
job.pop("mesh", None)
job.pop("metrics", None)
job.pop("measured", None)
json.dump(job, sys.stdout)
PYTHON
  [ -s deck.json ] || continue
  "$solve" --deck full.inp deck.json
  run_deck full.inp
  echo "${file##*/}: CalculiX runs its deck"
done
