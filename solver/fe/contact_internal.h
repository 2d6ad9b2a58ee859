/* What the parts of the contact share. */
#ifndef PNEULAB_FE_CONTACT_INTERNAL_H
#define PNEULAB_FE_CONTACT_INTERNAL_H

#include "solver/fe/contact.h"

/* The smoothed law of x = g - lambda/eps: traction and its negative derivative. */
double contact_law(double eps, double delta, double x, double *slope);

/* Traction of a point at its gap, with its gain, and the negative derivative to the gap. */
double contact_traction(const struct contact *contact, const struct contact_point *point,
                        double *slope);

/* NULL is allowed. */
void contact_search_release(struct contact_search_data *data);

#endif
