#!/usr/bin/env python3
"""What a cluster costs: the daemon with the executor `slurm` and a throw-away cluster of two nodes.

  bench_cluster.py study   [--jobs 200]    a study of small bodies here and on the cluster: the same
                                           numbers? wall time, and processor time of everything
  bench_cluster.py queue   [--jobs 10000]  so many jobs wait: processor time of daemon, its calls of
                                           Slurm's programs, and slurmctld, a minute
  bench_cluster.py light   [--jobs 10000]  so many light jobs: time, and bytes of the database
  bench_cluster.py submit                  sbatch of arrays of 1 to 10000 tasks

--out FILE keeps the figures as JSON. BIN: where the programs are (the current folder). Exit status
77 with a reason where no cluster can be started."""
import argparse
import ctypes
import json
import os
import subprocess
import sys
import tempfile
import time
import traceback

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../reliability"))
from reliability import Daemon, Workspace  # noqa: E402
from throwaway import Cluster  # noqa: E402

TICK = os.sysconf("SC_CLK_TCK")
PR_SET_CHILD_SUBREAPER = 36
ENDED = ("succeeded", "failed", "timed_out", "cancelled")


def spent(pid):
    """Processor seconds of a process, and of those of its children that it has waited for."""
    with open(f"/proc/{pid}/stat") as file:
        words = file.read().rsplit(")", 1)[1].split()
    own, below = int(words[11]) + int(words[12]), int(words[13]) + int(words[14])
    return own / TICK, below / TICK


def measured(work):
    """Runs work() in a process of its own, which waits for all that it starts, also for what
    detaches itself. Returns its answer, wall and processor seconds of all of it."""
    begin = time.monotonic()
    with tempfile.TemporaryFile("w+") as answer:
        child = os.fork()
        if child == 0:
            status = 1
            try:
                ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
                json.dump(work(), answer)
                answer.flush()
                while True:
                    os.wait()
            except ChildProcessError:
                status = 0
            except SystemExit as end:
                status = end.code
            except Exception:
                traceback.print_exc()
            finally:
                os._exit(status)
        _, status, usage = os.wait4(child, 0)
        if status != 0:
            sys.exit(os.waitstatus_to_exitcode(status))
        answer.seek(0)
        return json.load(answer), time.monotonic() - begin, usage.ru_utime + usage.ru_stime


def bodies(jobs):
    """Bodies of six chambers, one to three seconds of a core each."""
    return {"kind": "study", "name": f"{jobs} bodies", "sampling": "sobol", "size": jobs, "seed": 1,
            "timeout": "10 h",
            "base": {"kind": "response", "material": "dragon-skin-20", "accuracy": "standard",
                     "actuator": {"family": "pneunet", "length": "60 mm", "width": "20 mm", "height": "14 mm",
                                  "chambers": [{"config": "B", "count": 6}], "side_wall": "2 mm",
                                  "top_wall": "2 mm", "bottom_layer": "4 mm"},
                     "load": {"pressure": {"to": "20 kPa", "steps": 4}},
                     "contact": True, "error_estimate": False, "timeout": "10 min"},
            "parameters": [{"pointer": "/actuator/top_wall", "from": "1.5 mm", "to": "3 mm"},
                           {"pointer": "/actuator/side_wall", "from": "1.5 mm", "to": "3 mm"}]}


def light(jobs):
    """Simulations of a hybrid model, some milliseconds each."""
    return {"kind": "study", "name": f"{jobs} simulations", "sampling": "sobol", "size": jobs, "seed": 1,
            "timeout": "10 h",
            "base": {"kind": "hlpv", "end": "1 s", "sample_rate": "5 Hz", "initial": {"mode": "free"},
                     "model": {"mass": "60 g", "gamma": "5.577 N/psi",
                               "modes": {"free": {"stiffness": "2000 N/m", "damping": "15 N s/m",
                                                  "alpha": "-9 1/s", "beta": "9 1/s"}}},
                     "input": {"hold": [["0 s", "3 psi"]]}},
            "parameters": [{"pointer": "/model/mass", "from": "50 g", "to": "70 g"},
                           {"pointer": "/model/modes/free/damping", "from": "10 N s/m", "to": "20 N s/m"}]}


def wait_end(daemon, job, seconds=36000):
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        state = daemon.one("SELECT state FROM job WHERE id = ?", job)
        if state in ENDED:
            return state
        time.sleep(0.2)
    return "unfinished"


def numbers(daemon, study):
    """All metrics and samples of a study's members, to the last bit."""
    return daemon.sql("SELECT member, metric.name, printf('%!.17g', value) FROM metric JOIN job ON job.id = job_id "
                      "WHERE study_id = ?1 UNION ALL SELECT member, step || ' ' || sample.name, "
                      "printf('%!.17g', value) FROM sample JOIN job ON job.id = job_id "
                      "WHERE study_id = ?1 ORDER BY 1, 2", study)


def run_study(work, name, document, cluster, options, compared):
    """Submits a study and waits; the cluster, if any, is started and ended around it."""
    daemon = Daemon(os.path.join(work, name), *options)
    try:
        if cluster:
            cluster.up()
        daemon.start()
        answer, study = watch_study(daemon, document, cluster)
        if compared:
            answer["numbers"] = numbers(daemon, study)
        daemon.stop()
        answer["bytes"] = os.path.getsize(os.path.join(work, name, "pneulab.db"))
        return answer
    finally:
        if daemon.process and daemon.process.poll() is None:
            daemon.kill()
        if cluster:
            cluster.down()


def watch_study(daemon, document, cluster):
    begin = time.monotonic()
    _, study, _ = daemon.submit(document)
    state = wait_end(daemon, study)
    seconds = time.monotonic() - begin
    answer = {"state": state, "wall_s": seconds, "solver_cpu_s": daemon.one("SELECT sum(cpu_s) FROM attempt JOIN job ON job.id = job_id "
                                         "WHERE study_id = ?", study),
              "solved": daemon.one("SELECT count(*) FROM job WHERE study_id = ? AND state = 'succeeded'", study),
              "daemon_cpu_s": sum(spent(daemon.process.pid)) if cluster else spent(daemon.process.pid)[0]}
    if cluster:
        answer["slurm_cpu_s"] = sum(spent(cluster.pid(one))[0] for one in ("slurmctld", *cluster.names))
        answer["tasks"] = len(cluster.completed())
    return answer, study


def bench_study(work, jobs):
    cluster = Cluster(os.path.join(work, "cluster"), cpus=1)
    here, _, cpu_here = measured(lambda: run_study(work, "here", bodies(jobs), None, ["--workers", "2", "--worker-nice", "0"], True))
    there, _, cpu_there = measured(lambda: run_study(work, "there", bodies(jobs), cluster, ["--executor", "slurm"], True))
    same = here.pop("numbers") == there.pop("numbers")
    return {"jobs": jobs, "here": {**here, "cpu_s": cpu_here}, "there": {**there, "cpu_s": cpu_there},
            "same_numbers": same, "wall_overhead_pct": 100 * (there["wall_s"] / here["wall_s"] - 1),
            "cpu_overhead_pct": 100 * (cpu_there / cpu_here - 1)}


def bench_light(work, jobs):
    cluster = Cluster(os.path.join(work, "cluster"), cpus=1)
    there, _, cpu = measured(lambda: run_study(work, "there", light(jobs), cluster, ["--executor", "slurm"], False))
    return {"jobs": jobs, **there, "cpu_s": cpu, "jobs_a_second": jobs / there["wall_s"],
            "bytes_a_job": there["bytes"] / jobs}


def bench_queue(work, jobs):
    """All processors are taken by a job that does not end."""
    solver = os.path.join(work, "solver")
    with open(solver, "w") as file:
        file.write("#!/bin/sh\nexec sleep 3600\n")
    os.chmod(solver, 0o755)
    cluster = Cluster(os.path.join(work, "cluster"), cpus=1)
    cluster.up()
    daemon = Daemon(os.path.join(work, "data"), "--executor", "slurm", "--solver", solver)
    try:
        daemon.start()
        _, study, _ = daemon.submit(light(jobs))
        while daemon.one("SELECT count(*) FROM job WHERE study_id = ?", study) < jobs:
            time.sleep(1)
        time.sleep(60)  # what submitting costs is not asked for here
        ctld, pid = cluster.pid("slurmctld"), daemon.process.pid
        before = (*spent(pid), spent(ctld)[0])
        time.sleep(120)
        after = (*spent(pid), spent(ctld)[0])
        a_minute = [500 * (late - early) for early, late in zip(before, after)]
        return {"jobs": jobs, "in_slurm": len(cluster.tasks()),
                "waiting": daemon.one("SELECT count(*) FROM job WHERE study_id = ? AND finished_ms IS NULL", study),
                "daemon_ms_a_minute": a_minute[0], "its_calls_ms_a_minute": a_minute[1],
                "slurmctld_ms_a_minute": a_minute[2]}
    finally:
        daemon.kill()
        cluster.down(kill=True)


def used_by(command):
    """Processor milliseconds of a command, on average of ten calls."""
    before = os.times()
    for _ in range(10):
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = os.times()
    return 100 * (after.children_user + after.children_system - before.children_user - before.children_system)


def submit_held(tasks):
    subprocess.run(["sbatch", "--hold", f"--array=0-{tasks - 1}", "--wrap", "true", "-o", "/dev/null"],
                   check=True, stdout=subprocess.DEVNULL)


def cancel_all():
    subprocess.run(["scancel", "--user", str(os.getuid())], check=True)
    time.sleep(1)


def bench_submit(work, _):
    """Held arrays in an empty queue, ten times each. squeue: with a line an array, and with one a
    task, as if each ran."""
    cluster = Cluster(os.path.join(work, "cluster"), cpus=1)
    cluster.up()
    rows = []
    try:
        for tasks in (1, 10, 100, 1000, 10000):
            before, wall, repeats = spent(cluster.pid("slurmctld"))[0], [], 10 if tasks < 10000 else 2
            used = os.times()
            for _ in range(repeats):
                begin = time.monotonic()
                submit_held(tasks)
                wall.append(1000 * (time.monotonic() - begin))
            now = os.times()
            cpu = now.children_user + now.children_system - used.children_user - used.children_system
            ctld = spent(cluster.pid("slurmctld"))[0] - before
            cancel_all()
            submit_held(tasks)
            before = spent(cluster.pid("slurmctld"))[0]
            listed = [used_by(["squeue", "--noheader", "--me", *more]) for more in ([], ["--array"])]
            rows.append({"tasks": tasks, "sbatch_wall_ms": sorted(wall)[repeats // 2],
                         "sbatch_cpu_ms": 1000 * cpu / repeats, "slurmctld_ms": 1000 * ctld / repeats,
                         "squeue_ms": listed[0], "squeue_lines_ms": listed[1],
                         "squeue_slurmctld_ms": 50 * (spent(cluster.pid("slurmctld"))[0] - before)})
            cancel_all()
    finally:
        cluster.down(kill=True)
    return {"arrays": rows}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("study", "queue", "light", "submit"))
    parser.add_argument("--jobs", type=int, default=None)
    parser.add_argument("--out")
    arguments = parser.parse_args()
    run, jobs = {"study": (bench_study, 200), "queue": (bench_queue, 10000), "light": (bench_light, 10000),
                 "submit": (bench_submit, 0)}[arguments.what]
    with Workspace() as work:
        figures = {"program": f"bench_cluster {arguments.what}", **run(work, arguments.jobs or jobs)}
    text = json.dumps(figures, indent=1)
    print(text)
    if arguments.out:
        with open(arguments.out, "w") as file:
            file.write(text + "\n")
    if figures.get("same_numbers") is False:
        sys.exit("the numbers differ")


if __name__ == "__main__":
    main()
