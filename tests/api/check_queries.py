#!/usr/bin/env python3
"""Runs the queries of docs/QUERIES.md on a database and compares their answers with what follows
from the formulas of the stand-in solver of test_queries.sh.

usage: check_queries.py QUERIES.md DATABASE
       check_queries.py QUERIES.md --study      prints the study of the page
       check_queries.py QUERIES.md --sql N      prints the query of question N
"""
import itertools
import re
import sqlite3
import sys

SOFT = {"elastic-50a": 1.0, "dragon-skin-30": 1.6}


class Design:
    """A member of the study, as the stand-in solves it."""

    def __init__(self, wall, chambers, material):
        self.wall, self.chambers, self.material = wall, chambers, material
        self.solved = not (wall == 1.5 and chambers == 12 and material == "dragon-skin-30")
        self.mass = 10 + 0.3 * chambers * (wall + 4)

    def angle(self, pressure=50.0):
        slope = 1.21 * self.chambers / 12 * 2 / self.wall * SOFT[self.material]
        return slope * pressure * (1 + 0.004 * pressure)

    def beats(self, other):
        a, b = (self.angle(), -self.mass), (other.angle(), -other.mass)
        return a != b and a[0] >= b[0] and a[1] >= b[1]


def reach(design, angle):
    """The pressure of an angle on the curve of straight pieces between steps of 10 kPa."""
    for low in range(0, 50, 10):
        a, b = design.angle(low), design.angle(low + 10)
        if a < angle <= b:
            return low + 10 * (angle - a) / (b - a)
    return None


def slope_of(designs):
    n = len(designs)
    x, y = sum(d.wall for d in designs) / n, sum(d.angle() for d in designs) / n
    return sum((d.wall - x) * (d.angle() - y) for d in designs) / sum((d.wall - x) ** 2 for d in designs)


def expected(jobs):
    """The answer to each question; jobs: Design by id, in the order of the study."""
    good = {job: d for job, d in jobs.items() if d.solved}
    by = {(d.wall, d.chambers, d.material): (job, d) for job, d in good.items()}
    yield [(job, d.angle(), d.mass) for job, d in sorted(good.items(), key=lambda i: (i[1].mass, i[0])) if d.angle() >= 60][:5]
    yield [(job, d.angle(), d.mass) for job, d in sorted(good.items(), key=lambda i: i[1].mass)
           if not any(o.beats(d) for o in good.values())]
    yield [(m, len(of), slope_of(of)) for m in sorted(SOFT) for of in [[d for d in good.values() if d.material == m]]]
    pairs = [(w, n, by[w, n, "elastic-50a"][1].angle(), d.angle(), 1.6) for (w, n, m), (_, d) in by.items() if m != "elastic-50a"]
    yield sorted(pairs, key=lambda row: row[:2])
    yield sorted((job, reach(d, 45)) for job, d in good.items() if reach(d, 45))
    yield [(23, 1.5, 1.5)]
    yield [("diverged", 1, 1.5, 1.5, 12, 12, "dragon-skin-30")]
    low, high = min(d.angle() for d in good.values()), max(d.angle() for d in good.values())
    light, heavy = min(d.mass for d in good.values()), max(d.mass for d in good.values())
    score = {job: 0.6 * (d.angle() - low) / (high - low) + 0.4 * (heavy - d.mass) / (heavy - light) for job, d in good.items()}
    best = sorted(score, key=lambda job: -score[job])[:10]
    yield [(i + 1, job, score[job]) for i, job in enumerate(best)]
    walls = [1.5, 1.75, 2.0, 2.5]
    yield sorted((job, 0.1 * (d.angle() - by[thick, d.chambers, d.material][1].angle()) / (thick - d.wall))
                 for job, d in good.items() for thick in walls[walls.index(d.wall) + 1:][:1])
    yield [(24, 0), (24, 0)]


def taken(number, rows):
    """The columns of an answer that are compared, in an order that ties do not change."""
    if number == 4:
        return sorted((r[0], r[1], r[2], r[3], r[4]) for r in rows)
    if number == 5:
        assert all(a[1] <= b[1] for a, b in zip(rows, rows[1:])), rows
        return sorted(rows)
    if number == 9:
        return sorted((row[0], row[5]) for row in rows if row[5] is not None)
    if number == 10:
        assert all(row[4] > 0 and row[5] > 0 and row[6] > 0 for row in rows), rows
        return [(row[2], row[3]) for row in rows]
    without_name = {1: (0, 2, 3), 2: (0, 2, 3), 8: (0, 1, 3)}.get(number)
    return [tuple(row[i] for i in without_name) if without_name else tuple(row) for row in rows]


def flat(value):
    for item in value:
        if isinstance(item, (list, tuple)):
            yield from flat(item)
        else:
            yield item


def same(a, b):
    a, b = list(flat(a)), list(flat(b))
    return len(a) == len(b) and all(
        x == y or (isinstance(x, (int, float)) and isinstance(y, (int, float)) and abs(x - y) <= 1e-6 * max(1, abs(y)))
        for x, y in zip(a, b))


def main():
    page = open(sys.argv[1], encoding="utf-8").read()
    questions = re.findall(r"^## (\d+)\. (.*?)\n.*?```sql\n(.*?)```", page, re.S | re.M)
    if sys.argv[2] == "--study":
        print(re.search(r"```json\n(.*?)```", page, re.S)[1])
        return 0
    if sys.argv[2] == "--sql":
        print(questions[int(sys.argv[3]) - 1][2])
        return 0
    database = sqlite3.connect(f"file:{sys.argv[2]}?mode=ro", uri=True)
    ids = [row[0] for row in database.execute("SELECT id FROM job WHERE study_id = 1 ORDER BY member")]
    designs = itertools.product([1.5, 1.75, 2.0, 2.5], [10, 11, 12], ["elastic-50a", "dragon-skin-30"])
    jobs = dict(zip(ids, (Design(*values) for values in designs)))
    failed = len(questions) != 10
    for (number, question, sql), wanted in zip(questions, expected(jobs)):
        got = taken(int(number), database.execute(sql).fetchall())
        good = bool(got) and same(got, wanted)
        failed = failed or not good
        print(f"{'ok' if good else 'FAILED'}: {number}. {question}" + ("" if good else f"\n  expected {wanted}\n  got      {got}"))
    return 1 if failed else 0


sys.exit(main())
