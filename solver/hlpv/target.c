#include "solver/hlpv/target.h"

#include <math.h>
#include "solver/hlpv/linear.h"

enum { HALVINGS = 60 };

static double set_point_of(const struct target_map *map, double place) {
  return map->lowest + (map->highest - map->lowest) * place / (TARGET_POINTS - 1);
}

/* Elongation at rest, or NAN where there is none or a guard comes before it. */
static double rest_before_guards(const struct target_map *map, int mode, double set_point) {
  double x[HLPV_STATES];
  if (!linear_rest(map->spec, mode, set_point, x)) {
    return NAN;
  }
  for (int i = 0; i < map->spec->transition_count; i++) {
    const struct hlpv_transition *t = &map->spec->transition[i];
    double room = t->quantity == HLPV_H ? map->margin : 0.0;
    if (t->from == mode && t->direction * (x[t->quantity] - t->level) > -room) {
      return NAN;
    }
  }
  return x[HLPV_H];
}

void target_map_fill(struct target_map *map, const struct hlpv_spec *spec, double lowest,
                     double highest, double margin) {
  map->spec = spec;
  map->lowest = lowest;
  map->highest = highest;
  map->margin = margin;
  for (int mode = 0; mode < spec->mode_count; mode++) {
    for (int i = 0; i < TARGET_POINTS; i++) {
      map->h[mode][i] = rest_before_guards(map, mode, set_point_of(map, i));
    }
  }
}

/* Halves the interval of the map in which h is passed. */
static double invert(const struct target_map *map, int mode, double h, int place) {
  double low = place, high = place + 1, x[HLPV_STATES] = {0};
  bool rising = map->h[mode][place + 1] > map->h[mode][place];
  for (int n = 0; n < HALVINGS; n++) {
    double middle = 0.5 * (low + high);
    linear_rest(map->spec, mode, set_point_of(map, middle), x);
    *((x[HLPV_H] < h) == rising ? &low : &high) = middle;
  }
  return set_point_of(map, 0.5 * (low + high));
}

/* Looks in one mode; *distance: by how much the target found misses h. */
static bool find_in(const struct target_map *map, int mode, double h, double *distance,
                    struct target *target) {
  const double *rest = map->h[mode];
  *distance = INFINITY;
  for (int i = 0; i < TARGET_POINTS; i++) {
    if (fabs(rest[i] - h) < *distance) {
      *distance = fabs(rest[i] - h);
      *target = (struct target){.mode = mode, .h = rest[i], .set_point = set_point_of(map, i)};
    }
  }
  for (int i = 0; i + 1 < TARGET_POINTS; i++) {
    if ((rest[i] - h) * (rest[i + 1] - h) <= 0.0) {
      *target = (struct target){
          .mode = mode, .h = h, .set_point = invert(map, mode, h, i), .reached = true};
      *distance = 0.0;
      return true;
    }
  }
  return isfinite(*distance);
}

/* Modes in the order of the switches that lead there, and the first of these. */
struct ways {
  int mode[HLPV_MODES_MAX], through[HLPV_MODES_MAX], count;
};

static void find_ways(const struct hlpv_spec *spec, int mode, struct ways *ways) {
  bool seen[HLPV_MODES_MAX] = {false};
  *ways = (struct ways){.mode = {mode}, .through = {-1}, .count = 1};
  seen[mode] = true;
  for (int i = 0; i < ways->count; i++) {
    for (int k = 0; k < spec->transition_count; k++) {
      const struct hlpv_transition *t = &spec->transition[k];
      if (t->from == ways->mode[i] && !seen[t->to]) {
        seen[t->to] = true;
        ways->mode[ways->count] = t->to;
        ways->through[ways->count++] = i == 0 ? k : ways->through[i];
      }
    }
  }
}

bool target_find(const struct target_map *map, int mode, double h, struct target *target) {
  double least = INFINITY, distance;
  struct ways ways;
  find_ways(map->spec, mode, &ways);
  for (int i = 0; i < ways.count && least > 0.0; i++) {
    struct target other;
    if (find_in(map, ways.mode[i], h, &distance, &other) && distance < least) {
      *target = other;
      target->through = ways.through[i];
      least = distance;
    }
  }
  return isfinite(least);
}
