#!/usr/bin/env python3
"""Studies on a throw-away Slurm cluster, and kills at random moments: of a task, of a node with all
that runs on it, of slurmctld, and of the daemon. Every job must have exactly one result, none may be
submitted twice, and all must be over within the time of one lost attempt and a minute. A task that
runs must end within two seconds of its cancelling."""
import argparse
import os
import random
import signal
import sys
import time

from reliability import Daemon, Report, Workspace, curve

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../cluster"))
from throwaway import Cluster  # noqa: E402

KINDS = ("task", "node", "slurmctld", "pneulabd")
# How soon the cluster misses a node; slurm.conf(5).
SHORT = "SlurmdTimeout=6\nMessageTimeout=4\nBatchStartTimeout=2"
CANCEL_S = 2.0
MORE_S = 60.0

# Stands in for pneulab-solve: writes down which attempt it begins, works SECONDS, prints a result.
STUB = """#!/bin/bash
while [ $# -gt 1 ]; do
  case $1 in
    --out) out=$2; shift 2 ;;
    --bundle) bundle=$2; shift ;;
    *) shift 2 ;;
  esac
done
one() {
  echo "${1##*/}" >> WORK/started
  sleep SECONDS
  echo '{}' > "$1/out/surface.json"
  echo '{"status":"succeeded","metrics":{"mass_g":3.5},"samples":[],"artifacts":["surface.json"]}'
}
if [ -z "$bundle" ]; then
  one "${out%/out}"
  exit
fi
member=0
while read -r folder; do
  echo "{\\"event\\":\\"begun\\",\\"member\\":$member}"
  one "$folder" > "$folder/result.part"
  mv "$folder/result.part" "$folder/result.json"
  echo "{\\"event\\":\\"done\\",\\"member\\":$member,\\"exit\\":0,\\"cpu_s\\":0.01,\\"peak_memory_MB\\":7}"
  member=$((member + 1))
done < <(grep -o '"/[^"]*/attempts/[^"]*"' "$bundle" | tr -d '"')
"""


def study(name, jobs):
    """A hundred bodies of four chambers; solved by the stand-in."""
    return {"kind": "study", "name": name, "sampling": "one-at-a-time" if jobs == 1 else "sobol",
            "size": jobs, "seed": 1,
            "base": {"kind": "response", "timeout": "5 min", "material": "dragon-skin-20",
                     "actuator": {"family": "pneunet", "length": "24 mm", "width": "20 mm",
                                  "height": "14 mm", "chambers": [{"config": "B", "count": 2}],
                                  "side_wall": "2 mm", "top_wall": "2 mm", "bottom_layer": "4 mm"},
                     "load": {"pressure": {"to": "4 kPa", "steps": 1}},
                     "contact": False, "error_estimate": False},
            "parameters": [{"pointer": "/actuator/top_wall", "from": "2 mm", "to": "3 mm"},
                           {"pointer": "/actuator/side_wall", "from": "2 mm", "to": "3 mm"}]}


class Trial:
    """A daemon, its cluster and the stand-in."""

    def __init__(self, work, arguments):
        self.work, self.arguments = work, arguments
        self.cluster = Cluster(os.path.join(work, "cluster"), lines=SHORT)
        self.cluster.up()
        solver = os.path.join(work, "solver")
        with open(solver, "w") as file:
            file.write(STUB.replace("WORK", work).replace("SECONDS", f"{arguments.seconds:g}"))
        os.chmod(solver, 0o755)
        self.started = os.path.join(work, "started")
        open(self.started, "w").close()
        self.daemon = Daemon(os.path.join(work, "data"), "--executor", "slurm", "--solver", solver,
                             "--worker-write", work, "--retry-delay", "0")
        self.kills, self.drained = dict.fromkeys(KINDS, 0), 0

    def solvers(self, scripts=False):
        """Processes of the stand-in that work; with scripts also those of Slurm's that start it."""
        found, solver = [], os.path.join(self.work, "solver").encode()
        for entry in os.listdir("/proc"):
            if entry.isdigit():
                try:
                    with open(f"/proc/{entry}/cmdline", "rb") as file:
                        words = file.read().split(b"\0")
                except OSError:
                    continue
                script = scripts and any(word.endswith(b"/slurm_script") for word in words[:2])
                if solver in (words if script else words[:2]):
                    found.append(int(entry))
        return found

    def kill(self, kind):
        """Returns what follows and after how many seconds: what brings the victim back, or the same
        once more when there is nothing to kill yet."""
        if kind == "task":
            running = self.solvers(scripts=True)
            if not running:
                return 0.1, kind
            os.kill(random.choice(running), signal.SIGKILL)
        elif kind == "node":
            name = random.choice(self.cluster.names)
            self.cluster.down(name, kill=True)
            after = random.uniform(0, 15), lambda: self.cluster.up(name)
        elif kind == "slurmctld":
            self.cluster.down(kind, kill=True)
            after = random.uniform(0, 5), lambda: self.cluster.up(kind)
        else:
            self.daemon.kill()
            after = random.uniform(0, 3), self.daemon.start
        self.kills[kind] += 1
        return None if kind == "task" else after

    def run(self, name, faults):
        """A study with kills: (seconds, its id, its state). Nodes that Slurm drains, since they run
        tasks which a killed slurmctld had not noted yet, are put back as by an administrator."""
        _, number, _ = self.daemon.submit(study(name, self.arguments.jobs))
        begin = time.monotonic()
        resume_at = begin
        events = [(begin + moment, kind) for moment, kind in faults]
        while True:
            now = time.monotonic()
            for event in [event for event in events if event[0] <= now]:
                events.remove(event)
                after = self.kill(event[1]) if event[1] in KINDS else event[1]()
                if isinstance(after, tuple):
                    events.append((time.monotonic() + after[0], after[1]))
            if self.arguments.resume and now > resume_at:
                self.drained, resume_at = self.drained + self.cluster.resume(), now + 2
            state = self.daemon.one("SELECT state FROM job WHERE id = ?", number)
            if state in ("succeeded", "failed", "timed_out", "cancelled"):
                events = [event for event in events if event[1] not in KINDS]
                if not events:
                    return time.monotonic() - begin, number, state
            if now - begin > 600:
                return float("inf"), number, state
            time.sleep(0.1)

    def cancelled_after(self):
        """Seconds from the order to cancel a running job until its process has ended."""
        _, job, _ = self.daemon.submit(curve("to be cancelled", timeout="5 min"))
        until = time.monotonic() + 60
        while not self.solvers() and time.monotonic() < until:
            time.sleep(0.02)
        time.sleep(random.random() * self.arguments.seconds / 2)
        begin = time.monotonic()
        self.daemon.request("POST", f"/api/v1/jobs/{job}/cancel")
        while self.solvers() and time.monotonic() < begin + 60:
            time.sleep(0.02)
        ended = time.monotonic() - begin
        while self.daemon.one("SELECT state FROM job WHERE id = ?", job) != "cancelled":
            if time.monotonic() > begin + 60:
                return float("inf"), ended
            time.sleep(0.02)
        return ended, time.monotonic() - begin


def promise_once(trial, report):
    """Of all attempts: none was started twice, and Slurm knows no name twice."""
    with open(trial.started) as lines:
        started = [line.strip() for line in lines]
    twice = {name for name in started if started.count(name) > 1}
    report.promise("no attempt was started twice", not twice, sorted(twice)[:5] or "")
    left = trial.cluster.tasks()
    report.promise("nothing is left in Slurm", not left, left[:3] or "")
    report.figure("attempts started", len(started))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=20)
    parser.add_argument("--jobs", type=int, default=100)
    parser.add_argument("--seconds", type=float, default=0.5, help="that a job works")
    parser.add_argument("--cancels", type=int, default=10)
    parser.add_argument("--cancel", type=float, default=CANCEL_S, help="seconds that it may take")
    parser.add_argument("--more", type=float, default=MORE_S, help="seconds that kills may cost")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    parser.add_argument("--no-resume", dest="resume", action="store_false",
                        help="leave nodes drained that Slurm has drained")
    parser.add_argument("--seed", type=int, default=None)
    arguments = parser.parse_args()
    seed = arguments.seed if arguments.seed is not None else random.randrange(1 << 30)
    random.seed(seed)
    report = Report(f"{arguments.repeats} studies on a cluster with kills (seed {seed})")
    with Workspace() as work:
        trial = Trial(work, arguments)
        try:
            measure(trial, arguments, report)
        finally:
            if trial.daemon.process and trial.daemon.process.poll() is None:
                trial.daemon.kill()
            trial.cluster.down(kill=True)
    report.end()


def measure(trial, arguments, report):
    daemon = trial.daemon
    daemon.start()
    calm, _, state = trial.run("calm", [])
    report.figure("a study without kills", calm, "s")
    report.promise("it succeeds", state == "succeeded", state)
    times, studies = [], []
    for repeat in range(arguments.repeats):
        faults = [(random.uniform(0, calm), kind) for kind in arguments.kinds]
        seconds, number, state = trial.run(f"repeat {repeat}", faults)
        order = ", ".join(f"{kind} {moment:.1f}" for moment, kind in sorted(faults))
        print(f"  {repeat}: {seconds:.1f} s, {state}; {order}", flush=True)
        times.append(seconds)
        studies.append((number, state))
    if times:
        times.sort()
        report.figure("studies with kills, median", times[len(times) // 2], "s")
        report.figure("studies with kills, longest", times[-1], "s")
        report.promise(f"over within the time of one lost attempt and {arguments.more:g} s",
                       times[-1] <= calm + arguments.seconds + arguments.more, f"{times[-1] - calm:.1f} s")
    for kind, count in trial.kills.items():
        report.figure(f"kills: {kind}", count)
    report.figure("nodes put back that Slurm had drained", trial.drained)
    report.promise("every study succeeded", all(state == "succeeded" for _, state in studies),
                   [entry for entry in studies if entry[1] != "succeeded"] or "")
    short = daemon.sql("SELECT study_id, count(*) FROM job JOIN result ON result.job_id = job.id "
                       "WHERE study_id IS NOT NULL GROUP BY 1 HAVING count(*) <> ?", arguments.jobs)
    report.promise("every job has exactly one result", not short, short[:5] or "")
    report.figure("attempts beyond the first",
                  daemon.one("SELECT count(*) FROM attempt WHERE number > 1"))
    promise_once(trial, report)
    daemon.promise_sound(report, {number for number, _ in studies})
    if arguments.cancels:
        ends = [trial.cancelled_after() for _ in range(arguments.cancels)]
        report.figure("cancelled: process ended, longest", max(end[0] for end in ends), "s")
        report.figure("cancelled: known to the daemon, longest", max(end[1] for end in ends), "s")
        report.promise(f"cancelling reaches a running task within {arguments.cancel:g} s",
                       max(end[0] for end in ends) <= arguments.cancel)
    report.promise("it ends in order", daemon.stop() == 0)


if __name__ == "__main__":
    main()
