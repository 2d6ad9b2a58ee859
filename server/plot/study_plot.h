/* Pictures of studies, as PNG, from tables and analyses that others made. Every function is safe to
 * call from several threads at once. */
#ifndef PNEULAB_PLOT_STUDY_PLOT_H
#define PNEULAB_PLOT_STUDY_PLOT_H

#include <stdbool.h>
#include <stddef.h>
#include "server/plot/sheet.h"
#include "server/study/table.h"
#include "solver/explore/importance.h"

/* Designs that no other one beats in two or three metrics. */
struct study_pareto {
  size_t count;            /* objectives: 2 or 3, of more the first three are drawn */
  const size_t *metric;    /* [count]: columns of the table */
  const bool *maximise;    /* [count] */
  const int *front;        /* [members]: 1 for the front, 0 for rows that do not count */
  double hypervolume;      /* NaN: not known */
  const double *reference; /* [count]: the corner it is measured from; NULL: not known */
};

/* Shares of the variance of a metric. */
struct study_importance {
  size_t metric;                  /* column of the table */
  const struct importance *share; /* [parameters of the table] */
  const char *method;             /* said in the subtitle: "surrogate, R² 0.98"; may be NULL */
};

/* What a metric is on average at values of one parameter. */
struct study_effect {
  size_t parameter;         /* column */
  size_t count;             /* of points; of a categorical parameter one a word */
  const double *x;          /* [count] as in the table */
  const double *mean;       /* [count], unit of the metric */
  const double *low, *high; /* [count]: ends of the band; NULL: none */
};

struct study_effects {
  size_t metric;
  const struct study_effect *effect; /* the most important first */
  size_t count;
  const char *method; /* said in the subtitle; may be NULL */
  const char *band;   /* what the band is: "95 % of the surrogate"; may be NULL */
};

/* A metric over two parameters, all others being fixed. */
struct study_slice {
  size_t metric, x, y;     /* columns */
  size_t columns, rows;    /* 2 to 400 each */
  const double *x_value;   /* [columns] ascending, as in the table */
  const double *y_value;   /* [rows] ascending */
  const double *mean;      /* [rows * columns], row by row */
  const double *deviation; /* the same, or NULL */
  const char *fixed;       /* "gap 2 mm, wall 1.5 mm"; may be NULL */
  const char *method;      /* may be NULL */
};

/* Solved values and what the surrogate says of them when it does not know them. */
struct study_left_out {
  size_t metric;
  size_t count;
  const double *known, *predicted, *deviation; /* [count], unit of the metric */
  double r2, within;                           /* part within 1.96 deviations; NaN: not known */
};

/* The best designs and the parts of their scores. */
struct study_ranking {
  size_t count, parts;
  const char *const *name;      /* [count], best first */
  const double *part;           /* [count * parts]: sum is the score; all of one sign */
  const char *const *part_name; /* [parts] */
  const char *score;            /* label of the axis: "Score" */
  size_t ranked;                /* designs that have a score */
};

/* The body of one member in its plane of bending. */
struct study_shape {
  size_t row;         /* of the table */
  size_t count;       /* points of the centreline; 0: not known */
  const double *line; /* [2 * count]: along and across the body, mm */
};

/* The values of an optimisation one after the other. */
struct study_history {
  const char *label;    /* of the values, with their unit */
  const double *value;  /* [members]; NaN: none */
  const bool *feasible; /* [members]; NULL: all are */
  bool maximise;
  double target; /* what is to be reached, NaN for none */
};

/* What there is to draw. The caller keeps everything alive; NULL where an analysis was not made. */
struct study_plot_input {
  const struct study_table *table;
  const struct study_pareto *pareto;
  const struct study_importance *importance;
  const struct study_effects *effects;
  const struct study_slice *slice;
  const struct study_left_out *left_out;
  const struct study_ranking *ranking;
  const struct study_history *history;
  const struct study_shape *shapes; /* of members that study_plot_cells names */
  size_t shape_count;
};

/* What is asked for, by keys of columns; NULL: chosen by the plot. */
struct study_plot_options {
  const char *metric, *x, *y;
  const char *colour;  /* what dots and lines are coloured by */
  const char *columns; /* axes of "parallel" and "scatter": keys separated by commas */
};

/* Names of all plots of studies, NULL-terminated, in static storage. */
const char *const *study_plot_names(void);

/* Most cells of "shapes" in one direction. */
enum { STUDY_CELLS = 7 };

/* The members that "shapes" shows: row[y * columns + x] is a row of the table or SIZE_MAX for an
 * empty cell, the smallest x and y first. x, y: columns of the parameters, found from the options.
 * With more values than STUDY_CELLS, or parameters that vary freely, the nearest members to an even
 * grid, each once. STATUS_NOT_FOUND when the study has no two parameters, or has no such column. */
struct study_cells {
  size_t x, y, columns, rows;
  size_t row[STUDY_CELLS * STUDY_CELLS];
};
enum status study_plot_cells(const struct study_table *table,
                             const struct study_plot_options *options, struct study_cells *cells,
                             struct error *error);

/* Draws `plot`. On success *png (allocated with malloc, the caller frees it) holds *size bytes.
 * A study without members that count gives a picture that says so.
 * Errors: STATUS_NOT_FOUND (no such plot, no such column, or an analysis that the plot needs is
 * NULL: the message says which), STATUS_INVALID (size), STATUS_NO_MEMORY. */
enum status study_plot_render(const char *plot, const struct study_plot_input *input,
                              const struct study_plot_options *options,
                              const struct plot_sheet *sheet, unsigned char **png, size_t *size,
                              struct error *error);

#endif
