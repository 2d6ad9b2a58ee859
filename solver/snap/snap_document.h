/* The parts of a snap job's result document. */
#ifndef PNEULAB_SNAP_SNAP_DOCUMENT_H
#define PNEULAB_SNAP_SNAP_DOCUMENT_H

#include "solver/snap/calibrate.h"
#include "solver/snap/study.h"

/* Each a new reference. Lengths h are elongations from the compressed state where there is one,
 * else from the natural one. */
json_t *snap_document_metrics(const struct snap_study *study);
json_t *snap_document_paths(const struct snap_study *study);
json_t *snap_document_events(const struct snap_study *study);
json_t *snap_document_held(const struct snap_study *study);
json_t *snap_document_stairs(const struct snap_study *study);
json_t *snap_document_shapes(const struct snap_study *study);
json_t *snap_document_law(const struct snap_study *study);
json_t *snap_document_harmonics(const struct snap_study *study);
json_t *snap_document_warnings(const struct snap_study *study);
json_t *snap_document_calibration(const struct snap_spec *spec,
                                  const struct calibrate_result *result);

#endif
