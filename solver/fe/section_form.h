/* Displacements of a body with axial sections, seen from the sections.
 *
 * The form holds the rotation of every section, the change of the step from one section's centre
 * to the next in the frame of the first, and what every node has moved within its section's frame.
 * None of it changes under rigid motion, so that forms of bodies with other dimensions can be
 * exchanged, and forms can be extrapolated over large rotations. */
#ifndef PNEULAB_FE_SECTION_FORM_H
#define PNEULAB_FE_SECTION_FORM_H

#include "solver/mesh/mesh.h"

struct section_form {
  double *rotation; /* section_count x 9 */
  double *step;     /* section_count x 3, m: from the section before; of the first its own motion */
  double *length;   /* section_count: undeformed distance from the section before, m */
  double *local;    /* node_count x 3, m */
};

/* STATUS_OK or STATUS_NO_MEMORY. Released by section_form_release. */
enum status section_form_create(const struct mesh *mesh, struct section_form *form);
void section_form_release(struct section_form *form);

/* Fills the form from displacements u (node_count x 3, m). STATUS_OK or STATUS_NO_MEMORY. */
enum status section_form_take(const struct mesh *mesh, const double *u, struct section_form *form);

/* The displacements of a form, which may be that of a body with other dimensions: the changes of
 * the steps are scaled with their lengths. Held displacements are zero. */
enum status section_form_give(const struct mesh *mesh, const struct section_form *form, double *u);

/* form <- form + share (to - from), rotations by their rotation vectors. */
void section_form_extrapolate(const struct mesh *mesh, struct section_form *form, double share,
                              const struct section_form *from, const struct section_form *to);

#endif
