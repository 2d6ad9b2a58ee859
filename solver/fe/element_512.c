/* The element for AVX-512. */
#define LANES 8
#include "solver/fe/element_kernel.h"

LANES_TARGET_512 bool element_evaluate_512(const struct element_arguments *arguments) {
  return evaluate_either(arguments);
}
