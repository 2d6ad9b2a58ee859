/* Several jobs in one process, each starting from what those before it have left.
 *
 * The file of a bundle is { "members": [ "FOLDER", ... ], "from": "FILE", "starts": [ 8, ... ] }.
 * `starts` are the members (counted from 0) that begin a chain of their own: they start from the
 * undeformed state, as the first does without `from`. A folder has the job as job.json; the
 * member's events.jsonl, log.txt, folder out with artifacts and at last result.json are written
 * there as by a run of its own: result.json is the result, or a document that tells the error, and
 * has its name only when it is complete. While another member follows, the folder also has a file
 * `path` with the converged states: it goes when that member is done, so that a bundle which ended
 * in between can be taken up by another one whose `from` names it. That one knows no member before
 * it: its results are the same to the solver's tolerance, not to the bit.
 *
 * On standard output each member has two lines,
 *   {"event": "begun", "member": 0}
 *   {"event": "done", "member": 0, "exit": 0, "cpu_s": 1.25, "peak_memory_MB": 88.5}
 * with the exit code that a run of its own would have had; peak memory is that of the process so
 * far. A member without a line of the second kind is not done.
 *
 * A member that is cancelled (solver/cancel.h) is done with the exit code 5, and the next one
 * follows; so is one whose folder has lost its job.json, with another code.
 *
 * A member starts from what is expected of it after all members of its chain with the topology of
 * its mesh that have reached their load (solver/fe/forecast.h); without such, from the undeformed
 * state. Results depend on the members of the bundle and their order, and on nothing else. */
#ifndef PNEULAB_BUNDLE_H
#define PNEULAB_BUNDLE_H

#include <stdbool.h>

struct bundle_options {
  const char *file;
  bool verbose; /* as in struct run_options */
};

/* Solves the members in order, and returns the exit code: EXIT_SUCCEEDED when all are done, however
 * each of them ended; EXIT_CANCELLED; EXIT_INTERNAL when the file could not be read, a folder could
 * not be written, or memory ran out (the member then has its error). */
int bundle_run(const struct bundle_options *options);

#endif
