/* One material of every law, for cases that do not depend on which. */
#ifndef PNEULAB_VERIFY_MATERIALS_H
#define PNEULAB_VERIFY_MATERIALS_H

#include "solver/job/spec.h"

enum { VERIFY_MATERIALS = 4 };

/* Coefficients in MPa; kappa/mu = 1000. */
extern const struct material_spec verify_materials[VERIFY_MATERIALS];

#endif
