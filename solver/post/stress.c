#include "solver/post/stress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rows and columns of the components. */
static const int row[STRESS_COMPONENTS] = {0, 1, 2, 0, 1, 0};
static const int column[STRESS_COMPONENTS] = {0, 1, 2, 1, 2, 2};

/* sigma = P F^T / J with P = P_iso + p J F^-T, so that sigma = P_iso F^T / J + p 1. */
static void cauchy_stress(const struct fe_model *model, const struct fe_state *state, int element,
                          int q, double u[3][HEX27_STRIDE], double stress[STRESS_COMPONENTS]) {
  const struct element_geometry *geometry = &model->geometry[element];
  struct kinematics k;
  double first[9], pressure = 0;
  element_gradient(geometry, q, u, k.f);
  kinematics_complete(&k);
  hyperelastic_isochoric(&model->material, &k, first, NULL);
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    pressure += geometry->phi[m][q] * state->p[ELEMENT_PRESSURES * element + m];
  }
  for (int c = 0; c < STRESS_COMPONENTS; c++) {
    const double *a = first + 3 * row[c], *b = k.f + 3 * column[c];
    stress[c] =
        (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / k.j + (row[c] == column[c] ? pressure : 0);
  }
}

/* fit[n][g]: value at the node n = -1, 0, 1 of the straight line fitted to a unit value at Gauss
 * point g: w_g (1/2 + 3/2 x_g xi_n). */
static void line_fit_weights(double fit[3][3]) {
  const double x[3] = {-sqrt(0.6), 0, sqrt(0.6)}, w[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
  for (int n = 0; n < 3; n++) {
    for (int g = 0; g < 3; g++) {
      fit[n][g] = w[g] * (0.5 + 1.5 * x[g] * (n - 1));
    }
  }
}

enum status stress_at_nodes(const struct fe_model *model, const struct fe_state *state,
                            double (*stress)[STRESS_COMPONENTS]) {
  const struct mesh *mesh = model->mesh;
  double fit[3][3];
  int *count = calloc((size_t)mesh->node_count + 1, sizeof *count);
  if (!count) {
    return STATUS_NO_MEMORY;
  }
  line_fit_weights(fit);
  memset(stress, 0, sizeof *stress * (size_t)mesh->node_count);
  for (int e = 0; e < mesh->element_count; e++) {
    double u[3][HEX27_STRIDE], at[HEX27_POINTS][STRESS_COMPONENTS];
    model_gather(model, state->u, e, u);
    for (int q = 0; q < HEX27_POINTS; q++) {
      cauchy_stress(model, state, e, q, u, at[q]);
    }
    for (int a = 0; a < HEX27_NODES; a++) {
      int node = mesh->element_nodes[HEX27_NODES * e + a];
      for (int q = 0; q < HEX27_POINTS; q++) { /* Gauss points are numbered like the nodes */
        double weight = fit[a / 9][q / 9] * fit[a / 3 % 3][q / 3 % 3] * fit[a % 3][q % 3];
        for (int c = 0; c < STRESS_COMPONENTS; c++) {
          stress[node][c] += weight * at[q][c];
        }
      }
      count[node]++;
    }
  }
  for (int n = 0; n < mesh->node_count; n++) {
    for (int c = 0; c < STRESS_COMPONENTS; c++) {
      stress[n][c] /= count[n] > 0 ? count[n] : 1;
    }
  }
  free(count);
  return STATUS_OK;
}

struct stress_peak stress_peak(const struct fe_model *model, const struct fe_state *state) {
  struct stress_peak peak = {.von_mises = 0, .principal = -INFINITY};
  for (int e = 0; e < model->mesh->element_count; e++) {
    double u[3][HEX27_STRIDE], stress[STRESS_COMPONENTS];
    model_gather(model, state->u, e, u);
    for (int q = 0; q < HEX27_POINTS; q++) {
      cauchy_stress(model, state, e, q, u, stress);
      peak.von_mises = fmax(peak.von_mises, stress_von_mises(stress));
      peak.principal = fmax(peak.principal, stress_largest(stress));
    }
  }
  return peak;
}

double stress_von_mises(const double s[STRESS_COMPONENTS]) {
  double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return sqrt(0.5 * (a * a + b * b + c * c) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

double stress_largest(const double s[STRESS_COMPONENTS]) {
  return symmetric3_largest((double[9]){s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2]});
}

double stress_pressure(const double s[STRESS_COMPONENTS]) {
  return -(s[0] + s[1] + s[2]) / 3;
}
