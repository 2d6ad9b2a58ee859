/* Mesh of a pneu-net: one row of chambers in series over a bottom layer. */
#ifndef PNEULAB_MESH_PNEUNET_H
#define PNEULAB_MESH_PNEUNET_H

#include "solver/job/spec.h"
#include "solver/mesh/mesh.h"

/* Elements through each feature, as chosen by the job or, where it is silent, by its accuracy
 * tier: sizes relative to the height at the base. Never 0. */
struct mesh_spec pneunet_resolution(const struct job_spec *spec);

/* Builds the mesh of spec->pneunet: half of it (y >= 0) when spec->half_model.
 * The frame of each section is carried by the nodes of the bottom layer; the stations are the
 * starts of the chambers on the bottom centreline, and the tip.
 * Returns STATUS_OK, STATUS_TOO_LARGE or STATUS_NO_MEMORY; on success the caller releases
 * *mesh. */
enum status pneunet_mesh(const struct job_spec *spec, struct mesh *mesh, struct error *error);

/* Height of the undeformed body at x (m), after tapers of top and bottom. */
double pneunet_height(const struct pneunet_spec *p, double x);

#endif
