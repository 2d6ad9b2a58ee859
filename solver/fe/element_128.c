/* The element for any processor. */
#define LANES 2
#include "solver/fe/element_kernel.h"

bool element_evaluate_128(const struct element_arguments *arguments) {
  return evaluate_either(arguments);
}
