#!/usr/bin/env python3
"""Lists, counts, starts and claims of a daemon with many stored jobs.

  bench_store.py OUT.json [--jobs N] [--queued N] [--few N] [--every N]

Fills one database with N jobs (1000000 unless given) and another one with few (10000), starts the
daemon on each and measures: the size of the file and the time of a start in proportion; the first
and the hundredth page of the list of jobs for every filter with every order, the middle of five
requests each; what monitors ask for; and how many jobs a second one worker gets through behind a
long queue and a short one. --every takes only each Nth filter with its order, for a trial. The status
is 1 when a page took 10 ms or more, unless it was a trial. Needs python3; BIN: where the programs
are (the current folder).
"""
import argparse
import http.client
import json
import os
import pathlib
import sqlite3
import statistics
import subprocess
import sys
import tempfile
import time

BIN = pathlib.Path(os.environ.get("BIN", ".")).resolve()
REPEATS = 5
PAGE, PAGES = 50, 100
STEP = 450  # jobs that are passed over at a time on the way to the last page
LIMIT_MS = 10.0

FILTERS = ["", "state=succeeded", "state=failed", "state=queued,held", "state=succeeded,failed,cancelled",
           "kind=response", "kind=snap", "label.user=user%200", "label.user=user%2040", "label.round=17",
           "kind=response&state=succeeded", "kind=snap&state=failed", "state=failed&label.user=user%200",
           "kind=hlpv&label.user=user%203", "kind=response&state=succeeded&label.project=project%201",
           "label.user=user%201&label.project=project%202", "label.user=user%200&label.round=17"]
ORDERS = [sign + key for key in ("id", "created", "finished", "name", "state") for sign in ("", "-")]

# Of 200 jobs 180 succeeded, 12 failed, 4 were cancelled, 2 ran out of time, 1 waits, 1 is held.
FILL = """
CREATE TEMP TABLE n AS WITH RECURSIVE c(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM c WHERE i < {jobs})
  SELECT i, i * 48271 % 2147483647 AS r FROM c;
INSERT INTO job (state, kind, name, document, spec_hash, attempt, created_ms, started_ms, finished_ms, submitter,
    solver_version)
  SELECT CASE WHEN r % 200 < 180 THEN 'succeeded' WHEN r % 200 < 192 THEN 'failed' WHEN r % 200 < 196 THEN 'cancelled'
      WHEN r % 200 < 198 THEN 'timed_out' WHEN r % 200 < 199 THEN 'held' ELSE 'queued' END,
    CASE WHEN r % 20 < 12 THEN 'response' WHEN r % 20 < 16 THEN 'hlpv' WHEN r % 20 < 18 THEN 'study'
      WHEN r % 20 < 19 THEN 'snap' ELSE 'verify' END,
    iif(r % 10 = 0, '', 'design ' || (r % 50000)), '{{"kind":"verify","case":"patch-test"}}', printf('%064x', r), 1,
    1700000000000 + 400 * i, 1700000001000 + 400 * i,
    iif(r % 200 < 198, 1700000002000 + 400 * i + r % 60000, NULL), 'user ' || (r % 50), '0.1.0' FROM n;
INSERT INTO job_label (job_id, name, value, kind, state, finished_ms, job_name)
  SELECT id, 'user', 'user ' || (r % 7 * (r % 8)), kind, state, finished_ms, name FROM job JOIN n ON i = id;
INSERT INTO job_label (job_id, name, value, kind, state, finished_ms, job_name)
  SELECT id, 'project', 'project ' || (r % 10), kind, state, finished_ms, name FROM job JOIN n ON i = id;
INSERT INTO job_label (job_id, name, value, kind, state, finished_ms, job_name)
  SELECT id, 'round', r % 5000, kind, state, finished_ms, name FROM job JOIN n ON i = id WHERE r % 3 = 0;
INSERT INTO attempt (job_id, number, outcome, exit_code, created_ms, finished_ms, cpu_s, peak_memory_MB)
  SELECT id, 1, state, 0, started_ms, finished_ms, 1, 100 FROM job WHERE finished_ms IS NOT NULL;
INSERT INTO result (job_id, attempt, document, directory, created_ms)
  SELECT id, 1, '{{"status":"succeeded","metrics":{{"bending_angle_deg":64,"mass_g":3.5}},"samples":[]}}',
    'attempts/' || id || '-1', finished_ms FROM job WHERE state = 'succeeded';
INSERT INTO metric SELECT job_id, 'bending_angle_deg', job_id % 360 FROM result;
INSERT INTO metric SELECT job_id, 'mass_g', 3.5 FROM result;
"""
QUEUE = """
WITH RECURSIVE c(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM c WHERE i < {jobs})
INSERT INTO job (state, kind, name, document, spec_hash, created_ms, submitter, priority)
  SELECT 'queued', 'verify', 'waits', '{{"kind":"verify","case":"patch-test"}}', 'h', 1700000000000 + i,
    'user ' || (i % {users}), i % 5 FROM c;
"""
SOLVER = "#!/bin/sh\necho '{\"status\":\"succeeded\",\"metrics\":{},\"samples\":[]}'\n"
IDLE = "#!/bin/sh\nexec sleep 3600\n"


class Daemon:
    """A daemon on a free port; start_s is the time until it listens."""

    def __init__(self, data, *options):
        begin = time.monotonic()
        self.process = subprocess.Popen(
            [BIN / "pneulabd", "--data", data, "--listen", "127.0.0.1:0", "--workers", "1",
             "--drain-timeout", "0", *options],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        line = self.process.stdout.readline()
        self.start_s = time.monotonic() - begin
        if not line.startswith("listening on "):
            raise SystemExit("bench_store: the daemon did not start")
        self.connection = http.client.HTTPConnection(line.split("//")[1].strip())

    def get(self, path):
        begin = time.monotonic()
        self.connection.request("GET", path)
        answer = self.connection.getresponse()
        body = answer.read()
        taken = 1e3 * (time.monotonic() - begin)
        if answer.status != 200:
            raise SystemExit(f"bench_store: {path}: {answer.status} {body[:300]}")
        return taken, body

    def middle_ms(self, path):
        return statistics.median(self.get(path)[0] for _ in range(REPEATS))

    def stop(self):
        self.connection.close()
        self.process.terminate()
        self.process.wait()


def solver(path, text):
    path.write_text(text)
    path.chmod(0o755)
    return path


def fill(data, script, **parts):
    """A database as the daemon makes it, with rows added while nobody uses it."""
    Daemon(data).stop()
    db = sqlite3.connect(data / "pneulab.db", isolation_level=None)
    db.executescript("PRAGMA synchronous = OFF; PRAGMA cache_size = -500000; PRAGMA temp_store = MEMORY; BEGIN;"
                     + script.format(**parts) + "COMMIT; PRAGMA wal_checkpoint(TRUNCATE);")
    db.close()
    return (data / "pneulab.db").stat().st_size


def lists(daemon, every):
    """Every filter with every order: milliseconds of the first and the hundredth page."""
    rows = []
    for what, order in [(what, order) for what in FILTERS for order in ORDERS][::every]:
        path = f"/api/v1/jobs?sort={order}" + ("&" + what if what else "")
        passed, at = 0, path
        first = daemon.middle_ms(path)
        while passed < PAGE * (PAGES - 1):
            cursor = json.loads(daemon.get(f"{at}&limit={STEP}")[1])["next"]
            if not cursor:
                break
            at = f"{path}&cursor={cursor}"
            passed += STEP
        rows.append({"filter": what, "sort": order, "first_ms": first, "page": passed // PAGE + 1,
                     "last_ms": daemon.middle_ms(at)})
    return rows


def jobs_per_second(work, queued, users):
    """How many jobs one worker gets through in ten seconds with so many waiting."""
    data = work / f"queue-{queued}-{users}"
    fill(data, QUEUE, jobs=queued, users=users)
    daemon = Daemon(data, "--solver", solver(work / "solver", SOLVER))
    time.sleep(min(10, queued / 100))
    daemon.stop()
    db = sqlite3.connect(data / "pneulab.db")
    done, first, last = db.execute("SELECT count(*), min(created_ms), max(finished_ms) FROM attempt "
                                   "WHERE outcome = 'succeeded'").fetchone()
    db.close()
    return 1e3 * done / (last - first)


def measure(work, jobs, few, queued, every):
    result = {"program": "bench_store", "jobs": jobs, "few": few, "queued": queued}
    for name, count in (("few", few), ("many", jobs)):
        data = work / name
        begin = time.monotonic()
        size = fill(data, FILL, jobs=count)
        print(f"{count} jobs: filled in {time.monotonic() - begin:.0f} s, {size / count:.0f} bytes a job", flush=True)
        starts = []
        for _ in range(3):
            daemon = Daemon(data, "--solver", solver(work / "idle", IDLE))
            starts.append(daemon.start_s)
            if len(starts) < 3:
                daemon.stop()
        result[name] = {"bytes_a_job": size / count, "start_s": min(starts),
                        "metrics_ms": daemon.middle_ms("/metrics"), "readyz_ms": daemon.middle_ms("/readyz"),
                        "job_ms": daemon.middle_ms(f"/api/v1/jobs/{count // 2}"), "lists": lists(daemon, every)}
        daemon.stop()
    result["jobs_per_second"] = {"short": jobs_per_second(work, min(1000, queued), 1), "long": jobs_per_second(work, queued, 20),
                                 "long_all_different": jobs_per_second(work, queued, queued)}
    return result


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out")
    parser.add_argument("--jobs", type=int, default=1000000)
    parser.add_argument("--few", type=int, default=10000)
    parser.add_argument("--queued", type=int, default=100000)
    parser.add_argument("--every", type=int, default=1)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        result = measure(pathlib.Path(work), arguments.jobs, arguments.few, arguments.queued,
                         arguments.every)
    pathlib.Path(arguments.out).write_text(json.dumps(result, indent=1) + "\n")
    for name in ("few", "many"):
        one = result[name]
        times = [row[key] for row in one["lists"] for key in ("first_ms", "last_ms")]
        worst = max(one["lists"], key=lambda row: max(row["first_ms"], row["last_ms"]))
        print(f"{name}: {one['bytes_a_job']:.0f} bytes a job, start {one['start_s']:.3f} s, /metrics "
              f"{one['metrics_ms']:.2f} ms, /readyz {one['readyz_ms']:.2f} ms, a job {one['job_ms']:.2f} ms")
        print(f"{name}: {len(times)} pages: middle {statistics.median(times):.2f} ms, worst {max(times):.2f} ms "
              f"({worst['filter']} sort={worst['sort']}), {sum(t >= LIMIT_MS for t in times)} of {LIMIT_MS:.0f} ms or more")
    print("jobs a second of one worker:",
          ", ".join(f"{name} {rate:.0f}" for name, rate in result["jobs_per_second"].items()))
    slow = [row for row in result["many"]["lists"] if max(row["first_ms"], row["last_ms"]) >= LIMIT_MS]
    return 1 if slow and arguments.every == 1 else 0


if __name__ == "__main__":
    sys.exit(main())
