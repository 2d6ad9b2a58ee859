/* The parts of docs/PERFORMANCE.md. Every function prints Markdown, or says what is missing. */
#ifndef PNEULAB_TOOLS_PERFORMANCE_H
#define PNEULAB_TOOLS_PERFORMANCE_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>
#include "tools/figure.h"

enum figures_part {
  FIGURES_SOLVE,
  FIGURES_WARM,
  FIGURES_SENSITIVITY,
  FIGURES_SCALING,
  FIGURES_LINEAR,
  FIGURES_CALCULIX,
  FIGURES_ROBUSTNESS,
  FIGURES_BATCH,
  FIGURES_ERROR,
  FIGURES_REPEAT,
  FIGURES_HYBRID,
  FIGURES_QUEUE,
  FIGURES_COUNT
};

/* Documents of the programs in tests/bench; NULL where a file is missing. */
struct figures {
  json_t *part[FIGURES_COUNT];
};

/* How designs ended. */
struct endings {
  int designs, succeeded, physical; /* physical: stopped at a named limit of the body */
  int hung, crashed;
  double peak_memory_MB; /* the largest */
};
struct endings count_endings(const json_t *document);

/* Whether a design stopped for a reason that lies in the body, not in the solver. */
bool ending_is_physical(const json_t *design);

/* CalculiX's time over ours for our mesh `name`. */
struct comparison {
  double same_mesh;      /* NAN when CalculiX did not finish on it */
  double same_error;     /* with the cheapest CalculiX mesh that is as accurate */
  bool beyond;           /* none was: same_error is a lower bound, from its most accurate one */
  const char *ccx_mesh;  /* that of same_error, NULL when there is none */
  double ours, calculix; /* errors */
};
struct comparison compare_calculix(const json_t *body, const char *name);

/* Sections. */
void print_machine(FILE *out, const struct figures *figures);
void print_summary(FILE *out, const struct figures *figures);
void print_solve(FILE *out, const struct figures *figures);
void print_warm(FILE *out, const struct figures *figures);
void print_sensitivity(FILE *out, const struct figures *figures);
void print_scaling(FILE *out, const struct figures *figures);
void print_linear(FILE *out, const struct figures *figures);
void print_calculix(FILE *out, const struct figures *figures);
void print_robustness(FILE *out, const struct figures *figures);
void print_batch(FILE *out, const struct figures *figures);
void print_error(FILE *out, const struct figures *figures);
void print_repeat(FILE *out, const struct figures *figures);
void print_hybrid(FILE *out, const struct figures *figures);
void print_queue(FILE *out, const struct figures *figures);

/* One value of the points of bench_scaling. */
struct growth {
  double exponent, smallest, largest; /* least squares of logarithms; range of unknowns */
  double factor;                      /* figure = factor * unknowns^exponent */
  int count;
};
struct growth fit_growth(const json_t *scaling, const char *figure);

/* Writes the pictures of the document into a directory; those without figures are left out. False
 * with a message on standard error. */
bool write_plots(const struct figures *figures, const char *directory);

#endif
