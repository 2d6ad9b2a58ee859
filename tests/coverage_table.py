#!/usr/bin/env python3
"""Prints the branch coverage of what reads bytes from outside, from the build in this directory."""
import glob
import re
import subprocess

FOLDERS = ("solver/base", "solver/job", "solver/rigid", "server/base", "server/auth", "server/exec",
           "server/http")
PARSERS = ("json json_memory schema schema_* spec spec_* embed study study_* trials steps "
           "tensile measured parameter mirror *_check bistable hlpv stl stl_text surface_weld "
           "profile units table text error numbers url request guard option options token_file "
           "token_command progress outcome route access session events event_text cache jobs "
           "submission patch retry").split()


def branches(notes, source):
    """Number of branches of a source and the share in percent that was taken, or None."""
    report = subprocess.run(["gcov", "-b", "-n", "-o", notes, notes], capture_output=True,
                            text=True, check=False).stdout
    found = re.search(r"File '[^']*" + re.escape(source) +
                      r"'\n.*\n.*\nTaken at least once:([\d.]+)% of (\d+)", report)
    return (int(found[2]), float(found[1])) if found else None


def main():
    names = {name for parser in PARSERS for folder in FOLDERS
             for name in glob.glob(f"{folder}/*-{parser}.gcda")}
    names.update(glob.glob("server/plot/*-skin.gcda"))  # surface.json of a worker
    rows = []
    for name in names:
        folder, file = name.rsplit("/", 1)
        source = f"{folder}/{file.split('-')[-1][:-len('.gcda')]}.c"
        counted = branches(name, source)
        if counted:
            rows.append((counted[1], counted[0], source))
    for share, count, source in sorted(rows):
        print(f"{source:40} {count:6} {share:6.1f} %")
    for part in ("solver/", "server/", ""):
        total = sum(count for _, count, source in rows if source.startswith(part))
        taken = sum(share * count for share, count, source in rows if source.startswith(part))
        print(f"{(part + ' all').strip():40} {total:6} {taken / max(total, 1):6.1f} %")


main()
