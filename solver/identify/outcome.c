#include "solver/identify/outcome.h"

#include <math.h>
#include <stdlib.h>

#include "solver/identify/jumps.h"

static enum status no_memory(struct error *error) {
  return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the outcome");
}

/* ---- the model ---------------------------------------------------------------------------- */

static void set_range(const struct identification *id, int mode, struct hlpv_mode *model) {
  model->from = INFINITY;
  model->to = -INFINITY;
  for (size_t i = 0; i < id->point_count; i++) {
    if (id->point[i].mode == mode) {
      model->from = fmin(model->from, id->point[i].set_point);
      model->to = fmax(model->to, id->point[i].set_point);
    }
  }
}

static enum status fit_model(const struct identification *id, struct outcome *outcome,
                             struct error *error) {
  outcome->complete = true;
  for (int mode = 0; mode < id->spec->mode_count; mode++) {
    struct hlpv_mode *m = &outcome->mode[mode];
    struct hlpv_polynomial *const target[] = {&m->stiffness, &m->damping, &m->alpha, &m->beta};
    m->rest = id->rest[mode].value;
    set_range(id, mode, m);
    for (int c = 0; c < IDENTIFY_COEFFICIENTS; c++) {
      struct polynomial_fit *fit = &outcome->polynomial[mode][c];
      enum status status = polynomial_fit_mode(id, mode, (enum identify_coefficient)c, fit, error);
      if (status != STATUS_OK) {
        return status;
      }
      *target[c] = fit->value;
      outcome->complete = outcome->complete && fit->points > 0;
    }
  }
  return STATUS_OK;
}

/* ---- simulation of the trials ------------------------------------------------------------- */

/* Simulates all steps of one mode to one set-point by the model. */
static enum status simulate_point(const struct identification *id, struct outcome *outcome,
                                  int mode, double set_point, struct error *error) {
  const struct hlpv_mode *m = &outcome->mode[mode];
  const double parameter[POINT_PARAMETERS] = {hlpv_polynomial_value(&m->stiffness, set_point),
                                              hlpv_polynomial_value(&m->damping, set_point),
                                              hlpv_polynomial_value(&m->alpha, set_point),
                                              hlpv_polynomial_value(&m->beta, set_point),
                                              m->rest,
                                              id->mass.value,
                                              id->gamma.value};
  struct point point;
  enum status status = point_create(id->trials, id->steps, mode, set_point, true, &point, error);
  bool stable = parameter[POINT_STIFFNESS] > 0.0 && parameter[POINT_DAMPING] >= 0.0 &&
                parameter[POINT_ALPHA] < 0.0;
  if (status == STATUS_OK && stable && point.step_count > 0) {
    status = point_evaluate(&point, id->trials, id->sigma, parameter, false, id->response, error);
    status = status == STATUS_DIVERGED ? STATUS_OK : status;
    for (size_t i = 0, sample = 0; i < point.step_count && status == STATUS_OK; i++) {
      const struct step *step = point.step[i];
      size_t index = (size_t)(step - id->steps->step);
      outcome->start[index] = point.start[i];
      outcome->has_start[index] = true;
      double *out = outcome->simulated + 2 * (outcome->first[step->trial] + step->first);
      for (size_t k = 0; k < step->count; k++, sample++) {
        point_simulated(&point, parameter, i, sample, &out[2 * k], &out[2 * k + 1]);
      }
    }
  }
  point_release(&point);
  return status;
}

/* Every pair of mode and set-point once. */
static enum status simulate_all(const struct identification *id, struct outcome *outcome,
                                struct error *error) {
  const struct steps *steps = id->steps;
  for (size_t i = 0; i < steps->count; i++) {
    const struct step *step = &steps->step[i];
    if (!outcome->has_start[i] && step->count >= 2) {
      enum status status = simulate_point(id, outcome, step->mode, step->set_point, error);
      if (status != STATUS_OK) {
        return status;
      }
    }
  }
  return STATUS_OK;
}

/* ---- quality ------------------------------------------------------------------------------ */

/* Sums over the rows of a trial that are simulated. */
struct trial_sums {
  double count, residual, mean, total, low, high;
};

static struct trial_sums sum_trial(const struct identification *id, const struct outcome *outcome,
                                   size_t index, int quantity) {
  const struct trial *trial = &id->trials->trial[index];
  const double *measured = quantity == 0 ? trial->h : trial->pressure;
  struct trial_sums s = {.low = INFINITY, .high = -INFINITY};
  for (int pass = 0; pass < 2; pass++) {
    for (size_t i = 0; i < trial->count; i++) {
      double simulated = outcome->simulated[2 * (outcome->first[index] + i) + (size_t)quantity];
      if (isnan(simulated)) {
        continue;
      }
      double off = measured[i] - simulated, about = measured[i] - s.mean;
      s.count += pass == 0;
      s.residual += pass == 0 ? off * off : 0.0;
      s.total += pass == 0 ? measured[i] : about * about;
      s.low = fmin(s.low, measured[i]);
      s.high = fmax(s.high, measured[i]);
    }
    s.mean = pass == 0 && s.count > 0.0 ? s.total / s.count : s.mean;
    s.total = pass == 0 ? 0.0 : s.total;
  }
  return s;
}

double outcome_trial_rmse(const struct identification *id, const struct outcome *outcome,
                          size_t trial, int quantity, double *range) {
  struct trial_sums s = sum_trial(id, outcome, trial, quantity);
  *range = s.high - s.low;
  return s.count > 0.0 ? sqrt(s.residual / s.count) : NAN;
}

static void find_quality(const struct identification *id, struct outcome *outcome) {
  double normal[2][2] = {{0}}, residual[2][2] = {{0}}, total[2][2] = {{0}}, count[2] = {0};
  for (size_t i = 0; i < id->trials->count; i++) {
    int part = id->trials->trial[i].held_out;
    for (int q = 0; q < 2; q++) {
      struct trial_sums s = sum_trial(id, outcome, i, q);
      double range = s.high - s.low;
      if (s.count > 0.0 && range > 0.0) {
        normal[part][q] += s.residual / (range * range);
        residual[part][q] += s.residual;
        total[part][q] += s.total;
        count[part] += q == 0 ? s.count : 0.0;
      }
    }
  }
  for (int part = 0; part < 2; part++) {
    struct quality *quality = &outcome->quality[part];
    quality->samples = count[part];
    for (int q = 0; q < 2; q++) {
      quality->rmse[q] = sqrt(normal[part][q] / count[part]);
      quality->r_squared[q] = 1.0 - residual[part][q] / total[part][q];
    }
  }
}

/* Correlation of neighbouring residuals of the points: 0 for noise without memory. */
static void find_correlation(const struct identification *id, struct outcome *outcome) {
  double product[2] = {0.0, 0.0}, square[2] = {0.0, 0.0};
  for (size_t i = 0; i < id->point_count; i++) {
    const struct point *point = &id->point[i];
    const double *r = point->residual;
    for (size_t k = 0; k < point->step_count; k++) {
      size_t n = point->step[k]->count;
      for (int q = 0; q < 2; q++, r += n) {
        for (size_t s = 0; s < n; s++) {
          square[q] += r[s] * r[s];
          product[q] += s > 0 ? r[s] * r[s - 1] : 0.0;
        }
      }
      outcome->correlation_samples += (double)n;
      r += point->step[k]->settled ? 2 : 0;
    }
  }
  for (int q = 0; q < 2; q++) {
    outcome->correlation[q] = square[q] > 0.0 ? product[q] / square[q] : 0.0;
  }
}

enum status outcome_fill(const struct identification *id, struct outcome *outcome,
                         struct error *error) {
  size_t rows = 0;
  *outcome = (struct outcome){.jump_count = 0};
  outcome->first = calloc(id->trials->count, sizeof *outcome->first);
  for (size_t i = 0; outcome->first && i < id->trials->count; i++) {
    outcome->first[i] = rows;
    rows += id->trials->trial[i].count;
  }
  outcome->simulated = calloc(2 * rows, sizeof *outcome->simulated);
  outcome->start = calloc(id->steps->count, sizeof *outcome->start);
  outcome->has_start = calloc(id->steps->count, sizeof *outcome->has_start);
  if (!outcome->first || !outcome->simulated || !outcome->start || !outcome->has_start) {
    return no_memory(error);
  }
  for (size_t i = 0; i < 2 * rows; i++) {
    outcome->simulated[i] = NAN;
  }
  enum status status = fit_model(id, outcome, error);
  if (status == STATUS_OK && outcome->complete) {
    status = simulate_all(id, outcome, error);
  }
  if (status == STATUS_OK) {
    find_quality(id, outcome);
    find_correlation(id, outcome);
    jumps_fill(id, outcome);
  }
  return status;
}

void outcome_release(struct outcome *outcome) {
  free(outcome->first);
  free(outcome->simulated);
  free(outcome->start);
  free(outcome->has_start);
  *outcome = (struct outcome){.jump_count = 0};
}
