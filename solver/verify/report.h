/* What a case of the verification reports, and the tools that all cases share. */
#ifndef PNEULAB_VERIFY_REPORT_H
#define PNEULAB_VERIFY_REPORT_H

#include <stdio.h>
#include "solver/verify/body.h"
#include "solver/verify/newton.h"

enum { VERIFY_ROWS = 24, VERIFY_POINTS = 96, VERIFY_METRICS = 12 };

/* One mesh (or one step of a difference): a row of the convergence table. */
struct verify_row {
  char label[64];  /* the mesh in words: "4 x 3" */
  double size;     /* abscissa of the convergence plot: element size, step */
  int unknowns;    /* 0: no system was solved */
  double computed; /* in the unit of the case */
  double error;    /* fraction */
  double other;    /* error in the second norm of the case, fraction; NaN without one */
};

/* One point of a curve on the finest mesh. */
struct verify_point {
  double x, computed, reference;
};

/* One more figure; the name ends in its unit. The string is not copied. */
struct verify_metric {
  const char *name;
  double value;
};

struct verify_report {
  double computed, reference, error; /* on the finest mesh; error is a fraction */
  struct verify_row row[VERIFY_ROWS];
  int row_count;
  struct verify_point point[VERIFY_POINTS];
  int point_count;
  struct verify_metric metric[VERIFY_METRICS];
  int metric_count;
  int unknowns, elements; /* of the largest system */
  int factorizations, newton_iterations;
};

/* What a case gets to run with, and where it writes to. */
struct verify_run {
  int refinement;
  struct newton_control control; /* its tolerance is the case's to set */
  FILE *events;                  /* progress, or NULL */
  struct verify_report report;
};

/* Sets the result of the finest mesh. The error is |computed - reference| / scale; scale 0 means
 * |reference|. */
void verify_result(struct verify_run *run, double computed, double reference, double scale);

/* Adds a row of the convergence table and reports progress. model may be NULL. */
void verify_row(struct verify_run *run, double size, double computed, double error,
                const struct fe_model *model, const char *format, ...)
    __attribute__((format(printf, 6, 7)));

/* The error of the last row in the second norm of the case. */
void verify_row_other(struct verify_run *run, double error);

/* Forgets the points of a coarser mesh. */
void verify_points_clear(struct verify_run *run);
/* reference is NaN where there is none. */
void verify_point(struct verify_run *run, double x, double computed, double reference);
/* Largest error of the points, each relative to its own reference. */
double verify_points_worst(const struct verify_run *run);

void verify_metric(struct verify_run *run, const char *name, double value);

/* Least-squares slope of log(error) over log(size) of rows first .. last - 1. */
double verify_order(const struct verify_run *run, int first, int last);

/* Rows of the relative error of a central difference with the steps first / 2^k, and as the
 * result the observed order over those steps that stand clear of round-off; the reference is 2. */
void verify_difference(struct verify_run *run, double (*error)(void *context, double h),
                       void *context, double first);
/* |(b - a) / 2h - exact| / |exact| of vectors of length n. */
double verify_difference_error(int n, const double *a, const double *b, double h,
                               const double *exact);

/* Mesh, model and state of one solve. */
struct verify_body {
  struct mesh mesh;
  struct fe_model *model;
  struct fe_state state;
};

/* Finishes a body whose mesh is built and held: model and state. On failure *error is filled;
 * close it all the same. */
enum status verify_body_open(struct verify_body *body, const struct material_spec *material,
                             bool contact, struct error *error);
/* Adds the body's statistics to the report and releases it. */
void verify_body_close(struct verify_run *run, struct verify_body *body);

/* Fills *error for a solve that failed; returns its status. */
enum status verify_failed(enum status status, const char *what, struct error *error);

#endif
