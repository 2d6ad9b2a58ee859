/* The samples of a hybrid model, or of cells in continuous motion, for their plots. */
#ifndef PNEULAB_PLOT_HYBRID_H
#define PNEULAB_PLOT_HYBRID_H

#include "server/plot/bundle.h"
#include "server/plot/plot.h"

enum { HYBRID_MODES = 8, HYBRID_SPANS = 60 };

enum hybrid_quantity {
  HYBRID_TIME,
  HYBRID_SET_POINT,
  HYBRID_H,
  HYBRID_VELOCITY,
  HYBRID_PRESSURE,
  HYBRID_QUANTITIES
};

/* Samples `first` to `end` - 1, all in one mode and without a switch between them. */
struct hybrid_span {
  size_t first, end;
  size_t mode;          /* of hybrid.mode */
  bool named;           /* the first span of its mode */
  struct point ends[2]; /* x: its times */
};

struct hybrid {
  size_t count;
  double *value[HYBRID_QUANTITIES]; /* each `count`, finite */
  size_t mode_count;
  const char *mode[HYBRID_MODES]; /* names, borrowed from the result */
  struct hybrid_span *span;
  size_t span_count;
};

/* Reads the samples that are complete; what has more than HYBRID_MODES modes counts as the last of
 * them. The mode of cells in motion is how many of them are stretched. The caller releases *hybrid
 * in any case. STATUS_NO_MEMORY. */
enum status hybrid_read(const json_t *result, struct hybrid *hybrid, struct error *error);
void hybrid_release(struct hybrid *hybrid);

/* The curve y over x of the samples first to end - 1, without points that add nothing at the size
 * of a picture; *points has *count of them, the caller frees it. STATUS_NO_MEMORY. */
enum status hybrid_curve(const struct hybrid *hybrid, enum hybrid_quantity x,
                         enum hybrid_quantity y, size_t first, size_t end, struct point **points,
                         size_t *count, struct error *error);

/* A height that every axis which shows the quantity ends below, so that lines up to it on both
 * sides of zero cross the picture, and few enough pixels for cairo. */
double hybrid_reach(const struct hybrid *hybrid, enum hybrid_quantity quantity);

/* Adds what lies behind curves over time: a band for each stay in a mode. Many stays make no
 * picture: then there are none. named: they are in the legend. STATUS_NO_MEMORY. */
enum status hybrid_add_bands(const struct hybrid *hybrid, bool named, struct bundle *bundle,
                             struct error *error);

/* Adds an upright line for each switch, `reach` high on both sides of zero; none when there are too
 * many. name: in the legend, or NULL. STATUS_NO_MEMORY. */
enum status hybrid_add_switches(const json_t *result, double reach, const char *name,
                                struct bundle *bundle, struct error *error);

/* Adds the curve of a quantity over time in the look of `like`. STATUS_NO_MEMORY. */
enum status hybrid_add_curve(const struct hybrid *hybrid, enum hybrid_quantity quantity,
                             struct chart_series like, struct bundle *bundle, struct error *error);

/* Colours of a mode: of its curves, and as a band behind them. */
struct colour hybrid_colour(size_t mode);
struct colour hybrid_band(size_t mode);

#endif
