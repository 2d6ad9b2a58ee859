/* Any bytes as an STL file, and its triangles as a body: one whose distances are finite and whose
 * normals have a length, or a sentence, never worse. */
#include <math.h>
#include <stdlib.h>

#include "solver/rigid/shape.h"
#include "solver/rigid/stl.h"
#include "tests/fuzz/fuzz.h"

static void check_error(const struct error *error, enum status status) {
  if (error->status != status || error->message[0] == '\0' ||
      (status != STATUS_INVALID && status != STATUS_TOO_LARGE)) {
    abort();
  }
}

/* Distances at points through and around the body's box. */
static void ask(const struct rigid_shape *shape) {
  double low[3], high[3];
  struct rigid_mass mass;
  rigid_shape_bounds(shape, low, high);
  if (!rigid_shape_mass(shape, &mass) || !isfinite(mass.volume)) {
    abort();
  }
  for (int n = 0; n < 27; n++) {
    struct rigid_nearest at;
    double x[3];
    for (int i = 0, rest = n; i < 3; i++, rest /= 3) {
      x[i] = low[i] + (0.51 * (rest % 3) - 0.02) * (high[i] - low[i]);
    }
    if (!rigid_shape_nearest(shape, x, INFINITY, &at) || !isfinite(at.distance)) {
      abort();
    }
    double square = 0;
    for (int i = 0; i < 3; i++) {
      square += at.normal[i] * at.normal[i];
      for (int j = 0; j < 3; j++) {
        if (!isfinite(at.curvature[i][j])) {
          abort();
        }
      }
    }
    if (!(fabs(square - 1) < 1e-6)) {
      abort();
    }
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  struct stl stl;
  struct error error = {.status = STATUS_OK};
  enum status status = stl_read(data, size, &stl, &error);
  if (status != STATUS_OK) {
    check_error(&error, status);
    return 0;
  }
  for (int i = 0; i < 9 * stl.count; i++) {
    if (!isfinite(stl.corner[i])) {
      abort();
    }
  }
  for (int k = 0; k < 2; k++) {
    struct rigid_shape *shape = NULL;
    status = rigid_shape_create_surface(&stl, 1e-3, k ? RIGID_CREASE : 0, &shape, &error);
    if (status == STATUS_OK) {
      ask(shape);
    } else {
      check_error(&error, status);
    }
    rigid_shape_destroy(shape);
  }
  stl_release(&stl);
  return 0;
}
