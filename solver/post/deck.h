/* Export of the solved problem as an input deck for CalculiX (and Abaqus). */
#ifndef PNEULAB_POST_DECK_H
#define PNEULAB_POST_DECK_H

#include <stdbool.h>
#include <stdio.h>
#include "solver/job/spec.h"
#include "solver/mesh/mesh.h"

/* Whether the deck's language has the material: all but Ogden with more than three terms. */
bool deck_knows(const struct material_spec *material);

/* Writes mesh, sets, material, boundary conditions and a static step with the job's pressure
 * and gravity, in N, mm, MPa, t, s. Every 27-node element becomes a 20-node serendipity element
 * (`element_type`, for example "C3D20" or "C3D20R") on the same corner and edge nodes; contact
 * is left out. Sets: nodes NALL, FIXED, SYMMETRY (for half a body) and TIP, the end of the
 * bottom centreline; elements EALL; surfaces CAVITY and OUTER. The deck asks for the
 * displacements of TIP, and for displacements, stresses and strains in frd form. Units of the
 * file are stated in its head. Failures of writing are left to the caller's ferror.
 * STATUS_INVALID for a material that the deck's language lacks, STATUS_NO_MEMORY. */
enum status deck_print(const struct mesh *mesh, const struct job_spec *spec,
                       const char *element_type, FILE *file, struct error *error);

/* deck_print to the file `path`; STATUS_IO when that cannot be written. */
enum status deck_write(const struct mesh *mesh, const struct job_spec *spec,
                       const char *element_type, const char *path, struct error *error);

#endif
