#include "solver/identify/covariance.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Part of the largest eigenvalue of the normal matrix, with columns of length 1, below which a
 * direction is taken for one that the data do not determine. */
static const double null_part = 1e-13;

/* ---- the vector of parameters ------------------------------------------------------------- */

static int add_slot(struct layout *layout, double *slot, double scale, double sign) {
  int index = layout->count++;
  layout->slot[index] = slot;
  layout->scale[index] = scale;
  layout->sign[index] = sign;
  return index;
}

/* The columns of one point. What is at its bound, or not in the data, has none. */
static void add_point(struct identification *id, size_t index, bool bounds, struct layout *layout,
                      int column[POINT_PARAMETERS]) {
  struct point_estimate *estimate = &id->estimate[index];
  double *value = estimate->value;
  double critical = 2.0 * sqrt(value[IDENTIFY_STIFFNESS] * id->mass.value);
  for (int j = 0; j < POINT_PARAMETERS; j++) {
    column[j] = -1;
  }
  column[POINT_STIFFNESS] =
      add_slot(layout, &value[IDENTIFY_STIFFNESS], value[IDENTIFY_STIFFNESS], 1.0);
  if (estimate->damping == DAMPING_FREE || (estimate->damping == DAMPING_BOUND && !bounds)) {
    column[POINT_DAMPING] = add_slot(layout, &value[IDENTIFY_DAMPING],
                                     fmax(value[IDENTIFY_DAMPING], 0.05 * critical), 1.0);
  }
  column[POINT_ALPHA] = add_slot(layout, &value[IDENTIFY_ALPHA], fabs(value[IDENTIFY_ALPHA]), -1.0);
  if (id->point[index].set_point != 0.0) {
    double size = fmax(fabs(value[IDENTIFY_BETA]), 0.1 * fabs(value[IDENTIFY_ALPHA]));
    column[POINT_BETA] = add_slot(layout, &value[IDENTIFY_BETA], size, 0.0);
  }
}

static enum status create(struct identification *id, const struct group *group, bool bounds,
                          struct layout *layout, struct error *error) {
  size_t room = group->count * IDENTIFY_COEFFICIENTS + HLPV_MODES_MAX + 2;
  int rest[HLPV_MODES_MAX], mass = -1, gamma = -1;
  *layout = (struct layout){.slot = calloc(room, sizeof *layout->slot),
                            .scale = calloc(room, sizeof *layout->scale),
                            .sign = calloc(room, sizeof *layout->sign),
                            .column = calloc(group->count, sizeof *layout->column)};
  if (!layout->slot || !layout->scale || !layout->sign || !layout->column) {
    layout_release(layout);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the parameters");
  }
  if (id->mass.free) {
    mass = add_slot(layout, &id->mass.value, id->mass.value, 1.0);
  }
  if (id->gamma.free) {
    gamma = add_slot(layout, &id->gamma.value, id->gamma.value, 1.0);
  }
  for (int mode = 0; mode < id->spec->mode_count; mode++) {
    rest[mode] = -1;
  }
  for (size_t i = 0; i < group->count; i++) {
    int mode = id->point[group->first + i].mode, *column = layout->column[i];
    if (id->rest[mode].free && rest[mode] < 0) {
      rest[mode] = add_slot(layout, &id->rest[mode].value, id->steps->range[0], 0.0);
    }
    add_point(id, group->first + i, bounds, layout, column);
    column[POINT_REST] = rest[mode];
    column[POINT_MASS] = mass;
    column[POINT_GAMMA] = gamma;
  }
  return STATUS_OK;
}

enum status layout_create(struct identification *id, const struct group *group,
                          struct layout *layout, struct error *error) {
  return create(id, group, true, layout, error);
}

void layout_release(struct layout *layout) {
  free(layout->slot);
  free(layout->scale);
  free(layout->sign);
  free(layout->column);
  *layout = (struct layout){.count = 0};
}

/* ---- the Jacobian ------------------------------------------------------------------------- */

void layout_multiply(const struct layout *layout, const struct identification *id,
                     const struct group *group, bool transposed, const double *u, double *v) {
  size_t row = 0;
  for (size_t i = 0; i < group->count; i++) {
    const struct point *point = &id->point[group->first + i];
    const int *column = layout->column[i];
    for (size_t r = 0; r < point->rows; r++, row++) {
      const double *line = point->jacobian + r * POINT_PARAMETERS;
      for (int j = 0; j < POINT_PARAMETERS; j++) {
        int c = column[j];
        if (c >= 0 && transposed) {
          v[c] -= line[j] * layout->scale[c] * u[row];
        } else if (c >= 0) {
          v[row] -= line[j] * layout->scale[c] * u[c];
        }
      }
    }
  }
}

/* Normal matrix of one point, in SI units. */
static void point_normal(const struct point *point,
                         double normal[POINT_PARAMETERS][POINT_PARAMETERS]) {
  memset(normal, 0, POINT_PARAMETERS * sizeof *normal);
  for (size_t r = 0; r < point->rows; r++) {
    const double *line = point->jacobian + r * POINT_PARAMETERS;
    for (int j = 0; j < POINT_PARAMETERS; j++) {
      for (int k = 0; k <= j; k++) {
        normal[j][k] += line[j] * line[k];
      }
    }
  }
  for (int j = 0; j < POINT_PARAMETERS; j++) {
    for (int k = 0; k < j; k++) {
      normal[k][j] = normal[j][k];
    }
  }
}

void layout_normal(const struct layout *layout, const struct identification *id,
                   const struct group *group, gsl_matrix *normal) {
  for (size_t i = 0; i < group->count; i++) {
    double own[POINT_PARAMETERS][POINT_PARAMETERS];
    const int *column = layout->column[i];
    point_normal(&id->point[group->first + i], own);
    for (int j = 0; j < POINT_PARAMETERS; j++) {
      for (int k = 0; k < POINT_PARAMETERS; k++) {
        int a = column[j], b = column[k];
        if (a >= 0 && b >= 0 && a >= b) {
          *gsl_matrix_ptr(normal, (size_t)a, (size_t)b) +=
              own[j][k] * layout->scale[a] * layout->scale[b];
        }
      }
    }
  }
}

/* ---- covariance --------------------------------------------------------------------------- */

/* Eigenvalues and vectors of a symmetric matrix whose diagonal has been scaled to 1 (length: its
 * roots before); destroys it. False without memory. */
static bool decompose(gsl_matrix *matrix, double *length, gsl_vector *value, gsl_matrix *vector) {
  size_t n = matrix->size1;
  gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(n);
  for (size_t i = 0; i < n; i++) {
    length[i] = sqrt(gsl_matrix_get(matrix, i, i));
  }
  for (size_t i = 0; i < n; i++) {
    for (size_t j = 0; j <= i; j++) {
      double scale = length[i] * length[j];
      gsl_matrix_set(matrix, i, j, scale > 0.0 ? gsl_matrix_get(matrix, i, j) / scale : 0.0);
      gsl_matrix_set(matrix, j, i, gsl_matrix_get(matrix, i, j));
    }
  }
  bool good = work && gsl_eigen_symmv(matrix, value, vector, work) == GSL_SUCCESS;
  gsl_eigen_symmv_free(work);
  return good;
}

/* covariance = factor * inverse of the normal matrix, in SI units. Parameters with a part in a
 * direction that the data do not determine get an infinite variance. */
static bool invert(const struct layout *layout, gsl_matrix *normal, double factor,
                   double *covariance) {
  size_t n = (size_t)layout->count;
  double *length = calloc(n, sizeof *length);
  gsl_vector *value = gsl_vector_alloc(n);
  gsl_matrix *vector = gsl_matrix_alloc(n, n);
  bool good = length && value && vector && decompose(normal, length, value, vector);
  double least = good ? null_part * gsl_vector_max(value) : 0.0;
  for (size_t i = 0; good && i < n; i++) {
    bool lost = false;
    for (size_t e = 0; e < n; e++) {
      lost =
          lost || (gsl_vector_get(value, e) <= least && fabs(gsl_matrix_get(vector, i, e)) > 1e-3);
    }
    for (size_t j = 0; j < n; j++) {
      double sum = 0.0;
      for (size_t e = 0; e < n; e++) {
        double own = gsl_vector_get(value, e);
        sum +=
            own > least ? gsl_matrix_get(vector, i, e) * gsl_matrix_get(vector, j, e) / own : 0.0;
      }
      double unit = length[i] * length[j] / (layout->scale[i] * layout->scale[j]);
      covariance[i * n + j] = unit > 0.0 ? factor * sum / unit : 0.0;
    }
    if (lost || !(length[i] > 0.0)) {
      covariance[i * n + i] = INFINITY;
    }
  }
  for (size_t i = 0; good && i < n; i++) {
    for (size_t j = 0; j < n && isinf(covariance[i * n + i]); j++) {
      if (j != i) {
        covariance[i * n + j] = covariance[j * n + i] = 0.0;
      }
    }
  }
  free(length);
  gsl_vector_free(value);
  gsl_matrix_free(vector);
  return good;
}

/* Singular values and directions of the Jacobian of a point to the logarithms of its coefficients.
 */
static bool find_singular(const struct identification *id, size_t index) {
  double own[POINT_PARAMETERS][POINT_PARAMETERS];
  struct point_estimate *estimate = &id->estimate[index];
  size_t n = id->point[index].set_point != 0.0 ? IDENTIFY_COEFFICIENTS : IDENTIFY_BETA;
  gsl_matrix *matrix = gsl_matrix_alloc(n, n), *vector = gsl_matrix_alloc(n, n);
  gsl_vector *value = gsl_vector_alloc(n);
  gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(n);
  bool good = matrix && vector && value && work;
  point_normal(&id->point[index], own);
  for (size_t i = 0; good && i < n; i++) {
    for (size_t j = 0; j < n; j++) {
      gsl_matrix_set(matrix, i, j, own[i][j] * estimate->value[i] * estimate->value[j]);
    }
  }
  good = good && gsl_eigen_symmv(matrix, value, vector, work) == GSL_SUCCESS &&
         gsl_eigen_symmv_sort(value, vector, GSL_EIGEN_SORT_VAL_DESC) == GSL_SUCCESS;
  estimate->visible = good ? (int)n : 0;
  for (size_t e = 0; good && e < n; e++) {
    estimate->singular[e] = sqrt(fmax(gsl_vector_get(value, e), 0.0));
    for (size_t i = 0; i < n; i++) {
      estimate->direction[e][i] = gsl_matrix_get(vector, i, e);
    }
  }
  gsl_matrix_free(matrix);
  gsl_matrix_free(vector);
  gsl_vector_free(value);
  gsl_eigen_symmv_free(work);
  return good;
}

/* Hands standard errors out to where the parameters live. */
static void hand_out(struct identification *id, const struct group *group,
                     const struct layout *layout) {
  size_t n = (size_t)layout->count;
  for (size_t i = 0; i < group->count; i++) {
    const int *column = layout->column[i];
    struct point_estimate *estimate = &id->estimate[group->first + i];
    struct shared_estimate *const shared[] = {&id->rest[id->point[group->first + i].mode],
                                              &id->mass, &id->gamma};
    for (int j = 0; j < IDENTIFY_COEFFICIENTS; j++) {
      size_t place = column[j] >= 0 ? (size_t)column[j] : 0;
      estimate->place[j] = place;
      estimate->stderror[j] = column[j] >= 0          ? sqrt(group->covariance[place * n + place])
                              : j == IDENTIFY_DAMPING ? INFINITY
                                                      : NAN;
    }
    for (int j = 0; j < 3; j++) {
      int place = column[POINT_REST + j];
      if (place >= 0) {
        shared[j]->stderror = sqrt(group->covariance[(size_t)place * n + (size_t)place]);
      }
    }
  }
}

static enum status evaluate(struct identification *id, struct group *group, struct error *error) {
  double rows = 0.0, starts = 0.0;
  group->chi_square = 0.0;
  for (size_t i = group->first; i < group->first + group->count; i++) {
    double parameter[POINT_PARAMETERS];
    struct point *point = &id->point[i];
    identification_parameters(id, i, parameter);
    enum status status =
        point_evaluate(point, id->trials, id->sigma, parameter, true, id->response, error);
    if (status != STATUS_OK) {
      return status;
    }
    for (size_t r = 0; r < point->rows; r++) {
      group->chi_square += point->residual[r] * point->residual[r];
    }
    rows += (double)point->rows;
    starts += (double)point->starts;
  }
  group->freedom = fmax(rows - starts - (double)group->parameters, 1.0);
  return STATUS_OK;
}

enum status covariance_fill(struct identification *id, struct group *group, struct error *error) {
  struct layout layout;
  enum status status = create(id, group, false, &layout, error);
  if (status != STATUS_OK) {
    return status;
  }
  size_t n = (size_t)layout.count;
  gsl_matrix *normal = gsl_matrix_calloc(n, n);
  group->parameters = layout.count;
  group->covariance = calloc(n * n, sizeof *group->covariance);
  bool given = id->spec->noise[0] > 0.0 && id->spec->noise[1] > 0.0, good = normal != NULL;
  status = evaluate(id, group, error);
  if (status == STATUS_OK && good && group->covariance) {
    layout_normal(&layout, id, group, normal);
    good = invert(&layout, normal, given ? 1.0 : group->chi_square / group->freedom,
                  group->covariance);
    for (size_t i = group->first; good && i < group->first + group->count; i++) {
      good = find_singular(id, i);
    }
  }
  if (status == STATUS_OK && (!good || !group->covariance)) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the covariance");
  }
  if (status == STATUS_OK) {
    hand_out(id, group, &layout);
  }
  gsl_matrix_free(normal);
  layout_release(&layout);
  return status;
}
