/* Contact pressure brought from the contact points to the nodes. */
#ifndef PNEULAB_POST_CONTACT_FIELD_H
#define PNEULAB_POST_CONTACT_FIELD_H

#include "solver/fe/model.h"

/* Writes to pressure[node_count] the contact pressure (Pa of the deformed face that carries the
 * points) at every node: the mean, weighted by area, of the tractions at the contact points
 * around it, on the face that carries them and on the one that they look at; the pressure of
 * every plane comes on top. 0 at nodes without any. Reads the tractions of the last evaluation,
 * which should be at the displacements u (m, node_count x 3). STATUS_NO_MEMORY when there is
 * none. */
enum status contact_field(const struct contact *contact, int node_count, const double *u,
                          double *pressure);

#endif
