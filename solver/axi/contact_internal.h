/* Shared by the files of the contact. */
#ifndef PNEULAB_AXI_CONTACT_INTERNAL_H
#define PNEULAB_AXI_CONTACT_INTERNAL_H

#include "solver/axi/contact.h"

static const double contact_point[AXI_EDGE_POINTS] = {-0.774596669241483377, 0,
                                                      0.774596669241483377};
static const double contact_weight[AXI_EDGE_POINTS] = {5.0 / 9, 8.0 / 9, 5.0 / 9};

/* A current edge, or its image one period up or down. */
struct axi_contact_box {
  double y[AXI_EDGE_NODES][2];
  double low;       /* least z of its circle */
  double radius;    /* of a circle about the middle node with all of the edge */
  double normal[2]; /* of the chord, out of the body, not of unit length */
  int edge, shift;
};

#endif
