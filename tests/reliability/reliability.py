"""What the scripts below tests/reliability share: a daemon that can be started, asked, killed and
looked into, and promises that are checked. They need no package beside Python's own.

BIN (default: the current directory) has the programs."""
import http.client
import json
import mmap
import os
import shutil
import signal
import sqlite3
import struct
import subprocess
import sys
import tempfile
import threading
import time

BIN = os.environ.get("BIN", os.getcwd())
TERMINAL = ("succeeded", "failed", "timed_out", "cancelled")
SANITIZER = ("ERROR: AddressSanitizer", "ERROR: LeakSanitizer", "runtime error:", "WARNING: ThreadSan")


def curve(name, **members):
    """A job that is solved in some milliseconds."""
    return {"kind": "material-curve", "name": name, "material": "elastosil-m4601-tapered",
            "stretch": [0.5, 3.25], "points": 11, **members}


def memory_limit():
    """The shadow memory of a sanitizer does not fit under a limit of private memory."""
    with open(os.path.join(BIN, "pneulab-solve"), "rb") as program:
        text = program.read()
    return "0" if b"__asan_init" in text or b"__tsan_init" in text else "2048"


class Report:
    """Figures, and promises that hold or do not."""

    def __init__(self, title):
        self.title, self.broken, self.started = title, [], time.monotonic()
        print(f"== {title}", flush=True)

    def figure(self, name, value, unit=""):
        text = f"{value:.3f}" if isinstance(value, float) else str(value)
        print(f"{name:<58} {text:>10} {unit}", flush=True)

    def promise(self, sentence, holds, found=""):
        print(f"{'kept  ' if holds else 'BROKEN'}  {sentence}{': ' + str(found) if found else ''}",
              flush=True)
        if not holds:
            self.broken.append(sentence)

    def end(self):
        self.figure("time taken", time.monotonic() - self.started, "s")
        if self.broken:
            print(f"FAILED: {self.title}: {len(self.broken)} promises broken", flush=True)
        sys.exit(1 if self.broken else 0)


class Daemon:
    """A daemon on a port of its own. Connections are kept, one a thread."""

    def __init__(self, data, *options, environment=None, program="pneulabd"):
        self.data, self.options, self.program = data, options, program
        self.environment = {**os.environ, **(environment or {})}
        self.process, self.port, self.ready_s = None, None, None
        self.log = data.rstrip("/") + ".log"
        self.local = threading.local()
        self.generation = 0
        self.memory_limit = memory_limit()

    def start(self, wait=True):
        """Starts it; with wait, until /readyz says so. Returns the seconds that took."""
        begin = time.monotonic()
        self.generation += 1
        with open(self.log, "ab") as log:
            self.process = subprocess.Popen(
                [os.path.join(BIN, self.program), "--data", self.data, "--listen", "127.0.0.1:0",
                 "--connections-per-address", "400", "--memory-limit", self.memory_limit,
                 *self.options],
                stdout=subprocess.PIPE, stderr=log, env=self.environment)
        if not wait:
            return None
        line = self.process.stdout.readline().decode()
        if not line.startswith("listening on "):
            raise RuntimeError(f"the daemon did not start: {self.tail()}")
        self.port = int(line.strip().rsplit(":", 1)[1])
        while self.try_status("GET", "/readyz") != 200:
            if time.monotonic() - begin > 60:
                raise RuntimeError(f"the daemon is not ready: {self.tail()}")
            time.sleep(0.005)
        self.ready_s = time.monotonic() - begin
        return self.ready_s

    def tail(self):
        with open(self.log, errors="replace") as log:
            return "".join(log.readlines()[-8:])

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        self.process.stdout.close()

    def stop(self):
        self.process.terminate()
        code = self.process.wait(timeout=120)
        self.process.stdout.close()
        return code

    def request(self, method, path, body=None, headers=None, timeout=30):
        """(status, body, headers). OSError and HTTPException when the daemon is not there."""
        local = self.local
        if getattr(local, "generation", None) != self.generation:
            local.connection, local.generation = None, self.generation
        fresh = local.connection is None
        if fresh:
            local.connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)
        try:
            data = json.dumps(body) if isinstance(body, dict) else body
            local.connection.request(method, path, data, headers or {})
            answer = local.connection.getresponse()
            if answer.status == 408 and not fresh:
                raise http.client.BadStatusLine("an idle connection was closed")
            return answer.status, answer.read(), answer.headers
        except (OSError, http.client.HTTPException) as reason:
            local.connection.close()
            local.connection = None
            if fresh or not isinstance(reason, (http.client.BadStatusLine, ConnectionError)):
                raise
            return self.request(method, path, body, headers, timeout)  # an idle one was closed

    def try_status(self, *arguments, **named):
        try:
            return self.request(*arguments, **named)[0]
        except (OSError, http.client.HTTPException):
            return None

    def submit(self, document, key=None, wait=None):
        """(status, id or None, headers)."""
        headers = {"Idempotency-Key": key} if key else {}
        if wait:
            headers["Prefer"] = f"wait={wait}"
        status, body, answered = self.request("POST", "/api/v1/jobs", document, headers,
                                              timeout=90)
        return status, json.loads(body)["id"] if status in (200, 202) else None, answered

    def sql(self, statement, *values):
        """Rows of the database file itself, beside the daemon."""
        for _ in range(200):
            try:
                db = sqlite3.connect(f"file:{self.data}/pneulab.db?mode=ro", uri=True, timeout=10)
                try:
                    return db.execute(statement, values).fetchall()
                finally:
                    db.close()
            except sqlite3.OperationalError as reason:
                trouble = reason
                time.sleep(0.05)  # the daemon was killed in the midst of a checkpoint
        raise RuntimeError(f"the database cannot be read: {trouble}")

    def one(self, statement, *values):
        return self.sql(statement, *values)[0][0]

    def wait_quiet(self, seconds=600):
        """Waits until every job has ended; False when that takes too long."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            if self.one(f"SELECT count(*) FROM job WHERE state NOT IN {TERMINAL}") == 0:
                return True
            time.sleep(0.2)
        return False

    def promise_sound(self, report, acknowledged):
        """Nothing acknowledged is lost, nothing counts twice, and the file is sound."""
        known = {row[0] for row in self.sql("SELECT id FROM job")}
        report.promise("every acknowledged job is in the database", acknowledged <= known,
                       f"{len(acknowledged - known)} of {len(acknowledged)} lost")
        twice = self.sql(f"SELECT job_id, count(*) FROM event WHERE state IN {TERMINAL} "
                         "GROUP BY job_id HAVING count(*) > 1")
        report.promise("no job ended twice", not twice, f"{len(twice)} did")
        wrong = self.one("SELECT count(*) FROM result JOIN job ON job.id = result.job_id "
                         "WHERE result.attempt <> job.attempt AND job.reused_from IS NULL")
        report.promise("every result is of its job's last attempt", wrong == 0, f"{wrong} are not")
        bare = self.one("SELECT count(*) FROM job LEFT JOIN result ON result.job_id = job.id "
                        "WHERE job.state = 'succeeded' AND result.job_id IS NULL")
        report.promise("every job that succeeded has its result", bare == 0, f"{bare} have none")
        open_attempts = self.one("SELECT count(*) FROM attempt WHERE outcome = '' AND job_id IN "
                                 f"(SELECT id FROM job WHERE state IN {TERMINAL})")
        report.promise("no attempt of a finished job is open", open_attempts == 0, open_attempts)
        report.promise("the database is sound", self.one("PRAGMA integrity_check") == "ok")
        report.promise("its rows refer to each other", not self.sql("PRAGMA foreign_key_check"))
        with open(self.log, errors="replace") as log:
            found = [line for line in log if any(word in line for word in SANITIZER)]
        report.promise("no sanitizer has a report", not found, "".join(found[:3]))


class Faults:
    """Orders to the library disk_faults.so that a daemon is started with."""
    WRITE, SYNC, TRUNCATE, CREATE, NAME, ALL = 1, 2, 4, 8, 16, 31
    FORMAT = "iiqqq64s"

    def __init__(self, directory):
        self.path = os.path.join(directory, "orders")
        with open(self.path, "wb") as file:
            file.write(bytes(4096))
        with open(self.path, "r+b") as file:
            self.map = mmap.mmap(file.fileno(), 4096)

    def environment(self):
        library = os.path.join(BIN, "tests/reliability/disk_faults.so")
        asan = os.environ.get("ASAN_OPTIONS", "")
        return {"LD_PRELOAD": library, "DISK_FAULTS": self.path,
                "ASAN_OPTIONS": f"{asan}:verify_asan_link_order=0"}

    def order(self, operations, code, part, skip=0, count=1 << 40):
        """From now on: of these operations on paths with `part`, fail `count` after `skip`."""
        self.clear()
        orders = bytearray(struct.pack(self.FORMAT, 0, code, skip, count, 0, part.encode()))
        self.map[: len(orders)] = bytes(orders)
        self.map[:4] = struct.pack("i", operations)

    def clear(self):
        self.map[:4] = struct.pack("i", 0)

    def failed(self):
        return struct.unpack(self.FORMAT, self.map[: struct.calcsize(self.FORMAT)])[4]


class Workspace:
    """A directory that goes when the script ends."""

    def __enter__(self):
        self.path = tempfile.mkdtemp(prefix="pneulab-reliability-")
        return self.path

    def __exit__(self, *_):
        shutil.rmtree(self.path, ignore_errors=True)


STUB = """#!/bin/bash
# Stands in for pneulab-solve: works for a while, then prints a result.
while [ $# -gt 1 ]; do
  case $1 in --out) out=$2; shift 2 ;; -*) shift 2 ;; esac
done
sleep "0.$((RANDOM % 7 + 2))"
echo '{}' > "$out/surface.json"
echo '{"status":"succeeded","metrics":{"mass_g":3.5},"samples":[],"artifacts":["surface.json"]}'
"""


def stub_solver(directory):
    """Writes a solver that sleeps for 0.2 to 0.8 s, and returns its path."""
    path = os.path.join(directory, "solver")
    with open(path, "w") as file:
        file.write(STUB)
    os.chmod(path, 0o755)
    return path
