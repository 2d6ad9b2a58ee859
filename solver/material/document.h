/* What the result documents of the material jobs share. */
#ifndef PNEULAB_MATERIAL_DOCUMENT_H
#define PNEULAB_MATERIAL_DOCUMENT_H

#include <jansson.h>
#include "solver/job/spec.h"

/* The parts of a result, each a new reference; document_make takes them over in any case. */
struct document_parts {
  json_t *metrics, *samples, *warnings;
  int iterations;
  double wall_s, cpu_s; /* clocks when the work began */
};

/* The result document of a job of this kind ("fit-material", ...), a new reference, or NULL when
 * memory runs out. ending, error: how the work ended; the error only matters when it failed. */
json_t *document_make(const struct job_spec *spec, const char *kind, enum status ending,
                      const struct error *error, struct document_parts *parts);

#endif
