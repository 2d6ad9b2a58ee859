/* Mesh of a pneu-net: one row of chambers in series over a bottom layer. */
#ifndef PNEULAB_MESH_PNEUNET_H
#define PNEULAB_MESH_PNEUNET_H

#include "solver/job/spec.h"
#include "solver/mesh/grid.h"

/* Cells through each feature of the body; those that it does not have are left unused. */
struct pneunet_cells {
  /* along the body */
  struct grid_division gap_wall, cavity, gap;
  /* from the middle to a side face: half the channel, the rest of the stem, half a cavity, wall */
  struct grid_division channel, stem, half_width, side_wall;
  /* from the bottom up: suckers; without a channel bottom, else below, duct, cover; and so on */
  struct grid_division sucker, bottom, below, duct, cover, slit, floor, height, top;
};

/* Cells as chosen by the job (equal ones) or, where it is silent, by its accuracy tier. */
struct pneunet_cells pneunet_resolution(const struct job_spec *spec);

/* Splits the cells of a job for a finer mesh that tells the error of the one they make: where
 * measurement finds most of it, in the plane of bending next to the axial walls. */
void pneunet_refine(const struct job_spec *spec, struct pneunet_cells *cells);

/* As pneunet_mesh, with cells of the caller's choice. */
enum status pneunet_mesh_cells(const struct job_spec *spec, const struct pneunet_cells *cells,
                               struct mesh *mesh, struct error *error);

/* Builds the mesh of spec->pneunet: half of it (y >= 0) when spec->half_model.
 * The frame of each section is carried by the nodes of the bottom layer; the stations are the
 * starts of the chambers on the bottom centreline, and the tip.
 * Returns STATUS_OK, STATUS_TOO_LARGE or STATUS_NO_MEMORY; on success the caller releases
 * *mesh. */
enum status pneunet_mesh(const struct job_spec *spec, struct mesh *mesh, struct error *error);

/* Whether a chamber of configuration C is among them. */
bool pneunet_detached(const struct pneunet_spec *p);

/* Height of the undeformed body at x (m), after tapers of top and bottom. */
double pneunet_height(const struct pneunet_spec *p, double x);

/* z (m) of the top of its bottom layer there. */
double pneunet_bottom(const struct pneunet_spec *p, double x);

#endif
