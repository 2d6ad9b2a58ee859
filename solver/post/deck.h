/* Export of the solved problem as an input deck for CalculiX (and Abaqus). */
#ifndef PNEULAB_POST_DECK_H
#define PNEULAB_POST_DECK_H

#include "solver/job/spec.h"
#include "solver/mesh/mesh.h"

/* Writes mesh, sets, material, boundary conditions and a static step with the job's pressure
 * and gravity, in N, mm, MPa, t, s. Every 27-node element becomes a 20-node serendipity element
 * (`element_type`, for example "C3D20" or "C3D20R") on the same corner and edge nodes; contact
 * is left out. The deck asks for the displacements of the set TIP, the end of the bottom
 * centreline, and writes frd output. Units of the file are stated in its head.
 * STATUS_INVALID for a material the deck's language lacks, STATUS_IO when writing fails. */
enum status deck_write(const struct mesh *mesh, const struct job_spec *spec,
                       const char *element_type, const char *path, struct error *error);

#endif
