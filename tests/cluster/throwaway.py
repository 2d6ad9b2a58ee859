"""A throw-away Slurm cluster for scripts in Python; see cluster_up.sh."""
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))


class Cluster:
    """Its daemons have the names munged, slurmctld, n1, n2, ..."""

    def __init__(self, directory, nodes=2, cpus=2, lines=""):
        self.directory, self.names = directory, [f"n{n + 1}" for n in range(nodes)]
        self.environment = {**os.environ, "CLUSTER_NODES": str(nodes), "CLUSTER_CPUS": str(cpus),
                            "CLUSTER_CONF": lines}
        os.environ["SLURM_CONF"] = os.path.join(directory, "slurm.conf")

    def up(self, *names):
        """Starts what does not run, or only these. Ends the program with status 77 where that
        cannot be done."""
        done = subprocess.run([os.path.join(HERE, "cluster_up.sh"), self.directory, *names],
                              env=self.environment, stdout=subprocess.PIPE, text=True, check=False)
        if done.returncode != 0:
            print(done.stdout.strip())
            sys.exit(done.returncode)

    def down(self, *names, kill=False):
        """Ends all of it, or only these; with kill as if their power had failed."""
        subprocess.run([os.path.join(HERE, "cluster_down.sh"), *(["--kill"] if kill else []),
                        self.directory, *names], check=False)

    def resume(self):
        """Returns drained nodes to service, as an administrator would; their number."""
        drained = [name for name in self.names if "drain" in self.state(name)]
        for name in drained:
            subprocess.run(["scontrol", "update", f"nodename={name}", "state=resume"], check=False)
        return len(drained)

    def state(self, name):
        """The state of a node, a word."""
        done = subprocess.run(["sinfo", "-h", "-n", name, "-o", "%T"], stdout=subprocess.PIPE, text=True,
                              stderr=subprocess.DEVNULL, check=False)
        return done.stdout.strip()

    def tasks(self, *options):
        """Lines of squeue about tasks that have not ended."""
        done = subprocess.run(["squeue", "-h", "-r", *options], stdout=subprocess.PIPE, text=True,
                              stderr=subprocess.DEVNULL, check=False)
        return done.stdout.splitlines()

    def pid(self, name):
        """The process of a daemon."""
        file = {"munged": "munge/pid", "slurmctld": "slurmctld.pid"}.get(name, f"slurmd-{name}.pid")
        with open(os.path.join(self.directory, file)) as text:
            return int(text.read())

    def completed(self):
        """Tasks that Slurm has brought to an end: (name, job, state) each."""
        rows = []
        with open(os.path.join(self.directory, "log/completed")) as lines:
            for line in lines:
                words = dict(word.split("=", 1) for word in line.split() if "=" in word)
                rows.append((words["Name"], words["JobId"], words["JobState"]))
        return rows
