#include "solver/bistable/law.h"

#include <math.h>
#include <string.h>

#include "solver/bistable/law_internal.h"

enum { SCAN = 400, BISECTIONS = 100 };

void law_find_shares(const struct law *law, double p, struct shares *shares) {
  const struct law_table *table = &law->spec->table;
  double low = table->level[0].pressure, high = table->level[table->count - 1].pressure;
  double inside = fmin(fmax(p, low), high), beyond = p - inside;
  for (int k = 0; k < table->count; k++) {
    struct cubic_value at;
    cubic_evaluate(&law->share[k], inside, &at);
    shares->value[k] = at.value + beyond * at.slope;
    shares->slope[k] = at.slope;
    shares->integral[k] = at.integral + beyond * (at.value + 0.5 * beyond * at.slope);
  }
}

/* F = sum over i of c[i] (h / per)^i - area p. */
static void evaluate_polynomial(const struct law_spec *spec, double h, double p,
                                struct law_value *value) {
  double x = h / spec->per, force = 0.0, energy = 0.0;
  for (int i = spec->count - 1; i >= 0; i--) {
    force = force * x + spec->c[i];
    energy = energy * x + spec->c[i] / (i + 1);
  }
  value->force = force - spec->area * p;
  value->volume = spec->volume + spec->area * h;
  value->potential = energy * h - p * value->volume;
}

/* Sums over the pressures of the table; _p: derivatives by the pressure. */
struct sums {
  double end, end_p;     /* e */
  double force, force_p; /* at q */
  double rest, rest_p;   /* integral of q^power F from q to 1 */
  double end_slope, end_slope_p, far_slope, far_slope_p;
  double far_volume, far_potential;
};

static void find_sums(const struct law *law, const struct branch *branch,
                      const struct shares *shares, double h, struct sums *sums) {
  int count = law->spec->table.count;
  *sums = (struct sums){.far_potential = branch->constant};
  for (int k = 0; k < count; k++) {
    sums->end += shares->value[k] * branch->end[k];
    sums->end_p += shares->slope[k] * branch->end[k];
  }
  double part = (h - sums->end) / (branch->far - sums->end);
  double q = fmin(fmax(part, 0.0), 1.0);
  q = branch->power == 1 ? sqrt(q) : q;
  for (int k = 0; k < count; k++) {
    const struct cubic *force = &branch->force[k];
    double w = shares->value[k], d = shares->slope[k];
    struct cubic_value at;
    cubic_evaluate(force, q, &at);
    double rest = force->integral[force->count - 1] - at.integral;
    sums->force += w * at.value;
    sums->force_p += d * at.value;
    sums->rest += w * rest;
    sums->rest_p += d * rest;
    sums->end_slope += w * branch->end_slope[k];
    sums->end_slope_p += d * branch->end_slope[k];
    sums->far_slope += w * branch->far_slope[k];
    sums->far_slope_p += d * branch->far_slope[k];
    sums->far_volume += w * branch->far_volume[k];
    sums->far_potential -= shares->integral[k] * branch->far_volume[k];
  }
}

/* With L = (power + 1) (far - e), r = (h - e) / (far - e), A = integral of q^power F from q to 1:
 *   Phi = Phi_far - L A,   V = V_far + dL/dp A + L dA/dp + F de/dp (1 - r). */
static void evaluate_branch(const struct law *law, const struct branch *branch,
                            const struct shares *shares, double h, struct law_value *value) {
  struct sums s;
  find_sums(law, branch, shares, h, &s);
  double span = branch->far - s.end, part = (h - s.end) / span;
  double inside = fmin(fmax(part, 0.0), 1.0);
  double length = (branch->power + 1) * span, length_p = -(branch->power + 1) * s.end_p;
  value->force = s.force;
  value->potential = s.far_potential - length * s.rest;
  value->volume =
      s.far_volume + length_p * s.rest + length * s.rest_p + s.force * s.end_p * (1.0 - inside);
  if (part > 1.0 || part < 0.0) {
    double x = h - (part > 1.0 ? branch->far : s.end);
    double slope = part > 1.0 ? s.far_slope : s.end_slope;
    double slope_p = part > 1.0 ? s.far_slope_p : s.end_slope_p;
    value->force += slope * x;
    value->potential += x * (s.force + 0.5 * slope * x);
    value->volume -= x * (s.force_p + 0.5 * slope_p * x);
  }
}

void law_evaluate(const struct law *law, enum law_side side, double h, double p,
                  struct law_value *value) {
  if (!law->spec->is_table) {
    evaluate_polynomial(law->spec, h, p, value);
    return;
  }
  struct shares shares;
  law_find_shares(law, p, &shares);
  evaluate_branch(law, &law->branch[law->branches ? side : 0], &shares, h, value);
}

bool law_has_branches(const struct law *law) {
  return law->branches;
}

double law_limit(const struct law *law, enum law_side side, double p) {
  if (!law->falls) {
    return NAN;
  }
  if (!law->spec->is_table) {
    return law->limit[side][0];
  }
  struct shares shares;
  double sum = 0.0;
  law_find_shares(law, p, &shares);
  for (int k = 0; k < law->spec->table.count; k++) {
    sum += shares.value[k] * law->limit[side][k];
  }
  return sum;
}

double law_end(const struct law *law, enum law_side side, double p) {
  if (!law->branches) {
    return law_limit(law, side == LAW_COMPRESSED ? LAW_STRETCHED : LAW_COMPRESSED, p);
  }
  struct shares shares;
  double sum = 0.0;
  law_find_shares(law, p, &shares);
  for (int k = 0; k < law->spec->table.count; k++) {
    sum += shares.value[k] * law->branch[side].end[k];
  }
  return sum;
}

void law_range(const struct law *law, double h[2], double p[2]) {
  const struct law_table *table = &law->spec->table;
  memcpy(h, law->range, sizeof law->range);
  p[0] = law->spec->is_table ? table->level[0].pressure : -INFINITY;
  p[1] = law->spec->is_table ? table->level[table->count - 1].pressure : INFINITY;
}

/* The elongation between low and high at which the force passes `force`, as at low it does not. */
static double bisect(const struct law *law, enum law_side side, double p, double force, double low,
                     double high) {
  struct law_value value;
  law_evaluate(law, side, low, p, &value);
  bool below = value.force < force;
  for (int n = 0; n < BISECTIONS; n++) {
    double middle = 0.5 * (low + high);
    law_evaluate(law, side, middle, p, &value);
    if ((value.force < force) == below) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return 0.5 * (low + high);
}

double law_rest(const struct law *law, enum law_side side, double p, double force) {
  double width = law->range[1] - law->range[0], limit = law_limit(law, side, p);
  double outer = side == LAW_COMPRESSED ? law->range[0] - width : law->range[1] + width;
  double inner = !isnan(limit)            ? limit
                 : side == LAW_COMPRESSED ? law->range[1] + width
                                          : law->range[0] - width;
  double from = outer;
  bool below = false;
  for (int i = 0; i <= SCAN; i++) {
    struct law_value value;
    double h = outer + (inner - outer) * i / SCAN;
    law_evaluate(law, side, h, p, &value);
    bool is_below = value.force < force;
    if (i > 0 && is_below != below && below == (side == LAW_COMPRESSED)) {
      return bisect(law, side, p, force, from, h);
    }
    below = is_below;
    from = h;
  }
  return NAN;
}
