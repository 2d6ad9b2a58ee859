/* The vectors of solver/base. */
#ifndef PNEULAB_FE_VEC3_H
#define PNEULAB_FE_VEC3_H

#include "solver/base/vec3.h"

#endif
