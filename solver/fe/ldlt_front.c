#include "solver/fe/lanes.h"
#include "solver/fe/ldlt_front_internal.h"

size_t ldlt_front_work(int rows, int columns) {
  size_t padded = (size_t)rows - (size_t)columns + ROWS;
  return 2 * (padded * (size_t)columns + ((size_t)columns + ROWS) * PANEL);
}

int ldlt_front_eliminate(const struct ldlt_dense *front) {
  switch (lanes_width()) {
  case 512:
    return ldlt_front_eliminate_512(front);
  case 256:
    return ldlt_front_eliminate_256(front);
  default:
    return ldlt_front_eliminate_128(front);
  }
}
