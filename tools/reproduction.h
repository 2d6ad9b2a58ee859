/* make reproduction: runs the jobs of the published studies, and lays their results beside what was
 * published. */
#ifndef PNEULAB_TOOLS_REPRODUCTION_H
#define PNEULAB_TOOLS_REPRODUCTION_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

enum { WORKS_MAX = 200, WORK_NAME = 120, WORK_PATH = 4096 };

/* One job file and its result. */
struct work {
  char name[WORK_NAME];      /* "multicurvature/taper" */
  char job[WORK_PATH];       /* its file */
  char directory[WORK_PATH]; /* of its result.json and other files */
  char hash[65];             /* of the job with its files embedded; "" when it cannot be read */
  bool study;
  json_t *result; /* NULL: missing */
  double wall_s;  /* of the run that gave it */
};

struct works {
  struct work *item;
  int count;
};

/* Finds the job files of the folders SOURCE/jobs/FOLDER, in the order of their names, with the
 * results that are there already: a result counts when its job and the solver's version are the
 * present ones. False with a message on standard error. */
bool works_find(struct works *works, const char *source, const char *build);
void works_release(struct works *works);

/* Whether `only` (NULL: everything) names the job or its folder. */
bool work_is_wanted(const struct work *work, const char *only);

/* Runs what is wanted and has no result: single jobs several at a time, then studies with as many
 * members at a time. Says on standard error what goes on. False when a process could not be
 * started. */
bool works_run(struct works *works, const char *only, const char *solver, int processes);

/* The result named by "FOLDER/JOB" or, of a study, its member "FOLDER/JOB#MEMBER"; NULL when it is
 * missing. */
const json_t *works_result(const struct works *works, const char *from);

/* Our counterpart of a published value. */
struct finding {
  bool found;
  double value, error; /* estimated numerical error, negative when there is none */
  char missing[200];   /* why there is no value */
};

/* Applies a rule of docs/reproduction.json:
 *   "from"  "FOLDER/JOB" or "FOLDER/JOB#MEMBER"
 *   "value" JSON pointer into that result; its error estimate is beside it as KEY_error
 *   "key"   instead: a key of the samples, with "at_kPa" (interpolated), "reaches" (gives the
 *           pressure in kPa, interpolated), or "extreme": "largest" or "smallest" over all samples
 *   "path"   the points of this path in place of the samples
 *   "last"   true: where the pressure is passed for the last time, not the first
 *   "factor" to be multiplied with; 1 unless given
 * or one of these, with two rules each:
 *   "difference" the first less the second
 *   "ratio"      the first over the second
 *   "shift_ratio" with four: what the second differs from the first, over what the fourth differs
 *                 from the third, both in size */
struct finding finding_from(const struct works *works, const json_t *rule);

/* Whether any job of the paper, which is the name of a folder, is wanted. */
bool paper_is_wanted(const struct works *works, const char *paper, const char *only);

/* Draws every plot that a result has, into its directory, and the listed ones of the papers that
 * are wanted into `figures`, where none of these stays that could not be drawn. */
bool write_plots(const struct works *works, const json_t *data, const char *only,
                 const char *figures);

/* The document that an earlier run wrote, which the caller frees; NULL when there is none. Its
 * sections stand between marks that kept_begin and kept_end write. */
char *kept_read(const char *path);
void kept_begin(FILE *out, const char *section);
void kept_end(FILE *out);

/* Prints a section, or the row of a job in the table of runs, as it is in `kept` (NULL: nothing).
 * False when it has none. *cpu_s: the processor time that the row tells. */
bool kept_print(FILE *out, const char *kept, const char *section);
bool kept_print_row(FILE *out, const char *kept, const char *job, double *cpu_s);

/* Sections of the document. kept: rows of jobs that have no result here are taken from it; NULL:
 * such jobs are missing. */
void print_runs(FILE *out, const struct works *works, const char *kept);
void print_values(FILE *out, const struct works *works, const json_t *data, const char *paper);
void print_trends(FILE *out, const struct works *works, const json_t *data, const char *paper);
void print_figures(FILE *out, const json_t *data, const char *paper, const char *figures);
void print_ranking(FILE *out, const struct works *works, const json_t *data);

#endif
