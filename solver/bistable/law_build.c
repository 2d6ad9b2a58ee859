#include <math.h>
#include <stdlib.h>

#include "solver/bistable/law_internal.h"

enum { SCAN = 2000, BISECTIONS = 100 };

void law_destroy(struct law *law) {
  if (!law) {
    return;
  }
  for (int k = 0; k < BISTABLE_LEVELS_MAX; k++) {
    cubic_release(&law->share[k]);
    cubic_release(&law->branch[0].force[k]);
    cubic_release(&law->branch[1].force[k]);
  }
  free(law);
}

/* Splines that are 1 at one pressure and 0 at the others; straight between two. */
static enum status share_pressures(struct law *law, struct error *error) {
  const struct law_table *table = &law->spec->table;
  double p[BISTABLE_LEVELS_MAX + 1], y[BISTABLE_LEVELS_MAX + 1];
  bool pair = table->count == 2;
  int knots = pair ? 3 : table->count;
  for (int k = 0; k < table->count; k++) {
    p[pair ? 2 * k : k] = table->level[k].pressure;
  }
  if (pair) {
    p[1] = 0.5 * (p[0] + p[2]);
  }
  enum status status = STATUS_OK;
  for (int k = 0; k < table->count && status == STATUS_OK; k++) {
    for (int i = 0; i < knots; i++) {
      y[i] = pair ? (i == 1 ? 0.5 : i == 2 * k) : i == k;
    }
    status = cubic_create((size_t)knots, p, y, 0, &law->share[k], error);
  }
  return status;
}

/* The far end of a level, carried on straight from its outermost point to that of all levels. */
static double carry_on(const struct law *law, int k, size_t at, size_t next,
                       struct branch *branch) {
  const struct law_path *path = &law->path[k];
  const struct law_level *level = path->level;
  size_t i = law_path_index(path, at), j = law_path_index(path, next);
  double dh = level->h[j] - level->h[i], x = branch->far - level->h[i];
  branch->far_slope[k] = (level->force[j] - level->force[i]) / dh;
  branch->far_volume[k] = level->volume[i] + (level->volume[j] - level->volume[i]) / dh * x;
  return level->force[i] + branch->far_slope[k] * x;
}

/* The branch of one level from the points `from` to `to` of its path; the first is at its end, or
 * next to it where a force at the turning point is given. */
static enum status fit_level(struct law *law, int k, struct branch *branch, size_t from, size_t to,
                             const double *turn_force, struct error *error) {
  const struct law_path *path = &law->path[k];
  size_t count = from < to ? to - from + 1 : from - to + 1, n = 0;
  double *q = calloc(2 * (count + 2), sizeof *q), *force = q ? q + count + 2 : NULL;
  double span = branch->far - branch->end[k];
  if (!q) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a law");
  }
  if (turn_force) {
    force[n++] = *turn_force;
  }
  for (size_t i = 0; i < count; i++) {
    size_t at = from < to ? from + i : from - i;
    double part = (law_path_h(path, at) - branch->end[k]) / span;
    double place = branch->power == 1 ? sqrt(fmax(part, 0.0)) : part;
    if (n == 0 || place > q[n - 1] + 1e-7) {
      q[n] = place;
      force[n++] = law_path_force(path, at);
    }
  }
  size_t next = from < to ? to - 1 : to + 1;
  double far_force = carry_on(law, k, to, next, branch);
  if (q[n - 1] < 1.0 - 1e-7) {
    n++;
  }
  q[n - 1] = 1.0;
  force[n - 1] = far_force;
  enum status status =
      n < 3 ? error_set(error, STATUS_INVALID, NULL,
                        "at %.6g kPa a branch of the path has too few points that differ",
                        1e-3 * path->level->pressure)
            : cubic_create(n, q, force, branch->power, &branch->force[k], error);
  if (status == STATUS_OK && branch->power == 0) {
    struct cubic_value at;
    cubic_evaluate(&branch->force[k], 0.0, &at);
    branch->end_slope[k] = at.slope / span;
  }
  free(q);
  return status;
}

/* Integral of F dh along the path of a level, over its length by the spline of both. */
static enum status path_work(const struct law_path *path, double *work, struct error *error) {
  size_t count = path->level->count;
  double *s = calloc(3 * count, sizeof *s), *h = s ? s + count : NULL, *f = s ? h + count : NULL;
  struct cubic of_h = {0}, of_force = {0};
  double scale_h = 0.0, scale_f = 0.0;
  if (!s) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a law");
  }
  for (size_t i = 0; i < count; i++) {
    h[i] = law_path_h(path, i);
    f[i] = law_path_force(path, i);
    scale_h = fmax(scale_h, fabs(h[i] - h[0]));
    scale_f = fmax(scale_f, fabs(f[i] - f[0]));
  }
  for (size_t i = 1; i < count; i++) {
    s[i] = s[i - 1] +
           hypot((h[i] - h[i - 1]) / scale_h, scale_f > 0.0 ? (f[i] - f[i - 1]) / scale_f : 0.0);
  }
  enum status status = cubic_create(count, s, h, 0, &of_h, error);
  if (status == STATUS_OK) {
    status = cubic_create(count, s, f, 0, &of_force, error);
  }
  *work = 0.0;
  for (size_t i = 0; status == STATUS_OK && i + 1 < count; i++) {
    static const double place[] = {0.1127016653792583, 0.5, 0.8872983346207417};
    static const double weight[] = {5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0};
    for (int g = 0; g < 3; g++) {
      struct cubic_value a, b;
      double at = s[i] + place[g] * (s[i + 1] - s[i]);
      cubic_evaluate(&of_h, at, &a);
      cubic_evaluate(&of_force, at, &b);
      *work += weight[g] * (s[i + 1] - s[i]) * a.slope * b.value;
    }
  }
  cubic_release(&of_h);
  cubic_release(&of_force);
  free(s);
  return status;
}

/* Ends and far ends of the branches of all levels. */
static enum status place_branches(struct law *law, struct error *error) {
  int count = law->spec->table.count;
  double low = INFINITY, high = -INFINITY;
  for (int k = 0; k < count; k++) {
    const struct law_path *path = &law->path[k];
    low = fmin(low, law_path_h(path, 0));
    high = fmax(high, law_path_h(path, path->level->count - 1));
  }
  law->range[0] = low;
  law->range[1] = high;
  law->branch[0].power = law->branches;
  law->branch[1].power = 1;
  law->branch[0].far = law->branches ? low : high;
  law->branch[1].far = high;
  for (int k = 0; k < count; k++) {
    for (int side = 0; side < 2; side++) {
      const struct law_path *path = &law->path[k];
      double end = law->branches ? path->turn[side] : low;
      law->branch[side].end[k] = end;
      law->limit[side][k] = isnan(path->limit[side]) ? path->turn[side] : path->limit[side];
      if (law->branches && !(side == 0 ? end > low : end < high)) {
        return error_set(error, STATUS_INVALID, NULL,
                         "at %.6g kPa the path turns in h at %.6g mm, outside the range of the "
                         "others",
                         1e-3 * path->level->pressure, 1e3 * end);
      }
    }
  }
  return STATUS_OK;
}

/* Elastic energy at the far end of a branch, from that of the outermost point of the path. */
static double far_energy(const struct law *law, int k, const struct branch *branch, size_t at,
                         double energy) {
  const struct law_level *level = &law->spec->table.level[k];
  size_t i = law_path_index(&law->path[k], at);
  const struct cubic *force = &branch->force[k];
  struct cubic_value far;
  cubic_evaluate(force, 1.0, &far);
  return energy + 0.5 * (level->force[i] + far.value) * (branch->far - level->h[i]) +
         level->pressure * (branch->far_volume[k] - level->volume[i]);
}

/* The potential at the far ends, from the energies of the table at its pressure nearest to 0, or
 * from the work along the path there. */
static enum status fix_potentials(struct law *law, struct error *error) {
  const struct law_table *table = &law->spec->table;
  int zero = 0;
  double energy[2] = {0.0, 0.0};
  struct shares shares;
  for (int k = 1; k < table->count; k++) {
    zero = fabs(table->level[k].pressure) < fabs(table->level[zero].pressure) ? k : zero;
  }
  const struct law_level *level = &table->level[zero];
  const struct law_path *path = &law->path[zero];
  size_t end = level->count - 1, first = law_path_index(path, 0), last = law_path_index(path, end);
  if (level->energy) {
    energy[0] = level->energy[first];
    energy[1] = level->energy[last];
  } else {
    enum status status = path_work(path, &energy[1], error);
    if (status != STATUS_OK) {
      return status;
    }
    energy[1] += level->pressure * (level->volume[last] - level->volume[first]);
  }
  law_find_shares(law, level->pressure, &shares);
  for (int side = 0; side < 2; side++) {
    struct branch *branch = &law->branch[side];
    bool high = side == 1 || !law->branches;
    branch->constant = far_energy(law, zero, branch, high ? end : 0, energy[high]) -
                       level->pressure * branch->far_volume[zero];
    for (int k = 0; k < table->count; k++) {
      branch->constant += shares.integral[k] * branch->far_volume[k];
    }
    if (!law->branches) {
      break;
    }
  }
  return STATUS_OK;
}

static enum status build_table(struct law *law, struct error *error) {
  const struct law_table *table = &law->spec->table;
  enum status status = STATUS_OK;
  for (int k = 0; k < table->count && status == STATUS_OK; k++) {
    status = law_path_divide(&table->level[k], &law->path[k], error);
    law->branches = law->branches || law->path[k].folds;
    law->falls = law->falls || law->path[k].falls;
  }
  if (status == STATUS_OK) {
    status = share_pressures(law, error);
  }
  if (status == STATUS_OK) {
    status = place_branches(law, error);
  }
  for (int k = 0; k < table->count && status == STATUS_OK; k++) {
    const struct law_path *path = &law->path[k];
    size_t end = path->level->count - 1;
    if (!law->branches) {
      status = fit_level(law, k, &law->branch[0], 0, end, NULL, error);
      continue;
    }
    status = fit_level(law, k, &law->branch[0], path->last, 0, &path->force[0], error);
    if (status == STATUS_OK) {
      status = fit_level(law, k, &law->branch[1], path->first, end, &path->force[1], error);
    }
  }
  return status == STATUS_OK ? fix_potentials(law, error) : status;
}

/* ---- closed forms ------------------------------------------------------------------------- */

static double polynomial_slope(const struct law_spec *spec, double h) {
  double slope = 0.0;
  for (int i = spec->count - 1; i >= 1; i--) {
    slope = slope * h / spec->per + i * spec->c[i];
  }
  return slope / spec->per;
}

/* The zero of the slope between two elongations, where its signs differ. */
static double polynomial_turn(const struct law_spec *spec, double low, double high) {
  bool rises = polynomial_slope(spec, low) >= 0.0;
  for (int n = 0; n < BISECTIONS; n++) {
    double middle = 0.5 * (low + high);
    if ((polynomial_slope(spec, middle) >= 0.0) == rises) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return 0.5 * (low + high);
}

/* Where the force of a polynomial first ceases to rise, and where it rises again for good. */
static void scan_polynomial(struct law *law) {
  const struct law_spec *spec = law->spec;
  double step = (spec->to - spec->from) / SCAN, h[2] = {NAN, NAN};
  for (int i = 1; i < SCAN; i++) {
    double at = spec->from + i * step, slope = polynomial_slope(spec, at);
    if (isnan(h[0]) && slope < 0.0) {
      h[0] = polynomial_turn(spec, at - step, at);
    }
    if (slope < 0.0) {
      h[1] = polynomial_turn(spec, at, at + step);
    }
  }
  law->range[0] = spec->from;
  law->range[1] = spec->to;
  law->falls = !isnan(h[0]);
  law->limit[0][0] = h[0];
  law->limit[1][0] = h[1];
}

enum status law_create(const struct law_spec *spec, struct law **law, struct error *error) {
  struct law *created = calloc(1, sizeof *created);
  *law = NULL;
  if (!created) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a law");
  }
  created->spec = spec;
  enum status status = STATUS_OK;
  if (spec->is_table) {
    status = build_table(created, error);
  } else {
    scan_polynomial(created);
  }
  if (status == STATUS_OK) {
    *law = created;
  } else {
    law_destroy(created);
  }
  return status;
}

/* ---- what the table says besides ---------------------------------------------------------- */

/* Takes in the points of one side of a level. */
static void compare(const struct law *law, int k, enum law_side side, struct law_consistency *most,
                    double range[2][2]) {
  const struct law_path *path = &law->path[k];
  const struct law_level *level = path->level;
  size_t end = level->count - 1;
  size_t from = law->branches && side == LAW_STRETCHED ? path->first : 0;
  size_t to = law->branches && side == LAW_COMPRESSED ? path->last : end;
  for (size_t n = from; n <= to; n++) {
    size_t i = law_path_index(path, n);
    struct law_value value;
    law_evaluate(law, side, level->h[i], level->pressure, &value);
    double energy = value.potential + level->pressure * value.volume;
    most->volume = fmax(most->volume, fabs(value.volume - level->volume[i]));
    range[0][0] = fmin(range[0][0], level->volume[i]);
    range[0][1] = fmax(range[0][1], level->volume[i]);
    if (level->energy) {
      most->energy = fmax(most->energy, fabs(energy - level->energy[i]));
      range[1][0] = fmin(range[1][0], level->energy[i]);
      range[1][1] = fmax(range[1][1], level->energy[i]);
    }
  }
}

struct law_consistency law_check(const struct law *law) {
  struct law_consistency most = {0.0, 0.0};
  double range[2][2] = {{INFINITY, -INFINITY}, {INFINITY, -INFINITY}};
  for (int k = 0; k < law->spec->table.count; k++) {
    compare(law, k, LAW_COMPRESSED, &most, range);
    if (law->branches) {
      compare(law, k, LAW_STRETCHED, &most, range);
    }
  }
  double volumes = range[0][1] - range[0][0], energies = range[1][1] - range[1][0];
  most.volume = volumes > 0.0 ? most.volume / volumes : NAN;
  most.energy = energies > 0.0 ? most.energy / energies : NAN;
  return most;
}
