/* Patch test: a distorted mesh reproduces every homogeneous deformation, for every material. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/vec3.h"
#include "solver/verify/cases.h"
#include "solver/verify/materials.h"

/* Deformation gradients: small, finite stretch with shear, finite with a large rotation. */
static const double deformations[3][9] = {
    {1 + 1e-4, 2e-4, -1e-4, 0, 1 - 2e-4, 3e-4, 1e-4, 0, 1 + 2e-4},
    {1.4, 0.5, 0.1, -0.2, 0.9, 0.3, 0.1, -0.1, 0.7},
    {0.1, -1.3, 0.2, 0.9, 0.2, -0.1, 0.3, 0.1, 0.9},
};

/* Every node but those of the flat sides is moved, middle nodes too. */
static void distorted(const void *context, int block, const double s[3], double x[3]) {
  const int *cells = context;
  (void)block;
  unsigned seed = (unsigned)(1 + lrint(1000 * s[0]) * 7919 + lrint(1000 * s[1]) * 104729 +
                             lrint(1000 * s[2]) * 1299709);
  for (int i = 0; i < 5; i++) {
    body_random(&seed);
  }
  for (int d = 0; d < 3; d++) {
    bool inside = s[d] > 0 && s[d] < 1;
    x[d] = s[d] * cells[d] + (inside ? 0.06 * body_random(&seed) : 0);
  }
}

static enum status build(const int cells[3], struct mesh *mesh) {
  struct body body = {
      .blocks = 1, .cells = {cells[0], cells[1], cells[2]}, .map = distorted, .context = cells};
  enum status status = body_build(&body, mesh);
  unsigned char *boundary = status == STATUS_OK ? calloc((size_t)mesh->node_count, 1) : NULL;
  if (!boundary) {
    return STATUS_NO_MEMORY;
  }
  body_mark_boundary(mesh, boundary);
  for (int n = 0; n < mesh->node_count; n++) {
    memset(mesh->fixed + 3 * n, boundary[n], 3);
  }
  free(boundary);
  return STATUS_OK;
}

static void exact_displacement(const double f[9], const double x[3], double u[3]) {
  mat3_apply(f, x, u);
  for (int i = 0; i < 3; i++) {
    u[i] -= x[i];
  }
}

/* Holds the boundary at the homogeneous deformation and disturbs the interior, from which the
 * solution has to come back. Returns the largest displacement. */
static double disturb(const struct mesh *mesh, const double f[9], struct fe_state *state) {
  double size = 0;
  unsigned seed = 5;
  for (int n = 0; n < mesh->node_count; n++) {
    exact_displacement(f, mesh->x + 3 * n, state->u + 3 * n);
    for (int i = 0; i < 3; i++) {
      size = fmax(size, fabs(state->u[3 * n + i]));
    }
  }
  for (int d = 0; d < 3 * mesh->node_count; d++) {
    state->u[d] += mesh->fixed[d] ? 0 : 0.03 * fmin(size, 1) * body_random(&seed);
  }
  return size;
}

/* Largest error of a displacement, in units of the largest displacement. */
static enum status solve_patch(struct verify_run *run, const int cells[3],
                               const struct material_spec *material, const double f[9],
                               double *worst, int *unknowns, struct error *error) {
  struct verify_body b = {.model = NULL};
  enum status status = build(cells, &b.mesh);
  if (status == STATUS_OK) {
    status = verify_body_open(&b, material, false, error);
  }
  if (status == STATUS_OK) {
    double size = disturb(&b.mesh, f, &b.state), exact[3], most = 0;
    struct fe_load none = {0};
    status = newton_solve(b.model, &none, &b.state, &run->control);
    for (int n = 0; n < b.mesh.node_count; n++) {
      exact_displacement(f, b.mesh.x + 3 * n, exact);
      for (int i = 0; i < 3; i++) {
        most = fmax(most, fabs(b.state.u[3 * n + i] - exact[i]));
      }
    }
    *worst = fmax(*worst, most / size);
    *unknowns = b.model->dof_count;
    if (status != STATUS_OK) {
      verify_failed(status, material->name, error);
    }
  }
  verify_body_close(run, &b);
  return status;
}

enum status case_patch(struct verify_run *run, struct error *error) {
  run->control.tolerance = 1e-12;
  for (int level = 1; level <= run->refinement; level++) {
    const int cells[3] = {level + 1, 2, level < 3 ? 2 : 3};
    double worst = 0;
    int unknowns = 0;
    for (int k = 0; k < VERIFY_MATERIALS * 3; k++) {
      enum status status = solve_patch(run, cells, &verify_materials[k / 3], deformations[k % 3],
                                       &worst, &unknowns, error);
      if (status != STATUS_OK) {
        return status;
      }
    }
    verify_result(run, worst, 0, 1);
    verify_row(run, 1.0 / (level + 1), worst, worst, NULL, "%d x %d x %d, distorted", cells[0],
               cells[1], cells[2]);
    run->report.row[run->report.row_count - 1].unknowns = unknowns;
  }
  return STATUS_OK;
}
