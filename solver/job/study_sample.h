/* Inside of the reading of a study: the samplings that spread their members over ranges. */
#ifndef PNEULAB_JOB_STUDY_SAMPLE_H
#define PNEULAB_JOB_STUDY_SAMPLE_H

#include "solver/job/reader.h"

/* Gives every parameter of such a study "values": one for each member, within its range ("from",
 * "to", "scale") or out of those it had; of other samplings the size and the parameters are
 * checked. Of a sequence the members that break a constraint are left out, and the next points take
 * their places. To be called once, before study_expand. STATUS_OK; STATUS_INVALID with the pointer
 * to what has to change, also when hardly a point meets the constraints; STATUS_TOO_LARGE;
 * STATUS_NO_MEMORY. */
enum status study_sample(const struct reader *reader, json_t *document);

#endif
