#!/usr/bin/env python3
"""Kills workers at random moments: noticed within two seconds, and one result a job."""
import argparse
import os
import random
import signal
import time

from reliability import Daemon, Report, Workspace, curve, stub_solver

NOTICED_S = 2.0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--workers", type=int, default=4)
    parser.add_argument("--noticed", type=float, default=NOTICED_S, help="seconds to notice it in")
    arguments = parser.parse_args()
    report = Report(f"kill -9 of {arguments.kills} workers")
    with Workspace() as work:
        daemon = Daemon(os.path.join(work, "data"), "--workers", str(arguments.workers),
                        "--retry-delay", "0", "--solver", stub_solver(work))
        daemon.start()
        # A job that loses three workers fails, so none is killed more than twice.
        jobs = [daemon.submit(curve(f"job {n}"))[1] for n in range(arguments.kills * 2 // 3 + 4)]
        killed, of_job = {}, {}
        until = time.monotonic() + 30 + 5 * arguments.kills
        while len(killed) < arguments.kills and time.monotonic() < until:
            rows = daemon.sql("SELECT job_id, number, pid FROM attempt WHERE outcome = '' "
                              "AND pid IS NOT NULL")
            rows = [row for row in rows if row[:2] not in killed and of_job.get(row[0], 0) < 2]
            if rows:
                job, number, pid = random.choice(rows)
                time.sleep(random.random() * 0.1)
                try:
                    os.kill(pid, signal.SIGKILL)
                except ProcessLookupError:
                    continue
                killed[job, number] = time.time()
                of_job[job] = of_job.get(job, 0) + 1
            elif not daemon.one("SELECT count(*) FROM job WHERE state IN ('queued', 'retry_wait', "
                                "'starting', 'running')"):
                jobs.append(daemon.submit(curve("another"))[1])
            time.sleep(0.01)
        report.promise("all jobs come to their end", daemon.wait_quiet())
        ends = {(job, number): (outcome, finished)
                for job, number, outcome, finished in daemon.sql(
                    "SELECT job_id, number, outcome, finished_ms / 1000.0 FROM attempt")}
        # One that had printed its result before it was killed has ended by itself.
        lost = [key for key in killed if ends[key][0] == "worker_lost"]
        delays = sorted(max(0.0, ends[key][1] - killed[key]) for key in lost)
        report.figure("workers killed", len(killed))
        report.figure("of them at work", len(lost))
        report.figure("noticed and stored, median", delays[len(delays) // 2], "s")
        report.figure("noticed and stored, longest", delays[-1], "s")
        report.promise("enough of them were at work", len(lost) >= arguments.kills // 2, len(lost))
        report.promise(f"each was noticed within {arguments.noticed:g} s", delays[-1] <= arguments.noticed,
                       f"{delays[-1]:.3f} s")
        failed = daemon.one("SELECT count(*) FROM job WHERE state <> 'succeeded'")
        report.promise("every job succeeded in the end", failed == 0, f"{failed} did not")
        daemon.promise_sound(report, set(jobs))
        report.promise("it ends in order", daemon.stop() == 0)
    report.end()


if __name__ == "__main__":
    main()
