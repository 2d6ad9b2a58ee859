/* The block `sensitivity` of the result: derivatives of metrics and samples. */
#ifndef PNEULAB_POST_RESULT_SENSITIVITY_H
#define PNEULAB_POST_RESULT_SENSITIVITY_H

#include <jansson.h>
#include "solver/fe/path.h"
#include "solver/job/spec.h"

struct result_sensitivity;

/* Prepares the derivatives that spec->sensitivity asks for, at states of `model`. Both must outlive
 * the result, which the caller owns. STATUS_OK or the failures of model_create and actuator_mesh. */
enum status result_sensitivity_create(const struct job_spec *spec, const struct fe_model *model,
                                      struct result_sensitivity **out, struct error *error);
void result_sensitivity_destroy(struct result_sensitivity *r);

/* Differentiates a recorded state; others are passed over. STATUS_OK or NO_MEMORY: a state whose
 * derivatives cannot be found gets none. */
enum status result_sensitivity_add(struct result_sensitivity *r, const struct path_point *point);

/* The block, a new reference: see schema/result.schema.json. NULL when memory runs out. */
json_t *result_sensitivity_block(const struct result_sensitivity *r);

/* Sets the block in a result document and adds to its warnings what has no derivatives. STATUS_OK
 * or NO_MEMORY. */
enum status result_sensitivity_store(const struct result_sensitivity *r, json_t *document);

#endif
