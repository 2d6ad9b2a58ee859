#include "solver/identify/remarks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/identify/estimate.h"
#include "solver/job/json.h"

static const char *const names[IDENTIFY_COEFFICIENTS] = {"stiffness", "damping", "alpha", "beta"};

/* Relative standard error from which a number counts as not seen. */
static const double unseen = 0.5;

static bool is_unseen(double value, double stderror) {
  return !(stderror <= unseen * fabs(value));
}

static bool is_inertia_unseen(const struct identification *id,
                              const struct shared_estimate *shared) {
  return !id->inertia || is_unseen(shared->value, shared->stderror);
}

/* ---- identifiability ---------------------------------------------------------------------- */

static void say(json_t *remarks, json_t *sentence) {
  json_array_append_new(remarks, sentence);
}

static void remark_shared(const struct identification *id, json_t *remarks) {
  bool mass = !isnan(id->spec->mass), gamma = !isnan(id->spec->gamma);
  if (!mass && !gamma) {
    say(remarks,
        json_string("neither mass nor gamma is given: only stiffness/mass, damping/mass and "
                    "gamma/mass are visible. Coefficients are per mass, and the model is given for "
                    "a mass of 1 kg, which moves alike"));
  } else if (!gamma && is_inertia_unseen(id, &id->gamma)) {
    say(remarks,
        json_string("gamma cannot be told from the mass: at this sampling the elongation follows "
                    "the pressure without inertia, so that only stiffness/gamma and damping/gamma "
                    "are visible. Give gamma"));
  } else if (!mass && is_inertia_unseen(id, &id->mass)) {
    say(remarks,
        json_string("the mass cannot be told: at this sampling the elongation follows the pressure "
                    "without inertia. Stiffness and damping do not depend on it"));
  }
  if (!mass && !gamma && is_inertia_unseen(id, &id->gamma)) {
    say(remarks,
        json_string("not even gamma/mass can be told: at this sampling the elongation follows the "
                    "pressure without inertia, so that only stiffness/gamma and damping/gamma are "
                    "visible"));
  }
}

/* Coefficients with a large part in the direction that is seen worst. */
static int weak_parts(const struct point_estimate *e, bool weak[IDENTIFY_COEFFICIENTS]) {
  int count = 0, last = e->visible - 1;
  for (int c = 0; c < IDENTIFY_COEFFICIENTS; c++) {
    weak[c] = c < e->visible && fabs(e->direction[last][c]) > 0.3;
    count += weak[c];
  }
  return count;
}

static void remark_pair(const char *mode, double u, const struct point_estimate *e,
                        json_t *remarks) {
  bool weak[IDENTIFY_COEFFICIENTS];
  int last = e->visible - 1, first = -1;
  if (last < 0 || !(e->singular[last] < 1.0 / 0.2) || weak_parts(e, weak) < 2) {
    return;
  }
  for (int c = 0; c < IDENTIFY_COEFFICIENTS; c++) {
    if (weak[c] && first < 0) {
      first = c;
    } else if (weak[c]) {
      bool together = e->direction[last][c] * e->direction[last][first] > 0.0;
      say(remarks,
          json_sprintf("mode \"%s\", %.6g kPa: %s and %s can hardly be told apart; their %s is "
                       "visible",
                       mode, 1e-3 * u, names[first], names[c], together ? "ratio" : "product"));
      return;
    }
  }
}

static void remark_point(const struct identification *id, size_t index, json_t *remarks) {
  const struct point_estimate *e = &id->estimate[index];
  const char *mode = id->spec->mode[id->point[index].mode].name;
  double u = id->point[index].set_point;
  for (int c = 0; c < IDENTIFY_COEFFICIENTS; c++) {
    if (isnan(e->stderror[c])) {
      say(remarks, json_sprintf("mode \"%s\", 0 kPa: beta cannot be seen, and not be told apart "
                                "from alpha: it multiplies the set-point",
                                mode));
    } else if (c == IDENTIFY_DAMPING && is_unseen(e->value[c], e->stderror[c])) {
      say(remarks, json_sprintf("mode \"%s\", %.6g kPa: damping is invisible: h neither oscillates "
                                "nor lags behind the pressure by more than noise and sampling let "
                                "pass",
                                mode, 1e-3 * u));
    } else if (is_unseen(e->value[c], e->stderror[c])) {
      say(remarks, json_sprintf("mode \"%s\", %.6g kPa: %s is not determined (standard error over "
                                "%.0f %%)",
                                mode, 1e-3 * u, names[c], 100.0 * unseen));
    }
  }
  remark_pair(mode, u, e, remarks);
}

static json_t *singular_object(const struct identification *id, size_t index) {
  const struct point_estimate *e = &id->estimate[index];
  json_t *values = json_array(), *weakest = json_object();
  for (int i = 0; i < e->visible; i++) {
    json_array_append_new(values, json_real(e->singular[i]));
  }
  for (int c = 0; c < e->visible; c++) {
    json_set_finite(weakest, names[c], e->direction[e->visible - 1][c]);
  }
  return json_pack("{s:s, s:f, s:o, s:o}", "mode", id->spec->mode[id->point[index].mode].name,
                   "set_point_kPa", 1e-3 * id->point[index].set_point, "singular_values", values,
                   "weakest_combination", weakest);
}

json_t *remarks_identifiability(const struct identification *id) {
  bool none = isnan(id->spec->mass) && isnan(id->spec->gamma);
  json_t *remarks = json_array(), *points = json_array();
  json_t *visible = none ? json_pack("[s, s, s, s, s]", "stiffness/mass", "damping/mass",
                                     "gamma/mass", "alpha", "beta")
                         : json_pack("[s, s, s, s]", "stiffness", "damping", "alpha", "beta");
  remark_shared(id, remarks);
  for (size_t i = 0; i < id->point_count; i++) {
    remark_point(id, i, remarks);
    json_array_append_new(points, singular_object(id, i));
  }
  return json_pack("{s:o, s:o, s:o}", "visible", visible, "remarks", remarks, "points", points);
}

/* ---- warnings ----------------------------------------------------------------------------- */

static void warn_of_noise(const struct identification *id, const struct outcome *outcome,
                          json_t *warnings) {
  static const char *const quantities[2] = {"elongation", "pressure"};
  double bound = fmax(0.1, 4.0 / sqrt(fmax(outcome->correlation_samples, 1.0)));
  for (int q = 0; q < 2; q++) {
    double r = outcome->correlation[q], noise = 0.0;
    for (size_t i = 0; i < id->trials->count; i++) {
      noise = fmax(noise, id->sigma[2 * i + (size_t)q]);
    }
    /* Without noise what is left are the errors of the integration. */
    if (fabs(r) > bound && noise > 1e-5 * id->steps->range[q]) {
      double factor = r > 0.0 ? sqrt((1.0 + r) / (1.0 - r)) : 1.0;
      say(warnings,
          json_sprintf("neighbouring residuals of the %s are correlated (%.2f): the noise "
                       "has a memory, or the model does not tell all%s",
                       quantities[q], r,
                       factor > 1.05 ? "; intervals are too narrow, by about the factor " : ""));
      if (factor > 1.05) {
        json_t *last = json_array_get(warnings, json_array_size(warnings) - 1);
        json_array_set_new(warnings, json_array_size(warnings) - 1,
                           json_sprintf("%s%.2g", json_string_value(last), factor));
      }
    }
  }
  for (size_t g = 0; g < id->group_count; g++) {
    const struct group *group = &id->group[g];
    double ratio = group->chi_square / group->freedom, spread = sqrt(2.0 / group->freedom);
    bool given = id->spec->noise[0] > 0.0 && id->spec->noise[1] > 0.0;
    if (given && fabs(ratio - 1.0) > fmax(5.0 * spread, 0.2)) {
      say(warnings, json_sprintf("mode \"%s\": the residuals are %.3g times the noise that the job "
                                 "gives",
                                 id->spec->mode[id->point[group->first].mode].name, sqrt(ratio)));
    }
  }
}

static void warn_of_polynomials(const struct identification *id, const struct outcome *outcome,
                                json_t *warnings) {
  for (int mode = 0; mode < id->spec->mode_count; mode++) {
    const char *name = id->spec->mode[mode].name;
    for (int c = 0; c < IDENTIFY_COEFFICIENTS; c++) {
      const struct polynomial_fit *fit = &outcome->polynomial[mode][c];
      int degree = fit->value.count - 1, asked = id->spec->degree[c];
      if (fit->points == 0) {
        say(warnings,
            json_sprintf("mode \"%s\": no set-point shows %s: there is no model", name, names[c]));
      } else if (asked > degree) {
        say(warnings, json_sprintf("mode \"%s\": %d set-point%s allow%s degree %d of %s, not %d",
                                   name, fit->points, fit->points > 1 ? "s" : "",
                                   fit->points > 1 ? "" : "s", degree, names[c], asked));
      } else if (fit->chance < 1e-3) {
        say(warnings,
            json_sprintf("mode \"%s\": a polynomial of degree %d does not follow %s at "
                         "the set-points within its errors (chi-square %.3g for %d)",
                         name, degree, names[c], fit->chi_square, fit->points - degree - 1));
      }
    }
  }
}

/* Steps that begin in a gap of the rows: when, is not known. */
static void warn_of_gaps(const struct identification *id, json_t *warnings) {
  for (size_t i = 1; i < id->steps->count; i++) {
    const struct step *step = &id->steps->step[i];
    const struct trial *trial = &id->trials->trial[step->trial];
    if (step->first == 0 || step->count < 2 || step->after_switch || step->before_switch) {
      continue;
    }
    const double *t = trial->time + step->first;
    double span = t[step->count - 1] - t[0];
    if (t[0] - t[-1] > 0.1 * span) {
      say(warnings, json_sprintf("trial \"%s\": the step in line %d follows a gap of %.3g s: it is "
                                 "taken to begin with the row",
                                 trial->name, trial->line[step->first], t[0] - t[-1]));
    }
  }
}

void remarks_warn(const struct identification *id, const struct outcome *outcome,
                  json_t *warnings) {
  /* A soft actuator of a hand's size pushes with less than 200 N at 8 psi. */
  if (!isnan(id->spec->gamma) && id->spec->gamma * 55158.1 > 200.0) {
    say(warnings,
        json_sprintf("gamma makes %.4g N at 8 psi (55.16 kPa), over 200 N: is its unit right? a "
                     "gamma per psi that is taken for one per kPa is 6.9 times too large",
                     id->spec->gamma * 55158.1));
  }
  for (size_t g = 0; g < id->group_count; g++) {
    const struct point *point = &id->point[id->group[g].first];
    if (!id->group[g].converged) {
      say(warnings, json_sprintf("mode \"%s\", from %.6g kPa on: the least squares did not settle",
                                 id->spec->mode[point->mode].name, 1e-3 * point->set_point));
    }
  }
  warn_of_noise(id, outcome, warnings);
  warn_of_polynomials(id, outcome, warnings);
  warn_of_gaps(id, warnings);
}
