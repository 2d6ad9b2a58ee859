#!/usr/bin/env python3
"""A disk that fails or is full, once, for a while, and for real: answers are 507 or 503, reading
goes on, nothing acknowledged is lost, no job fails for it, and the service returns by itself.

Calls are made to fail by disk_faults.so; with --mount also a small file system is filled (as root,
or where a user may mount in a namespace of its own)."""
import argparse
import errno
import os
import subprocess
import sys
import threading
import time

from reliability import Daemon, Faults, Report, Workspace, curve, stub_solver

BACK_S = 5.0
# what, operations, errno, part of the path, status of a submission (None: not concerned)
CASES = [
    ("log cannot grow: ENOSPC", Faults.WRITE, errno.ENOSPC, "pneulab.db-wal", 507),
    ("log cannot be written: EIO", Faults.WRITE, errno.EIO, "pneulab.db-wal", 503),
    ("log cannot be made durable: EIO", Faults.SYNC, errno.EIO, "pneulab.db-wal", 503),
    ("read-only file system: EROFS", Faults.ALL, errno.EROFS, "/data/", 503),
    ("quota used up: EDQUOT", Faults.ALL, errno.EDQUOT, "/data/", 507),
    ("files of jobs: ENOSPC", Faults.ALL, errno.ENOSPC, "/attempts", None),
    ("files of jobs not durable: EIO", Faults.SYNC, errno.EIO, "/attempts", None),
    ("database not durable: EIO", Faults.SYNC, errno.EIO, "pneulab.db", 503),
    ("everything full: ENOSPC", Faults.ALL, errno.ENOSPC, "/data/", 507),
]


class Feeder:
    """Submits all the time and keeps what was acknowledged and what was answered."""

    def __init__(self, daemon):
        self.daemon, self.acknowledged, self.statuses, self.bad = daemon, set(), [], []
        self.going = True
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def run(self):
        while self.going:
            status, job, headers = self.daemon.submit(curve("steady"))
            self.statuses.append(status)
            if status == 202:
                self.acknowledged.add(job)
            elif status not in (503, 507) or not headers.get("Retry-After"):
                self.bad.append(status)
            time.sleep(0.15)

    def end(self):
        self.going = False
        self.thread.join()


def wait_for(what, seconds):
    """Seconds until what() holds, None when it takes longer."""
    begin = time.monotonic()
    while time.monotonic() - begin < seconds:
        if what():
            return time.monotonic() - begin
        time.sleep(0.02)
    return None


def reading_goes_on(daemon):
    return [daemon.try_status("GET", path) for path in
            ("/healthz", "/api/v1/jobs", "/api/v1/jobs/1", "/api/v1/jobs/1/result", "/metrics")]


def fault_for_a_while(report, daemon, feeder, faults, case, arguments):
    name, operations, code, part, expected = case
    before = len(feeder.statuses)
    faults.order(operations, code, part)
    seen = wait_for(lambda: expected is None or expected in feeder.statuses[before:], 10)
    time.sleep(arguments.seconds)
    readable = reading_goes_on(daemon)
    ready = daemon.try_status("GET", "/readyz")
    failed = faults.failed()
    faults.clear()
    back = wait_for(lambda: daemon.try_status("GET", "/readyz") == 200 and
                    daemon.submit(curve("afterwards"))[0] == 202, 2 * arguments.back + 20)
    statuses = sorted(set(feeder.statuses[before:]))
    report.promise(f"{name}: submissions answered {statuses}, {failed} calls failed",
                   seen is not None and failed > 0)
    report.promise(f"{name}: reading goes on", readable == [200] * 5, readable)
    if expected:
        report.promise(f"{name}: /readyz said so", ready == 503, ready)
    report.promise(f"{name}: back within {arguments.back:g} s",
                   back is not None and back <= arguments.back, f"{back or 99:.2f} s")


def fault_once(daemon, faults, count):
    """Each of the first `count` writing calls of a submission and its solution fails once."""
    for number in range(count):
        code = (errno.EIO, errno.ENOSPC)[number % 2]
        faults.order(Faults.ALL, code, "/data/", skip=number, count=1)
        status, job, _ = daemon.submit(curve("once"), wait=5)
        faults.clear()
        yield status, job


def shim(report, arguments):
    with Workspace() as work:
        faults = Faults(work)
        # The stub writes a file beside its result, which has to be made durable.
        daemon = Daemon(os.path.join(work, "data"), "--workers", "4", "--retry-delay", "0",
                        "--solver", stub_solver(work), environment=faults.environment())
        daemon.start()
        daemon.submit(curve("first"), wait=30)
        feeder = Feeder(daemon)
        for case in CASES[:: arguments.every]:
            fault_for_a_while(report, daemon, feeder, faults, case, arguments)
        feeder.end()
        wait_for(lambda: daemon.try_status("GET", "/readyz") == 200, 10)
        answers = []
        for status, job in fault_once(daemon, faults, arguments.once):
            answers.append(status)
            if status in (200, 202):
                feeder.acknowledged.add(job)
            wait_for(lambda: daemon.try_status("GET", "/readyz") == 200, 10)
        report.figure("single faults", len(answers))
        report.figure("of them answered 503 or 507", sum(s in (503, 507) for s in answers))
        report.promise("single faults: no other answers",
                       set(answers) <= {200, 202, 503, 507}, set(answers))
        report.promise("refusals are 503 or 507 with Retry-After", not feeder.bad, feeder.bad[:5] or "")
        report.promise("all jobs come to their end", daemon.wait_quiet())
        requeued = daemon.one("SELECT count(*) FROM attempt WHERE reason_code = 'disk_failed'")
        report.figure("attempts that did not count", requeued)
        failed = daemon.sql("SELECT state, reason_code, count(*) FROM job "
                            "WHERE state <> 'succeeded' GROUP BY 1, 2")
        report.promise("no job failed for the disk", not failed, failed or "")
        daemon.promise_sound(report, feeder.acknowledged)
        report.promise("it ends in order", daemon.stop() == 0)


def fill(path):
    """Takes all the room that there is."""
    with open(path, "wb", buffering=0) as file:
        for size in (1 << 20, 1 << 16, 1 << 12):
            try:
                while True:
                    file.write(bytes(size))
            except OSError as reason:
                if reason.errno != errno.ENOSPC:
                    raise


def full_disk(report, arguments, root, reserve):
    """`root` is on a small file system that may be filled."""
    daemon = Daemon(os.path.join(root, "data"), "--workers", "2", "--retry-delay", "0",
                    "--disk-reserve", str(reserve))
    ballast = os.path.join(root, "ballast")
    daemon.log = "/dev/null"
    what = f"full disk, {reserve} MiB kept" if reserve else "full disk, nothing kept"
    daemon.start()
    daemon.submit(curve("first"), wait=30)
    feeder = Feeder(daemon)
    for _ in range(arguments.fillings):
        fill(ballast)
        full = wait_for(lambda: feeder.statuses[-1:] == [507], 20)
        time.sleep(arguments.seconds)
        readable = reading_goes_on(daemon)
        ready = daemon.try_status("GET", "/readyz")
        os.remove(ballast)
        back = wait_for(lambda: daemon.try_status("GET", "/readyz") == 200 and
                        daemon.submit(curve("afterwards"))[0] == 202, 2 * arguments.back + 20)
        report.promise(f"{what}: submissions answer 507", full is not None)
        report.promise(f"{what}: reading goes on", readable == [200] * 5, readable)
        report.promise(f"{what}: /readyz said so", ready == 503, ready)
        report.promise(f"{what}: back within {arguments.back:g} s",
                       back is not None and back <= arguments.back, f"{back or 99:.2f} s")
    feeder.end()
    report.promise("refusals are 503 or 507 with Retry-After", not feeder.bad, feeder.bad[:5] or "")
    report.promise("all jobs come to their end", daemon.wait_quiet())
    failed = daemon.sql("SELECT state, reason_code, count(*) FROM job "
                        "WHERE state <> 'succeeded' GROUP BY 1, 2")
    report.promise("no job failed for the disk", not failed, failed or "")
    daemon.promise_sound(report, feeder.acknowledged)
    report.promise("it ends in order", daemon.stop() == 0)


def mounted(report, arguments):
    """In a mount namespace: a small ext4 on a loop device if possible, else a tmpfs."""
    with Workspace() as work:
        image, root = os.path.join(work, "image"), os.path.join(work, "disk")
        os.mkdir(root)
        loop = (f"truncate -s 40M {image} && mkfs.ext4 -q {image} && mount -o loop {image} {root}")
        if subprocess.run(["sh", "-c", loop], capture_output=True).returncode == 0:
            kind = "ext4 of 40 MiB"
        elif subprocess.run(["mount", "-t", "tmpfs", "-o", "size=24m", "tmpfs", root],
                            capture_output=True).returncode == 0:
            kind = "tmpfs of 24 MiB"
        else:
            print("SKIPPED: nothing can be mounted here", flush=True)
            return
        report.figure("file system", kind)
        try:
            for reserve in (0, 8):
                full_disk(report, arguments, root, reserve)
                subprocess.run(["sh", "-c", f"rm -rf {root}/data"], check=True)
        finally:
            subprocess.run(["umount", root], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=3, help="that a fault lasts")
    parser.add_argument("--once", type=int, default=120, help="calls that fail once, one by one")
    parser.add_argument("--every", type=int, default=1, help="take each N-th kind of fault only")
    parser.add_argument("--fillings", type=int, default=3)
    parser.add_argument("--back", type=float, default=BACK_S, help="seconds to be back within")
    parser.add_argument("--no-mount", action="store_true")
    parser.add_argument("--mounted", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if not arguments.mounted:
        report = Report("a disk that fails")
        shim(report, arguments)
        if not arguments.no_mount:
            own = [] if os.geteuid() == 0 else ["--user", "--map-root-user"]
            command = ["unshare", "--mount", *own, sys.executable, __file__, *sys.argv[1:]]
            if subprocess.run(["unshare", "--mount", *own, "true"],
                              capture_output=True).returncode != 0:
                print("SKIPPED: nothing can be mounted here", flush=True)
            elif subprocess.run([*command, "--mounted"]).returncode != 0:
                report.broken.append("a small file system that is full")
    else:
        report = Report("a small file system that is full")
        mounted(report, arguments)
    report.end()


if __name__ == "__main__":
    main()
