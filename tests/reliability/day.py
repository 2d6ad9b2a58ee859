#!/usr/bin/env python3
"""24 simulated hours of mixed traffic, compressed to 20 minutes: submissions, lists, plots, cancels,
deletes, events, copies of the database, workers that are killed, bad requests. Memory, descriptors,
threads and latency must not grow: their medians over the last third are compared with those over
the second third (the first one warms up)."""
import argparse
import http.client
import json
import os
import random
import signal
import socket
import statistics
import threading
import time

from reliability import Daemon, Report, Workspace, curve

KEPT_JOBS = 300  # older ones are deleted, so that the day has no more to look after at its end
BAD = [
    b"GET /api/v1/jobs?limit=x HTTP/1.1\r\nHost: localhost\r\n\r\n",
    b"GET /%2e%2e/etc/passwd HTTP/1.1\r\nHost: localhost\r\n\r\n",
    b"POST /api/v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\n{\"a\":",
    b"POST /api/v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n"
    b"Transfer-Encoding: chunked\r\n\r\n{}",
    b"\x00\x01\x02\x03\r\n\r\n",
    b"GET / HTTP/1.1\r\n",
    b"DELETE /api/v1/jobs/999999999 HTTP/1.1\r\nHost: localhost\r\n\r\n",
    b"POST /api/v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2000000\r\n\r\n",
]


class Traffic:
    """Threads that each do one kind of thing, at a pace per second of real time."""

    def __init__(self, daemon):
        self.daemon, self.going, self.counts, self.faults = daemon, True, {}, []
        self.jobs, self.lock, self.threads, self.number = [], threading.Lock(), [], 0

    def run(self, name, pace_hz, act):
        def loop():
            while self.going:
                time.sleep(random.expovariate(pace_hz))
                try:
                    act()
                    self.counts[name] = self.counts.get(name, 0) + 1
                except (OSError, http.client.HTTPException, ValueError) as reason:
                    self.faults.append(f"{name}: {reason!r}")

        thread = threading.Thread(target=loop, name=name)
        self.threads.append(thread)
        thread.start()

    def end(self):
        self.going = False
        for thread in self.threads:
            thread.join()

    def get(self, path, allowed=(200, 304, 404, 409, 410)):
        status, body, _ = self.daemon.request("GET", path)
        if status not in allowed:
            raise ValueError(f"{path} answers {status}: {body[:200]}")
        return body

    def some_job(self):
        with self.lock:
            return random.choice(self.jobs) if self.jobs else 1

    def submit(self):
        self.number += 1
        number = self.number
        document = curve(f"job {number}", labels={"user": random.choice("abcd"), "day": "1"},
                         points=random.randrange(5, 60))
        key = f"key {number}" if number % 3 == 0 else None
        for _ in range(2 if key else 1):
            status, job, _ = self.daemon.submit(document, key)
            if status != 202:
                raise ValueError(f"a submission answers {status}")
        with self.lock:
            self.jobs.append(job)

    def submit_and_wait(self):
        status, job, _ = self.daemon.submit(curve("waited for"), wait=10)
        if status not in (200, 202):
            raise ValueError(f"a submission answers {status}")

    def look(self):
        job = self.some_job()
        self.get(random.choice([
            f"/api/v1/jobs/{job}", f"/api/v1/jobs/{job}/result", f"/api/v1/jobs/{job}/attempts",
            f"/api/v1/jobs/{job}/samples.csv", f"/api/v1/jobs/{job}/log", f"/jobs/{job}", "/",
            "/api/v1/jobs", "/api/v1/jobs?state=succeeded&sort=-finished&limit=100",
            "/api/v1/jobs?label.user=a&sort=name", "/api/v1/materials", "/openapi.json", "/metrics",
            f"/api/v1/compare?jobs={job},{self.some_job() + 1}"]), (200, 304, 400, 404, 409, 410))

    def plot(self):
        size = random.choice(["", "?width=400&height=320", "?width=1200&height=900"])
        self.get(f"/api/v1/jobs/{self.some_job()}/plots/stress.png{size}")

    def change(self):
        action = random.choice(["cancel", "hold", "release", "retry"])
        status = self.daemon.request("POST", f"/api/v1/jobs/{self.some_job()}/{action}")[0]
        if status not in (200, 202, 404, 409):
            raise ValueError(f"{action} answers {status}")

    def release_all(self):
        for job in json.loads(self.get("/api/v1/jobs?state=held&limit=100"))["jobs"]:
            self.daemon.request("POST", f"/api/v1/jobs/{job['id']}/release")

    def delete_old(self):
        ended = "succeeded,failed,cancelled,timed_out"
        jobs = json.loads(self.get(f"/api/v1/jobs?state={ended}&sort=id&limit=500"))["jobs"]
        for job in jobs[: max(0, len(jobs) - KEPT_JOBS)]:
            self.daemon.request("DELETE", f"/api/v1/jobs/{job['id']}")
            with self.lock:
                if job["id"] in self.jobs:
                    self.jobs.remove(job["id"])

    def copy(self):
        if not self.get("/api/v1/database").startswith(b"SQLite format 3"):
            raise ValueError("the copy is no database")

    def misbehave(self):
        with socket.create_connection(("127.0.0.1", self.daemon.port), timeout=1) as client:
            client.sendall(random.choice(BAD))
            try:
                client.recv(4096)
            except TimeoutError:
                pass  # it waits for more, until the connection is closed here

    def follow(self):
        connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=20)
        connection.request("GET", "/api/v1/events")
        answer = connection.getresponse()
        until = time.monotonic() + random.random() * 10
        while answer.status == 200 and time.monotonic() < until and self.going:
            answer.readline()
        connection.close()

    def kill_worker(self):
        for (pid,) in self.daemon.sql("SELECT pid FROM attempt WHERE outcome = '' AND pid > 0"):
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            return


class Watch:
    """Looks at the daemon twice a second."""

    def __init__(self, daemon):
        self.daemon, self.rows = daemon, []

    def look(self, at):
        begin = time.monotonic()
        status = self.daemon.try_status("GET", "/api/v1/jobs?limit=5")
        latency = time.monotonic() - begin
        proc = f"/proc/{self.daemon.process.pid}"
        with open(f"{proc}/status") as file:
            lines = dict(line.split(":", 1) for line in file if ":" in line)
        self.rows.append({"at": at, "memory_MB": int(lines["VmRSS"].split()[0]) / 1024,
                          "threads": int(lines["Threads"]), "fds": len(os.listdir(f"{proc}/fd")),
                          "latency_ms": 1000 * latency, "status": status})

    def median(self, key, low, high):
        """Over the rows of a part of the time, 0 to 1."""
        last = self.rows[-1]["at"]
        return statistics.median(row[key] for row in self.rows if low * last <= row["at"] <= high * last)

    def table(self, hours):
        print(f"{'hour':>5} {'memory MB':>10} {'descriptors':>12} {'threads':>8} {'latency ms':>11}")
        for part in range(12):
            low, high = part / 12, (part + 1) / 12
            print(f"{hours * high:5.0f} {self.median('memory_MB', low, high):10.1f} "
                  f"{self.median('fds', low, high):12.0f} {self.median('threads', low, high):8.0f} "
                  f"{self.median('latency_ms', low, high):11.2f}", flush=True)


def judge(report, watch):
    """Medians of the last third against those of the second one."""
    limits = {"memory_MB": (1.05, 1.0), "fds": (1.0, 4.0), "threads": (1.0, 1.0),
              "latency_ms": (1.5, 2.0)}  # growth by a factor, or else by an amount, that is none
    for key, (factor, amount) in limits.items():
        middle, last = watch.median(key, 1 / 3, 2 / 3), watch.median(key, 2 / 3, 1)
        report.promise(f"no growth of {key}", last <= middle * factor or last <= middle + amount,
                       f"{middle:.2f} -> {last:.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=20)
    parser.add_argument("--hours", type=float, default=24, help="simulated")
    parser.add_argument("--load", type=float, default=1, help="factor of all paces")
    parser.add_argument("--brief", action="store_true", help="too short to judge growth by")
    arguments = parser.parse_args()
    report = Report(f"{arguments.hours:g} hours in {arguments.minutes:g} minutes")
    with Workspace() as work:
        daemon = Daemon(os.path.join(work, "data"), "--workers", "2", "--retry-delay", "0.1",
                        "--keep-files-size", "4")
        daemon.start()
        traffic, watch = Traffic(daemon), Watch(daemon)
        traffic.submit()
        paces = {"submit": 4, "submit_and_wait": 0.5, "look": 15, "plot": 1.5, "change": 1,
                 "release_all": 0.1, "delete_old": 0.2, "copy": 0.05, "misbehave": 2, "follow": 0.3,
                 "kill_worker": 0.1}
        for name, pace in paces.items():
            traffic.run(name, pace * arguments.load, getattr(traffic, name))
        begin = time.monotonic()
        while (at := time.monotonic() - begin) < 60 * arguments.minutes:
            watch.look(at)
            time.sleep(0.5)
        traffic.end()
        traffic.release_all()
        watch.table(arguments.hours)
        for name in paces:
            report.figure(name.replace("_", " "), traffic.counts.get(name, 0))
        if not arguments.brief:
            judge(report, watch)
        report.promise("every look was answered", all(row["status"] == 200 for row in watch.rows))
        report.promise("nothing else went wrong", not traffic.faults,
                       f"{len(traffic.faults)}: {traffic.faults[:3]}" if traffic.faults else "")
        report.promise("all jobs come to their end", daemon.wait_quiet())
        report.figure("jobs in all", daemon.one("SELECT max(id) FROM job"))
        report.figure("size of the database", os.path.getsize(f"{daemon.data}/pneulab.db") >> 10, "KiB")
        daemon.promise_sound(report, set())
        report.promise("it ends in order", daemon.stop() == 0)
    report.end()


if __name__ == "__main__":
    main()
