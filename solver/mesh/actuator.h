/* Meshes of the bodies that jobs describe, whatever their family. */
#ifndef PNEULAB_MESH_ACTUATOR_H
#define PNEULAB_MESH_ACTUATOR_H

#include "solver/job/spec.h"
#include "solver/mesh/mesh.h"

/* Builds the mesh of the job's actuator, half of it (y >= 0) when spec->half_model.
 * STATUS_OK, STATUS_TOO_LARGE or STATUS_NO_MEMORY; on success the caller releases *mesh. */
enum status actuator_mesh(const struct job_spec *spec, struct mesh *mesh, struct error *error);

/* The same on a finer mesh, in which that of actuator_mesh is nested, for estimates of its error.
 */
enum status actuator_mesh_finer(const struct job_spec *spec, struct mesh *mesh,
                                struct error *error);

/* Length of the undeformed body along x, m. */
double actuator_length(const struct job_spec *spec);

#endif
