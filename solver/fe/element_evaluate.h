/* element_evaluate for the instruction sets it is compiled for. */
#ifndef PNEULAB_FE_ELEMENT_EVALUATE_H
#define PNEULAB_FE_ELEMENT_EVALUATE_H

#include "solver/fe/element.h"

/* What element_evaluate is given. */
struct element_arguments {
  const struct element_geometry *geometry;
  const struct material_spec *material;
  double bulk_modulus;
  const struct element_viscosity *viscosity; /* may be NULL */
  double (*u)[HEX27_STRIDE];
  const double *p;
  double *residual, *packed;
  struct element_internal *internal;
};

/* With vectors of 512, 256 and 128 bits. */
bool element_evaluate_512(const struct element_arguments *arguments);
bool element_evaluate_256(const struct element_arguments *arguments);
bool element_evaluate_128(const struct element_arguments *arguments);

#endif
