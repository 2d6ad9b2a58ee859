#!/usr/bin/env python3
"""Many submissions with one Idempotency-Key at the same time make one job; another document under
the same key is refused, and so after a crash."""
import argparse
import os
import threading

from reliability import Daemon, Report, Workspace, curve


def submit_together(daemon, documents, key):
    """Submits all at one moment; the answers (status, id)."""
    answers = [None] * len(documents)
    barrier = threading.Barrier(len(documents))

    def run(number):
        daemon.request("GET", "/healthz")  # connected before the start
        barrier.wait()
        try:
            answers[number] = daemon.submit(documents[number], key)[:2]
        except OSError as reason:
            answers[number] = (reason, None)

    threads = [threading.Thread(target=run, args=(number,)) for number in range(len(documents))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return answers


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--clients", type=int, default=200)
    parser.add_argument("--keys", type=int, default=5)
    arguments = parser.parse_args()
    report = Report(f"{arguments.clients} submissions with one Idempotency-Key at the same time")
    clients = arguments.clients
    with Workspace() as work:
        daemon = Daemon(os.path.join(work, "data"), "--workers", "1")
        daemon.start()
        jobs = set()
        for number in range(arguments.keys):
            answers = submit_together(daemon, [curve("one")] * clients, f"key {number}")
            ids = {job for _, job in answers}
            jobs |= ids
            report.promise(f"key {number}: all are accepted with the same id",
                           all(status == 202 for status, _ in answers) and len(ids) == 1,
                           ids if len(ids) < 4 else f"{len(ids)} ids")
        report.promise("one job a key is stored",
                       daemon.one("SELECT count(*) FROM job") == arguments.keys)
        answers = submit_together(daemon, [curve("one"), curve("two")] * (clients // 2), "mixed")
        accepted = {job for status, job in answers if status == 202}
        refused = [status for status, _ in answers if status != 202]
        report.figure("of two documents under one key: accepted", len(answers) - len(refused))
        report.figure("refused", len(refused))
        report.promise("one document wins, the other is refused with 422",
                       len(accepted) == 1 and refused == [422] * (clients // 2))
        jobs |= accepted
        daemon.kill()
        daemon.start()
        status, job, _ = daemon.submit(curve("one"), "key 0")
        report.promise("after a crash the key still names its job", status == 202 and job == min(jobs))
        status, job, _ = daemon.submit(curve("two"), "key 0")
        report.promise("after a crash another document is refused", status == 422)
        report.promise("all jobs come to their end", daemon.wait_quiet())
        daemon.promise_sound(report, jobs)
        report.promise("it ends in order", daemon.stop() == 0)
    report.end()


if __name__ == "__main__":
    main()
