/* Parts of the result document of an identification. */
#ifndef PNEULAB_IDENTIFY_DOCUMENT_H
#define PNEULAB_IDENTIFY_DOCUMENT_H

#include <jansson.h>
#include "solver/identify/outcome.h"

enum { IDENTIFY_SAMPLES_MAX = 500 /* of a trial */ };

/* Each gives a new reference, NULL without memory. With neither mass nor gamma given stiffness and
 * damping are per mass, as their keys say. */
json_t *document_modes(const struct identification *id, const struct outcome *outcome);
json_t *document_transitions(const struct identification *id, const struct outcome *outcome);
json_t *document_trials(const struct identification *id, const struct outcome *outcome);
json_t *document_metrics(const struct identification *id, const struct outcome *outcome);
/* The model as an hlpv job takes it. */
json_t *document_model(const struct identification *id, const struct outcome *outcome);

#endif
