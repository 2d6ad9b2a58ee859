#include "solver/explore/pareto.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Whether a is nowhere worse than b; *better: somewhere better. */
static bool weakly_dominates(const double *a, const double *b, int objectives, bool *better) {
  *better = false;
  for (int k = 0; k < objectives; k++) {
    if (a[k] > b[k]) {
      return false;
    }
    *better = *better || a[k] < b[k];
  }
  return true;
}

static bool dominates(const double *a, const double *b, int objectives) {
  bool better;
  return weakly_dominates(a, b, objectives, &better) && better;
}

static bool all_finite(const double *y, int objectives) {
  for (int k = 0; k < objectives; k++) {
    if (!isfinite(y[k])) {
      return false;
    }
  }
  return true;
}

/* ---- fronts ------------------------------------------------------------------------------- */

struct ordered {
  const double *y;
  size_t index;
  int objectives;
};

/* By the first objective, then the second, ...: nothing is dominated by what comes after it. */
static int compare_values(const void *left, const void *right) {
  const struct ordered *a = left, *b = right;
  for (int k = 0; k < a->objectives; k++) {
    if (a->y[k] != b->y[k]) {
      return a->y[k] < b->y[k] ? -1 : 1;
    }
  }
  return a->index < b->index ? -1 : 1;
}

enum status pareto_fronts(const double *y, size_t count, int objectives, int front[],
                          struct error *error) {
  struct ordered *order = malloc((count + 1) * sizeof *order);
  size_t used = 0;
  if (!order) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the fronts");
  }
  for (size_t i = 0; i < count; i++) {
    front[i] = 0;
    if (all_finite(y + i * (size_t)objectives, objectives)) {
      order[used++] = (struct ordered){y + i * (size_t)objectives, i, objectives};
    }
  }
  qsort(order, used, sizeof *order, compare_values);
  for (size_t i = 0; i < used; i++) {
    int last = 0; /* front of what dominates it */
    for (size_t j = 0; j < i; j++) {
      int other = front[order[j].index];
      if (other > last && dominates(order[j].y, order[i].y, objectives)) {
        last = other;
      }
    }
    front[order[i].index] = last + 1;
  }
  free(order);
  return STATUS_OK;
}

/* ---- hypervolume -------------------------------------------------------------------------- */

/* Adds a point to a set of `count` points none of which dominates another, and takes away those
 * that it dominates; returns the new count. */
static size_t add_to_set(double *set, size_t count, const double *point, int objectives) {
  size_t width = (size_t)objectives, kept = 0;
  bool better;
  for (size_t i = 0; i < count; i++) {
    if (weakly_dominates(set + i * width, point, objectives, &better)) {
      return count;
    }
  }
  for (size_t i = 0; i < count; i++) {
    if (!dominates(point, set + i * width, objectives)) {
      memmove(set + kept * width, set + i * width, width * sizeof *set);
      kept++;
    }
  }
  memmove(set + kept * width, point, width * sizeof *set);
  return kept + 1;
}

static bool sum_exclusive(const double *set, size_t count, int objectives, const double *reference,
                          double *volume);

/* What the first point of a set dominates and no other one does: its box less what the others,
 * cut down to that box, dominate. */
static bool exclusive(const double *set, size_t count, int objectives, const double *reference,
                      double *volume) {
  size_t width = (size_t)objectives, limited = 0;
  double point[PARETO_OBJECTIVES_MAX], others = 0.0;
  double *rest = malloc(count * width * sizeof *rest);
  if (!rest) {
    return false;
  }
  for (size_t i = 1; i < count; i++) {
    for (size_t k = 0; k < width; k++) {
      point[k] = fmax(set[k], set[i * width + k]);
    }
    limited = add_to_set(rest, limited, point, objectives);
  }
  bool good = sum_exclusive(rest, limited, objectives, reference, &others);
  free(rest);
  *volume = 1.0;
  for (size_t k = 0; k < width; k++) {
    *volume *= reference[k] - set[k];
  }
  *volume -= others;
  return good;
}

static bool sum_exclusive(const double *set, size_t count, int objectives, const double *reference,
                          double *volume) {
  *volume = 0.0;
  for (size_t i = 0; i < count; i++) {
    double part;
    if (!exclusive(set + i * (size_t)objectives, count - i, objectives, reference, &part)) {
      return false;
    }
    *volume += part;
  }
  return true;
}

/* With the worst values of the last objective first, the others lose most when they are cut. */
static int compare_last(const void *left, const void *right) {
  const struct ordered *a = left, *b = right;
  double u = a->y[a->objectives - 1], v = b->y[b->objectives - 1];
  return u < v ? 1 : u > v ? -1 : compare_values(left, right);
}

/* The points that count, none dominated by another, in the order above. */
static bool gather(const double *y, size_t count, int objectives, const double *reference,
                   double *set, size_t *gathered) {
  size_t width = (size_t)objectives;
  double *unordered = malloc((count + 1) * width * sizeof *unordered);
  struct ordered *order = malloc((count + 1) * sizeof *order);
  *gathered = 0;
  for (size_t i = 0; unordered && order && i < count; i++) {
    bool inside = all_finite(y + i * width, objectives);
    for (size_t k = 0; k < width; k++) {
      inside = inside && y[i * width + k] < reference[k];
    }
    if (inside) {
      *gathered = add_to_set(unordered, *gathered, y + i * width, objectives);
    }
  }
  bool good = unordered && order;
  for (size_t i = 0; good && i < *gathered; i++) {
    order[i] = (struct ordered){unordered + i * width, i, objectives};
  }
  if (good) {
    qsort(order, *gathered, sizeof *order, compare_last);
    for (size_t i = 0; i < *gathered; i++) {
      memcpy(set + i * width, order[i].y, width * sizeof *set);
    }
  }
  free(order);
  free(unordered);
  return good;
}

enum status pareto_hypervolume(const double *y, size_t count, int objectives,
                               const double reference[], double *volume, struct error *error) {
  size_t gathered = 0;
  double *set = malloc((count + 1) * (size_t)objectives * sizeof *set);
  bool good = set && gather(y, count, objectives, reference, set, &gathered) &&
              sum_exclusive(set, gathered, objectives, reference, volume);
  free(set);
  return good ? STATUS_OK
              : error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the hypervolume");
}
