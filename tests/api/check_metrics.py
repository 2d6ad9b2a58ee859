#!/usr/bin/env python3
"""Reads the answer of /metrics and prints what breaks the rules of Prometheus' text form."""
import re
import sys

NAME = re.compile(r"^[a-z_][a-z0-9_]*$")
SAMPLE = re.compile(r'^([a-zA-Z_:][a-zA-Z0-9_:]*)(?:\{(.*)\})? (\S+)$')
LABEL = re.compile(r'([a-zA-Z_][a-zA-Z0-9_]*)="((?:[^"\\]|\\.)*)"(?:,|$)')
# What a name that measures something ends in (before _total), and names that count things.
UNITS = ("_seconds", "_bytes", "_info", "_fds", "_jobs", "_workers", "_busy", "_connections",
         "_subscribers", "_isolation", "_tasks", "_reachable")


def labels_of(text):
    found = LABEL.findall(text or "")
    if ",".join('%s="%s"' % pair for pair in found) != (text or ""):
        return None
    return dict(found)


def check_histogram(name, samples, complain):
    series = {}
    for sample, labels, value in samples:
        key = tuple(sorted(pair for pair in labels.items() if pair[0] != "le"))
        part = series.setdefault(key, {"buckets": []})
        if sample == name + "_bucket":
            part["buckets"].append((float(labels["le"].replace("+Inf", "inf")), value))
        else:
            part[sample[len(name):]] = value
    for key, part in series.items():
        bounds = [bound for bound, _ in part["buckets"]]
        counts = [count for _, count in part["buckets"]]
        if bounds != sorted(set(bounds)) or not bounds or bounds[-1] != float("inf"):
            complain("%s%s: bounds %s" % (name, key, bounds))
        if counts != sorted(counts):
            complain("%s%s: buckets are not cumulative" % (name, key))
        if "_sum" not in part or part.get("_count") != counts[-1]:
            complain("%s%s: sum or count is wrong" % (name, key))


def main():
    problems = []
    complain = problems.append
    helps, types, samples, seen, order = {}, {}, {}, set(), []
    text = sys.stdin.read()
    if not text.endswith("\n"):
        complain("the last line has no end")
    for line in text.splitlines():
        if line.startswith("# HELP "):
            name, _, words = line[7:].partition(" ")
            if name in helps or not words.endswith("."):
                complain("HELP of " + name)
            helps[name] = words
        elif line.startswith("# TYPE "):
            name, _, kind = line[7:].partition(" ")
            if name in types or kind not in ("counter", "gauge", "histogram"):
                complain("TYPE of " + name)
            types[name] = kind
            order.append(name)
        else:
            match = SAMPLE.match(line)
            labels = labels_of(match.group(2)) if match else None
            if labels is None:
                complain("no sample: " + line)
                continue
            family = re.sub(r"_(bucket|sum|count)$", "", match.group(1))
            family = family if types.get(family) == "histogram" else match.group(1)
            if not order or family != order[-1]:
                complain("%s stands away from its TYPE" % match.group(1))
            if (match.group(1), match.group(2)) in seen:
                complain("twice: " + line)
            seen.add((match.group(1), match.group(2)))
            samples.setdefault(family, []).append((match.group(1), labels, float(match.group(3))))
    for name, kind in types.items():
        bare = re.sub("_total$", "", name)
        if not NAME.match(name) or name not in helps:
            complain(name + " has a bad name or no HELP")
        if (kind == "counter") != name.endswith("_total"):
            complain("%s is a %s" % (name, kind))
        if kind != "counter" and not name.endswith(UNITS):
            complain(name + " has no unit")
        if re.search(r"_(ms|milliseconds|us|mb|kb|minutes|hours|percent)$", bare):
            complain(name + ": units are seconds and bytes")
        if kind == "histogram":
            check_histogram(name, samples.get(name, []), complain)
    for name in sys.argv[1:]:
        if name not in types:
            complain("missing: " + name)
    print("\n".join(problems))


main()
