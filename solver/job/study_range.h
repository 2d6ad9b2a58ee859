/* Inside of the reading of a study: what a parameter may be. */
#ifndef PNEULAB_JOB_STUDY_RANGE_H
#define PNEULAB_JOB_STUDY_RANGE_H

#include "solver/job/reader.h"

struct study_range {
  const json_t *values; /* the choices, or NULL: from .. to */
  double from, to;
  bool whole, logarithmic;
  const char *unit; /* with its space, "" for numbers; into the document */
};

/* Reads the range of the parameter `index`: its "values", or "from", "to" and "scale". It refers to
 * the document. STATUS_OK, or STATUS_INVALID. */
enum status study_range_read(const struct reader *reader, size_t index, const json_t *parameter,
                             struct study_range *range);

/* The value at u of [0, 1], a new reference, with so many significant digits. */
json_t *study_range_value(const struct study_range *range, double u, int digits);

/* The number of "1.5 mm" and, in *unit, what follows it. False for what is no such thing. */
bool study_range_split(const json_t *value, double *number, const char **unit);

/* STATUS_INVALID with that sentence for the parameter, or for its member `key` unless NULL. */
enum status study_range_refuse(const struct reader *reader, size_t parameter, const char *key,
                               const char *sentence);

#endif
