/* Fields at the nodes in one state of the body, and the VTU files that show them. */
#ifndef PNEULAB_POST_FIELDS_H
#define PNEULAB_POST_FIELDS_H

#include <stdint.h>
#include "solver/post/stress.h"
#include "solver/post/vtu.h"

/* Everything over the nodes of the mesh. */
struct fields {
  const double *u;                     /* displacement, m; not owned */
  double *stretch;                     /* largest principal stretch */
  double (*stress)[STRESS_COMPONENTS]; /* Cauchy stress, Pa */
  double *contact;                     /* contact pressure, Pa */
};

/* Makes room for the fields of a mesh. STATUS_NO_MEMORY when there is none. The caller releases
 * *fields. */
enum status fields_create(const struct mesh *mesh, struct fields *fields);
void fields_release(struct fields *fields);

/* Fills stretch and stress at the state, which *fields then refers to; the contact pressure is
 * the caller's. STATUS_NO_MEMORY when there is none. */
enum status fields_evaluate(const struct fe_model *model, const struct fe_state *state,
                            struct fields *fields);

/* A part of the body to be shown, of cells of one type. */
struct fields_view {
  int point_count, cell_count;
  const int *node;               /* node of each point; NULL: point n is node n */
  const unsigned char *mirrored; /* 1 for a point of the half that was not modelled; NULL: none */
  int cell_type;                 /* VTU_QUAD9 or VTU_HEX27 */
  const int32_t *connectivity;   /* of the points, in VTK's order */
};

/* Writes the deformed view with displacement, stretch, stress (components, von Mises, largest
 * principal, hydrostatic pressure) and contact pressure, in mm and kPa. Failures of writing are
 * left to the caller's ferror; STATUS_NO_MEMORY. */
enum status fields_write(FILE *file, const struct mesh *mesh, const struct fields_view *view,
                         const struct fields *fields);

#endif
