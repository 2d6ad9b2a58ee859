"""Solves bundles and compares them with each other and with runs of their own."""
import json
import os
import shutil
import subprocess
import sys

SOLVE = sys.argv[1]
BASE = {
    "kind": "response",
    "actuator": {"family": "pneunet", "chamber_length": "8 mm", "width": "30 mm",
                 "height": "20 mm", "chambers": [{"config": "B", "count": 3}],
                 "chamber_gap": "1 mm", "side_wall": "2 mm", "gap_wall": "2 mm",
                 "top_wall": "1.5 mm", "bottom_layer": "6 mm"},
    "material": {"model": "yeoh", "C": ["0.25 MPa", "-0.05 MPa", "0.005 MPa"]},
    "load": {"pressure": {"to": "60 kPa", "steps": 2}},
    "accuracy": "draft", "error_estimate": False}
PATCH = {"kind": "verify", "case": "patch-test"}


def variant(**changes):
    job = json.loads(json.dumps(BASE))
    job["actuator"].update(changes)
    return job


def write(name, jobs, start=None, missing=()):
    shutil.rmtree(name, ignore_errors=True)
    folders = [f"{name}/{k}-1" for k in range(len(jobs))]
    for folder, job in zip(folders, jobs):
        if folder not in missing:
            os.makedirs(folder)
            with open(f"{folder}/job.json", "w", encoding="utf-8") as file:
                json.dump(job, file)
    bundle = {"members": folders}
    if start:
        bundle["from"] = start
    with open(f"{name}.json", "w", encoding="utf-8") as file:
        json.dump(bundle, file)


def run(name, expected=0):
    end = subprocess.run([SOLVE, "--bundle", f"{name}.json"], capture_output=True, check=False,
                         timeout=300)
    assert end.returncode == expected, (end.returncode, end.stderr)
    return [json.loads(line) for line in end.stdout.splitlines()]


def result(name, member):
    with open(f"{name}/{member}-1/result.json", encoding="utf-8") as file:
        return json.load(file)


def plain(document):
    """What must be the same to the last bit: all but times and memory."""
    statistics = {key: value for key, value in document.get("statistics", {}).items()
                  if not key.endswith("_s") and key not in ("peak_memory_MB", "analyses")}
    return json.dumps({**document, "statistics": statistics})


def files(name, member):
    folder = f"{name}/{member}-1/out"
    found = {}
    for entry in sorted(os.listdir(folder)):
        with open(f"{folder}/{entry}", "rb") as file:
            found[entry] = file.read()
    return found


JOBS = [variant(), variant(gap_wall="2.05 mm"), variant(gap_wall="2.05 mm", height="20.4 mm"),
        variant(gap_wall="2.03 mm", height="20.2 mm", bottom_layer="6.1 mm"),
        variant(chambers=[{"config": "B", "count": 2}]), variant(height="5 mm"), PATCH]
CODES = [0, 0, 0, 0, 0, 2, 0]
SOLVED = range(5)

write("a", JOBS)
write("b", JOBS)
lines = run("a")
run("b")
assert [line["event"] for line in lines] == ["begun", "done"] * len(JOBS), lines
assert [line["exit"] for line in lines[1::2]] == CODES, lines
assert all(line["cpu_s"] >= 0 and line["peak_memory_MB"] > 1 for line in lines[1::2])

# The same bytes twice, in results and files.
for k in range(len(JOBS)):
    assert plain(result("a", k)) == plain(result("b", k)), k
    assert files("a", k) == files("b", k), k

# Who starts warm, and with how much less work.
statistics = [result("a", k)["statistics"] for k in SOLVED]
assert [s["warm_start"] for s in statistics] == [False, True, True, True, False], statistics
assert all(s["factorizations"] < 0.7 * statistics[0]["factorizations"] for s in statistics[1:4])
assert statistics[1]["analyses"] <= 1, statistics

# Neighbours touch, and the pairs that do so are part of what is carried on. (The first has met
# others on its way.)
assert all(result("a", k)["metrics"]["contact_force_N"] > 1 for k in range(4))
assert [s["analyses"] for s in statistics[2:4]] == [0, 0], statistics

def assert_near(one, other):
    """What must be the same to the solver's tolerance, whatever a solve has started from."""
    assert one["metrics"].keys() == other["metrics"].keys()
    for name in ("bending_angle_deg", "tip_deflection_mm", "cavity_volume_mm3", "mass_g"):
        a, b = one["metrics"][name], other["metrics"][name]
        assert abs(a - b) < 1e-3 * abs(a), (name, a, b)


# The same answers as runs of their own.
for k in SOLVED:
    alone = json.loads(subprocess.run([SOLVE, f"a/{k}-1/job.json"], capture_output=True, check=True,
                                      timeout=300).stdout)
    together = result("a", k)
    assert_near(alone, together)
    if not statistics[k]["warm_start"]:
        assert alone["metrics"] == together["metrics"], k

# What a member that fails says.
assert result("a", 5)["status"] == "invalid" and result("a", 5)["error"]["message"], result("a", 5)

# No states are left behind; a bundle that ends in between leaves those of its last member, from
# which another one goes on: to the same bits where that is all there was.
assert not any(os.path.exists(f"a/{k}-1/path") for k in range(len(JOBS)))
write("c", JOBS[:2] + JOBS[:1], missing=("c/2-1",))
lines = run("c", expected=4)
assert lines[-1] == {"event": "begun", "member": 2}, lines
assert os.path.exists("c/1-1/path") and not os.path.exists("c/0-1/path")
write("d", JOBS[2:3], start="c/1-1/path")
run("d")
assert result("d", 0)["statistics"]["warm_start"]
assert_near(result("d", 0), result("a", 2))
write("g", JOBS[:2], missing=("g/1-1",))
run("g", expected=4)
write("h", JOBS[1:2], start="g/0-1/path")
run("h")
assert plain(result("h", 0)) == plain(result("a", 1))
assert files("h", 0) == files("a", 1)

# A job that wants few files has no fields of the volume, but all that tables and plots are made of.
write("f", [dict(JOBS[0], files="few")])
run("f")
few, many = result("f", 0), result("a", 0)
assert few["metrics"] == many["metrics"]
assert set(few["artifacts"]) == {"samples.csv", "midlines.csv", "surface.bin", "surface.json"}, few
assert set(few["artifacts"]) < set(many["artifacts"]), many
for name in few["artifacts"]:
    assert files("f", 0)[name] == files("a", 0)[name], name

# Without them it starts anew, and says so.
write("e", JOBS[2:3], start="nowhere/path")
run("e")
assert result("e", 0)["statistics"]["warm_start"] is False
