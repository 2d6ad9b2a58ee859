#include "solver/identify/start.h"

#include <math.h>
#include <stdlib.h>

#include "solver/base/numbers.h"

/* ---- noise -------------------------------------------------------------------------------- */

/* Standard deviation of a column; difference: room for its second differences. Those of white noise
 * have a variance of 6, and half of a normal distribution lies within 0.6745 of its deviation. */
static double column_noise(const double *time, const double *value, size_t count,
                           double *difference) {
  size_t n = 0;
  for (size_t i = 1; i + 1 < count; i++) {
    double before = time[i] - time[i - 1], after = time[i + 1] - time[i];
    if (fabs(after - before) < 0.01 * before) {
      difference[n++] = fabs(value[i + 1] - 2.0 * value[i] + value[i - 1]);
    }
  }
  qsort(difference, n, sizeof *difference, numbers_compare);
  return n > 0 ? difference[n / 2] / (0.6745 * sqrt(6.0)) : 0.0;
}

enum status start_noise(struct identification *id, struct error *error) {
  size_t longest = 0;
  for (size_t i = 0; i < id->trials->count; i++) {
    longest = id->trials->trial[i].count > longest ? id->trials->trial[i].count : longest;
  }
  double *difference = malloc(longest * sizeof *difference);
  if (!difference) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the noise");
  }
  for (size_t i = 0; i < id->trials->count; i++) {
    const struct trial *trial = &id->trials->trial[i];
    const double *const value[2] = {trial->h, trial->pressure};
    for (int q = 0; q < 2; q++) {
      double given = id->spec->noise[q], least = 1e-3 * id->steps->range[q];
      double found = column_noise(trial->time, value[q], trial->count, difference);
      id->sigma[2 * i + (size_t)q] = given > 0.0 ? given : fmax(found, least);
    }
  }
  free(difference);
  return STATUS_OK;
}

/* ---- the pressure ------------------------------------------------------------------------- */

/* Rows of a step until four times the time in which the pressure goes 63 % of its way. */
static size_t transient_rows(const double *time, const double *p, size_t count, double *way) {
  size_t tail = count - count / 5 - 1, last = count;
  double end = 0.0;
  for (size_t i = tail; i < count; i++) {
    end += p[i] / (double)(count - tail);
  }
  while (last > 1 && fabs(p[last - 1] - end) < 0.37 * fabs(p[0] - end)) {
    last--;
  }
  *way = (last < count ? time[last] : time[count - 1]) - time[0];
  size_t rows = last;
  while (rows < count && (rows < 6 || time[rows] - time[0] <= 4.0 * *way)) {
    rows++;
  }
  return rows;
}

/* Sums of a regression of y on two columns, with a constant of its own for each step. */
struct sums {
  double aa, ab, bb, ay, by;
};

/* p - mean = alpha (integral of p - mean) + beta u (t - mean). */
static void add_pressure(struct sums *sums, const double *time, const double *p, size_t rows) {
  double integral = 0.0, mean[3] = {0.0, 0.0, 0.0}, n = (double)rows;
  for (int pass = 0; pass < 2; pass++) {
    integral = 0.0;
    for (size_t i = 0; i < rows; i++) {
      integral += i > 0 ? 0.5 * (p[i] + p[i - 1]) * (time[i] - time[i - 1]) : 0.0;
      double a = integral - mean[0], b = time[i] - mean[1], y = p[i] - mean[2];
      if (pass == 1) {
        sums->aa += a * a;
        sums->ab += a * b;
        sums->bb += b * b;
        sums->ay += a * y;
        sums->by += b * y;
      }
    }
    for (size_t i = 0; pass == 0 && i < rows; i++) {
      mean[1] += time[i] / n;
      mean[2] += p[i] / n;
    }
    double sum = 0.0;
    for (size_t i = 0; pass == 0 && i < rows; i++) {
      sum += i > 0 ? 0.5 * (p[i] + p[i - 1]) * (time[i] - time[i - 1]) : 0.0;
      mean[0] += sum / n;
    }
  }
}

static void start_pressure(const struct identification *id, size_t index) {
  const struct point *point = &id->point[index];
  struct sums s = {0};
  double u = point->set_point, way_sum = 0.0, end = 0.0, moving = 0.0;
  for (size_t i = 0; i < point->step_count; i++) {
    const struct step *step = point->step[i];
    const struct trial *trial = &id->trials->trial[step->trial];
    const double *time = trial->time + step->first, *p = trial->pressure + step->first;
    if (step->moves) {
      double way;
      size_t rows = transient_rows(time, p, step->count, &way);
      add_pressure(&s, time, p, rows);
      way_sum += way;
      end += p[step->count - 1];
      moving += 1.0;
    }
  }
  double slow = moving > 0.0 && way_sum > 0.0 ? -moving / way_sum : -1.0;
  double determinant = s.aa * s.bb - s.ab * s.ab, *value = id->estimate[index].value;
  double alpha = u == 0.0 ? s.ay / s.aa : (s.ay * s.bb - s.by * s.ab) / determinant;
  double beta = u == 0.0 ? 0.0 : (s.aa * s.by - s.ab * s.ay) / determinant / u;
  bool usable = isfinite(alpha) && alpha < 0.1 * slow && alpha > 10.0 * slow && isfinite(beta);
  value[IDENTIFY_ALPHA] = usable ? alpha : slow;
  value[IDENTIFY_BETA] = u == 0.0 ? -value[IDENTIFY_ALPHA]
                         : usable ? beta
                                  : -slow * (moving > 0.0 ? end / moving / u : 1.0);
}

/* ---- compliance and rest ------------------------------------------------------------------ */

/* Compliance dh/dp of a point: through the rest of its mode, or where that is NAN with a constant
 * of its own, which is then in *rest with its weight. */
static double compliance(const struct identification *id, size_t index, double given, double *rest,
                         double *weight) {
  const struct point *point = &id->point[index];
  double n = 0.0, mp = 0.0, mh = 0.0, pp = 0.0, ph = 0.0;
  for (int pass = 0; pass < 2; pass++) {
    for (size_t i = 0; i < point->step_count; i++) {
      const struct step *step = point->step[i];
      const struct trial *trial = &id->trials->trial[step->trial];
      for (size_t k = step->first; k < step->first + step->count; k++) {
        double p = trial->pressure[k], h = trial->h[k];
        n += pass == 0;
        mp += pass == 0 ? p : 0.0;
        mh += pass == 0 ? h : 0.0;
        pp += pass == 1 ? (p - mp) * (p - mp) : 0.0;
        ph += pass == 1 ? (p - mp) * (h - mh) : 0.0;
      }
    }
    mp = pass == 1 ? mp : isnan(given) ? mp / n : 0.0;
    mh = pass == 1 ? mh : isnan(given) ? mh / n : given;
  }
  double slope = ph / pp, least = 1e-3 * id->steps->range[0] / id->steps->range[1];
  slope = slope > least ? slope : least;
  *rest = mh - slope * mp;
  *weight = pp;
  return slope;
}

static void start_rest(struct identification *id) {
  for (int mode = 0; mode < id->spec->mode_count; mode++) {
    double sum = 0.0, total = 0.0, rest, weight;
    for (size_t i = 0; i < id->point_count; i++) {
      if (id->point[i].mode == mode) {
        compliance(id, i, NAN, &rest, &weight);
        sum += weight * rest;
        total += weight;
      }
    }
    id->rest[mode].free = isnan(id->spec->mode[mode].rest);
    id->rest[mode].value = id->rest[mode].free ? sum / total : id->spec->mode[mode].rest;
  }
}

/* ---- the motion of the mass --------------------------------------------------------------- */

static enum status cost(struct identification *id, size_t index, double *sum, struct error *error) {
  double parameter[POINT_PARAMETERS];
  struct point *point = &id->point[index];
  identification_parameters(id, index, parameter);
  enum status status =
      point_evaluate(point, id->trials, id->sigma, parameter, false, id->response, error);
  *sum = 0.0;
  for (size_t i = 0; i < point->rows; i++) {
    *sum += point->residual[i] * point->residual[i];
  }
  return status;
}

/* Stiffness and damping of a point from compliance, gamma and mass. */
static void set_motion(struct identification *id, size_t index, double slope, double ratio) {
  double k = id->gamma.value / slope, *value = id->estimate[index].value;
  value[IDENTIFY_STIFFNESS] = k;
  value[IDENTIFY_DAMPING] = 2.0 * ratio * sqrt(k * id->mass.value);
}

/* Whether a sum of squares is less by more than noise makes it, of all the swings that fit noise.
 */
static bool is_better(double sum, double best, const struct point *point) {
  return sum < best - IDENTIFY_SURE * fmax(1.0, sum / (double)point->rows);
}

/* The damping ratio of a point under which it fits best, left in its values; the cost in *best. */
static enum status scan_damping(struct identification *id, size_t index, double slope, double *best,
                                double *ratio, struct error *error) {
  static const double ratios[] = {0.7, 4.0, 0.1};
  *best = INFINITY;
  for (size_t i = 0; i < sizeof ratios / sizeof *ratios; i++) {
    double sum;
    set_motion(id, index, slope, ratios[i]);
    enum status status = cost(id, index, &sum, error);
    if (status != STATUS_OK) {
      return status;
    }
    if (is_better(sum, *best, &id->point[index])) {
      *best = sum;
      *ratio = ratios[i];
    }
  }
  set_motion(id, index, slope, *ratio);
  return STATUS_OK;
}

/* Mass or gamma so that a point has the frequency (rad/s). */
static void set_frequency(struct identification *id, double slope, double frequency) {
  double square = frequency * frequency;
  if (id->gamma.free) {
    id->gamma.value = slope * id->mass.value * square;
  } else {
    id->mass.value = id->gamma.value / slope / square;
  }
}

static double shortest_interval(const struct point *point) {
  double shortest = INFINITY;
  for (size_t i = 1; i < point->time_count; i++) {
    shortest = fmin(shortest, point->time[i] - point->time[i - 1]);
  }
  return shortest;
}

/* The frequency under which the point with the widest motion fits best. */
static enum status scan_frequency(struct identification *id, const double *slope,
                                  struct error *error) {
  enum { FREQUENCIES = 10 };
  size_t widest = 0;
  for (size_t i = 0; i < id->point_count; i++) {
    widest = fabs(id->point[i].set_point) > fabs(id->point[widest].set_point) ? i : widest;
  }
  double low = -0.3 * id->estimate[widest].value[IDENTIFY_ALPHA];
  double high = 6.0 / shortest_interval(&id->point[widest]), least = INFINITY, found = high;
  high = high > 10.0 * low ? high : 10.0 * low;
  for (int i = 0; i < FREQUENCIES; i++) {
    double frequency = high * pow(low / high, (double)i / (FREQUENCIES - 1)), best, ratio;
    set_frequency(id, slope[widest], frequency);
    enum status status = scan_damping(id, widest, slope[widest], &best, &ratio, error);
    if (status != STATUS_OK) {
      return status;
    }
    if (is_better(best, least, &id->point[widest])) {
      least = best;
      found = frequency;
    }
  }
  set_frequency(id, slope[widest], found);
  return STATUS_OK;
}

enum status start_values(struct identification *id, struct error *error) {
  double slope[STEP_POINTS_MAX], rest, weight, best, ratio;
  start_rest(id);
  for (size_t i = 0; i < id->point_count; i++) {
    start_pressure(id, i);
    slope[i] = compliance(id, i, id->rest[id->point[i].mode].value, &rest, &weight);
  }
  enum status status =
      id->gamma.free || id->mass.free ? scan_frequency(id, slope, error) : STATUS_OK;
  for (size_t i = 0; i < id->point_count && status == STATUS_OK; i++) {
    status = scan_damping(id, i, slope[i], &best, &ratio, error);
  }
  return status;
}
