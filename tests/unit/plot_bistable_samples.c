#include "tests/unit/plot_bistable_samples.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

/* The cubic h (h - 9) (h - 25), its extrema, and whether it rises there. */
static double cubic(double h) {
  return h * (h - 9) * (h - 25);
}

static double extremum(int sign) {
  return (34 + sign * sqrt(34 * 34 - 3 * 225)) / 3;
}

static bool rises(double h) {
  return h < extremum(-1) || h > extremum(1);
}

static json_t *path(const char *name, double pressure_factor, double force_factor) {
  json_t *points = json_array();
  for (int i = 0; i <= 120; i++) {
    double h = -2 + 0.25 * i;
    json_array_append_new(points,
                          json_pack("{s:f, s:f, s:f, s:f, s:b}", "pressure_kPa",
                                    pressure_factor * cubic(h), "force_N", force_factor * cubic(h),
                                    "h_mm", h, "extension_ratio", h / 60, "stable", rises(h)));
  }
  return json_pack("{s:s, s:o}", "name", name, "points", points);
}

static json_t *event(const char *on, const char *type, double pressure, double force, double h) {
  return json_pack("{s:s, s:s, s:f, s:f, s:f}", "path", on, "type", type, "pressure_kPa", pressure,
                   "force_N", force, "h_mm", h);
}

static json_t *rectangle(const char *region, double inner, double outer, double height) {
  return json_pack("{s:s, s:[[ff], [ff], [ff], [ff]]}", "region", region, "outline_mm", inner, 0.0,
                   outer, 0.0, outer, height, inner, height);
}

static json_t *shape(const char *name, double pressure, double height) {
  return json_pack("{s:s, s:f, s:f, s:[o, o]}", "name", name, "pressure_kPa", pressure, "force_N",
                   0.0, "regions", rectangle("silicone", 18, 20, height),
                   rectangle("pet", 18.9, 19.1, height));
}

static json_t *harmonics(double trigger_kPa) {
  json_t *list = json_array();
  for (int i = 0; i <= 40; i++) {
    double pressure = trigger_kPa * i / 40;
    json_t *negative = json_array();
    for (int n = 0; n <= 12; n++) {
      bool lost = (n == 9 && i > 36) || (n == 10 && i > 38) || (n == 0 && i == 40);
      json_array_append_new(negative, json_integer(lost ? 2 : 0));
    }
    json_array_append_new(list,
                          json_pack("{s:s, s:f, s:f, s:o}", "path", "pressure", "pressure_kPa",
                                    pressure, "h_mm", 0.1 * i, "negative", negative));
  }
  return list;
}

json_t *plot_sample_snap(double trigger_kPa) {
  double first = extremum(-1), second = extremum(1), factor = trigger_kPa / cubic(first);
  double release = factor * cubic(second);
  json_t *held = json_array();
  for (int i = 0; i <= 6; i++) {
    json_array_append_new(held,
                          json_pack("{s:f, s:f}", "pressure_kPa", 10.0 * i, "force_N", 8.0 * i));
  }
  json_t *events =
      json_pack("[o, o, o, o, o]", event("pressure", "limit point", trigger_kPa, 0, first),
                event("pressure", "limit point", release, 0, second),
                event("axial", "stable state", 0, 0, 0), event("axial", "stable state", 0, 0, 25),
                event("pressure", "loss of axisymmetry", 0.9 * trigger_kPa, 0, 2.6));
  return json_pack("{s:s, s:s, s:{s:f, s:f, s:f, s:f}, s:[o, o], s:o, s:o, s:[o, o, o], s:o}",
                   "status", "succeeded", "kind", "snap", "metrics", "trigger_pressure_kPa",
                   trigger_kPa, "release_pressure_kPa", release, "extension_ratio", 0.5,
                   "force_per_pressure_N_per_kPa", 0.8, "paths", path("axial", 0, 0.8 * factor),
                   path("pressure", factor, 0), "events", events, "held", held, "shapes",
                   shape("compressed", 0, 20), shape("natural", 0, 45), shape("inflated", 50, 50),
                   "harmonics", harmonics(trigger_kPa));
}

json_t *plot_sample_ladder(double trigger_kPa) {
  json_t *holds = json_array();
  bool stretched = false;
  for (int i = 0; i <= 10; i++) {
    double pressure = 10.0 * (i <= 5 ? i : 10 - i);
    stretched = stretched || pressure > trigger_kPa;
    double h = stretched ? 28 + 0.5 * pressure : 0.4 * pressure;
    json_array_append_new(holds, json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "set_point_kPa",
                                           pressure, "end_pressure_kPa", pressure, "end_h_mm", h,
                                           "end_extension_ratio", h / 82, "steady_pressure_kPa",
                                           pressure, "steady_force_N", 0.809 * pressure));
  }
  return json_pack("{s:s, s:s, s:{s:f, s:f}, s:o}", "status", "succeeded", "kind", "hlpv",
                   "metrics", "extension_ratio", 0.6, "trigger_pressure_kPa", trigger_kPa, "holds",
                   holds);
}

json_t *plot_sample_bistable_study(json_t *results[], size_t count) {
  json_t *members = json_array();
  for (size_t i = 0; i < count; i++) {
    char name[40];
    snprintf(name, sizeof name, "design %zu", i + 1);
    json_object_set_new(results[i], "name", json_string(name));
    json_array_append_new(members, results[i]);
  }
  return json_pack("{s:s, s:s, s:o}", "status", "succeeded", "kind", "study", "members", members);
}
