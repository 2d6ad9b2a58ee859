#include "solver/fe/energy.h"

#include <string.h>

/* Strain energy of element e. */
static double element_energy(const struct fe_model *m, const struct fe_state *state, int e) {
  const struct element_geometry *g = &m->geometry[e];
  const double *p = state->p + (size_t)ELEMENT_PRESSURES * (size_t)e;
  double u[3][HEX27_STRIDE], sum = 0;
  model_gather(m, state->u, e, u);
  for (int q = 0; q < HEX27_POINTS; q++) {
    struct kinematics k;
    double stress[9], pressure = 0;
    element_gradient(g, q, u, k.f);
    kinematics_complete(&k);
    for (int n = 0; n < ELEMENT_PRESSURES; n++) {
      pressure += p[n] * g->phi[n][q];
    }
    double density = hyperelastic_isochoric(&m->material, &k, stress, NULL);
    density += pressure * (k.j - 1 - 0.5 * pressure / m->bulk_modulus);
    sum += g->weight[q] * density;
  }
  return sum;
}

double energy_strain(const struct fe_model *m, const struct fe_state *state) {
  double sum = 0;
  for (int e = 0; e < m->mesh->element_count; e++) {
    sum += element_energy(m, state, e);
  }
  return sum;
}

/* Rows of C = F^T F at point q. */
static void stretches(const struct element_geometry *g, int q, double u[3][HEX27_STRIDE],
                      double c[6]) {
  double f[9];
  int row = 0;
  element_gradient(g, q, u, f);
  for (int j = 0; j < 3; j++) {
    for (int l = j; l < 3; l++) {
      c[row++] = f[j] * f[l] + f[3 + j] * f[3 + l] + f[6 + j] * f[6 + l];
    }
  }
}

double energy_viscous(const struct fe_model *m, const struct inertia *inertia, const double *from,
                      const double *u, double *stress) {
  static const double count[6] = {1, 2, 2, 1, 2, 1}; /* of a row in the full tensor */
  double work = 0;
  for (int e = 0; e < m->mesh->element_count; e++, stress += ENERGY_STRESS) {
    const struct element_viscosity *v = inertia_viscosity(inertia, e);
    double start[3][HEX27_STRIDE], end[3][HEX27_STRIDE];
    if (!v) {
      memset(stress, 0, ENERGY_STRESS * sizeof *stress);
      continue;
    }
    model_gather(m, from, e, start);
    model_gather(m, u, e, end);
    for (int q = 0; q < HEX27_POINTS; q++) {
      double before[6], now[6], density = 0;
      stretches(&m->geometry[e], q, start, before);
      stretches(&m->geometry[e], q, end, now);
      for (int row = 0; row < 6; row++) {
        double *s = &stress[HEX27_POINTS * row + q];
        double s1 = v->stiffness * (now[row] - v->history[row][q]);
        density += 0.25 * count[row] * (*s + s1) * (now[row] - before[row]);
        *s = s1;
      }
      work += m->geometry[e].weight[q] * density;
    }
  }
  return work;
}

/* Work of the whole dead load on the way to the state. */
static double dead_work(const struct fe_model *m, const struct fe_state *state) {
  double sum = 0;
  for (int d = 0; d < 3 * m->mesh->node_count; d++) {
    sum += m->dead_load[d] * state->u[d];
  }
  return sum;
}

void energy_reload(struct energy *energy, const struct fe_model *m, const struct fe_state *state) {
  energy->lift = dead_work(m, state);
}

static void keep(struct energy *energy, const struct fe_model *m, const struct fe_state *state,
                 const struct fe_load *load) {
  energy->pressure = load->pressure;
  energy->volume = model_volume(m, state, NULL);
  energy->dead = load->dead;
  energy->lift = dead_work(m, state);
  energy->strain = energy_strain(m, state);
}

void energy_start(struct energy *energy, const struct fe_model *m, const struct fe_state *state,
                  const struct fe_load *load, double kinetic) {
  *energy = (struct energy){.kinetic = kinetic};
  keep(energy, m, state, load);
  energy->start = energy->strain + kinetic;
}

void energy_record(struct energy *energy, const struct fe_model *m, const struct fe_state *state,
                   const struct fe_load *load, const struct energy_step *step) {
  struct energy last = *energy;
  keep(energy, m, state, load);
  energy->kinetic = step->kinetic;
  energy->damping += step->damping;
  energy->friction += step->friction;
  energy->obstacle_work += step->obstacle_work;
  energy->pressure_work += 0.5 * (last.pressure + load->pressure) * (energy->volume - last.volume);
  energy->weight_work +=
      0.5 * (last.dead + load->dead) * (energy->lift - last.lift) + step->weight_work;
  double work = energy->pressure_work + energy->weight_work + energy->obstacle_work;
  double stored = energy->strain + energy->kinetic - energy->start;
  energy->remainder = work - stored - energy->damping - energy->friction;
}
