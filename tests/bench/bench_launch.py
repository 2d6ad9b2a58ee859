#!/usr/bin/env python3
"""Time from the start of a program to its end, without and with pneulab-launch: least and median of
N runs of each, in turns. usage: bench_launch.py PNEULAB-LAUNCH [N]"""
import statistics
import subprocess
import sys
import tempfile
import time

launcher, runs = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 300
with tempfile.TemporaryDirectory() as folder:
    limits = ["--memory", "2147483648", "--processes", "65", "--descriptors", "512",
              "--file", "268435456", "--cpu", "3600", "--write", folder]
    ways = {
        "alone": [],
        "launcher, limits": [launcher, *limits, "--"],
        "with Landlock": [launcher, *limits, "--landlock", "--"],
        "with seccomp": [launcher, *limits, "--seccomp", "--"],
        "with a namespace": [launcher, *limits, "--namespaces", "--"],
        "with all": [launcher, *limits, "--landlock", "--seccomp", "--namespaces", "--"],
    }
    times = {name: [] for name in ways}
    for _ in range(runs):
        for name, command in ways.items():
            start = time.perf_counter()
            subprocess.run([*command, "/bin/true"], check=True)
            times[name].append(1e3 * (time.perf_counter() - start))
    for name, values in times.items():
        print(f"{name:18} {min(values):6.2f} ms least {statistics.median(values):6.2f} ms median")
