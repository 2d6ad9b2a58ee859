/* The element for AVX2. */
#define LANES 4
#include "solver/fe/element_kernel.h"

LANES_TARGET_256 bool element_evaluate_256(const struct element_arguments *arguments) {
  return evaluate_either(arguments);
}
