/* The rigid shape that a job describes. */
#ifndef PNEULAB_JOB_GRASP_SHAPE_H
#define PNEULAB_JOB_GRASP_SHAPE_H

#include "solver/job/grasp.h"
#include "solver/rigid/shape.h"

/* Makes the shape, which the caller owns (rigid_shape_destroy). STATUS_OK; STATUS_INVALID or
 * STATUS_GEOMETRY with the pointer into the job, also for an STL file that is not closed;
 * STATUS_NO_MEMORY. */
enum status grasp_shape_create(const struct grasp_shape *spec, struct rigid_shape **shape,
                               struct error *error);

/* Where the object is at its position, shifted by `shift` (m). */
struct rigid_pose grasp_pose(const struct grasp_object *object, const double shift[3]);

#endif
