#!/usr/bin/env python3
"""Kills the daemon at random moments under load: while it starts, accepts, solves, stores and
copies its database. Nothing acknowledged may be lost, nothing may count twice, and it must be ready
again within two seconds each time."""
import argparse
import http.client
import os
import random
import threading
import time

from reliability import Daemon, Report, Workspace, curve

READY_S = 2.0


def client(daemon, number, acknowledged, going, pace_s):
    """Submits, reads and copies until the daemon is gone."""
    count = 0
    while going.is_set():
        count += 1
        try:
            if number == 0 and count % 3 == 0:
                daemon.request("GET", "/api/v1/database")
            elif count % 4 == 0:
                daemon.request("GET", "/api/v1/jobs?limit=20&sort=-id")
            else:
                status, job, _ = daemon.submit(curve(f"{number}-{count}", labels={"user": str(number)}))
                if status == 202:
                    acknowledged.append(job)
        except (OSError, http.client.HTTPException, ValueError):
            return
        time.sleep(random.random() * pace_s)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=500)
    parser.add_argument("--clients", type=int, default=3)
    parser.add_argument("--pace", type=float, default=0.08, help="most seconds between requests")
    parser.add_argument("--ready", type=float, default=READY_S, help="seconds to be ready within")
    parser.add_argument("--seed", type=int, default=None)
    arguments = parser.parse_args()
    seed = arguments.seed if arguments.seed is not None else random.randrange(1 << 30)
    random.seed(seed)
    report = Report(f"kill -9 of the daemon at {arguments.rounds} random moments (seed {seed})")
    acknowledged, ready, early = [], [], 0
    with Workspace() as work:
        daemon = Daemon(os.path.join(work, "data"), "--workers", "2", "--retry-delay", "0")
        for _ in range(arguments.rounds):
            if random.random() < 0.15:
                daemon.start(wait=False)  # killed while it starts or recovers
                time.sleep(random.random() * 0.1)
                daemon.kill()
                early += 1
                continue
            ready.append(daemon.start())
            going = threading.Event()
            going.set()
            clients = [threading.Thread(target=client, args=(daemon, number, acknowledged, going,
                                                             arguments.pace))
                       for number in range(arguments.clients)]
            for thread in clients:
                thread.start()
            time.sleep(random.random() * 0.5)
            daemon.kill()
            going.clear()
            for thread in clients:
                thread.join()
        ready.append(daemon.start())
        report.promise("all jobs come to their end", daemon.wait_quiet())
        ready.sort()
        report.figure("kills", arguments.rounds)
        report.figure("of them while it started", early)
        report.figure("jobs acknowledged", len(acknowledged))
        report.figure("jobs stored", daemon.one("SELECT count(*) FROM job"))
        report.figure("attempts lost with the daemon",
                      daemon.one("SELECT count(*) FROM attempt WHERE outcome = 'lost'"))
        report.figure("ready again, median", ready[len(ready) // 2], "s")
        report.figure("ready again, longest", ready[-1], "s")
        report.promise("acknowledged ids are all different",
                       len(acknowledged) == len(set(acknowledged)))
        daemon.promise_sound(report, set(acknowledged))
        failed = daemon.sql("SELECT state, reason_code, count(*) FROM job "
                            "WHERE state <> 'succeeded' GROUP BY 1, 2")
        report.promise("every job succeeded", not failed, failed or "")
        report.promise(f"ready again within {arguments.ready:g} s each time",
                       ready[-1] <= arguments.ready, f"{ready[-1]:.3f} s")
        report.promise("it ends in order", daemon.stop() == 0)
    report.end()


if __name__ == "__main__":
    main()
