/* What Slurm prints, and what it means. Nothing here asks it. */
#ifndef PNEULAB_SLURM_WORDS_H
#define PNEULAB_SLURM_WORDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What has become of a task. */
enum slurm_state {
  SLURM_PENDING,
  SLURM_RUNNING,       /* or about to, suspended, or about to end */
  SLURM_COMPLETED,     /* its program ended with exit code 0 */
  SLURM_FAILED,        /* otherwise */
  SLURM_CANCELLED,     /* by somebody */
  SLURM_TIMED_OUT,     /* by the time limit that it was submitted with */
  SLURM_OUT_OF_MEMORY, /* beyond what it was given */
  SLURM_NODE_LOST,     /* its node failed, or was taken for another job */
  SLURM_UNKNOWN
};

/* The state of a word as in "PENDING", "COMPLETING" or "CANCELLED by 1000". */
enum slurm_state slurm_state_of(const char *word);

/* Our word for it, lower case: "pending", ... "unknown". Static storage. */
const char *slurm_state_word(enum slurm_state state);

/* The format for `squeue --format` that slurm_line_read understands. */
#define SLURM_LINE_FORMAT "%F|%K|%T|%r|%N|%P|%j"

/* A line of squeue: one task, or those of an array that are pending together. Texts point into the
 * line. */
struct slurm_line {
  int64_t job;       /* number of the array */
  const char *tasks; /* as in "7" or "3-99,120" */
  enum slurm_state state;
  const char *reason, *node, *partition, *name;
};

/* Reads a line of that format, which is cut into pieces; false for any other. */
bool slurm_line_read(char *line, struct slurm_line *read);

/* Steps through task numbers as in "0-2,7,9-15:2%4": *cursor is the text at first, then what is
 * left. False at the end, or where it makes no sense. */
struct slurm_range {
  int64_t low, high, step;
};
bool slurm_range_next(const char **cursor, struct slurm_range *range);

/* What a pending reason means to people, a sentence; NULL for one that is not known. */
const char *slurm_reason_sentence(const char *reason);

/* The job number that `sbatch --parsable` prints ("123" or "123;cluster"), 0 for none. */
int64_t slurm_submitted_job(const char *output);

/* Whether a failure of one of the programs says that the cluster cannot be reached (then nothing is
 * known of what was asked), rather than that it refuses. */
bool slurm_unreachable(const char *problem);

#endif
