#include "tests/unit/plot_bistable_samples.h"

#include <math.h>
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

/* A value with its interval. */
static json_t *interval(double set_point, double value, double half) {
  return json_pack("{s:f, s:f, s:f, s:f}", "set_point_kPa", set_point, "value", value, "low",
                   value - half, "high", value + half);
}

static json_t *identified_mode(const char *name, double stiffness, double slope) {
  static const char *const keys[4] = {"stiffness_N_m", "damping_N_s_m", "alpha_1_s", "beta_1_s"};
  json_t *points = json_array(), *polynomials = json_object();
  for (int i = 1; i <= 5; i++) {
    double u = 10.0 * i;
    const double values[4] = {stiffness + slope * u, 20, -9, 9};
    json_t *point = json_pack("{s:f}", "set_point_kPa", u);
    for (int k = 0; k < 4; k++) {
      json_object_set_new(point, keys[k], interval(u, values[k], k == 1 && i == 1 ? 400 : 1));
    }
    json_array_append_new(points, point);
  }
  for (int k = 0; k < 4; k++) {
    const double values[4] = {stiffness, 20, -9, 9};
    json_t *band = json_array();
    for (int i = 0; i <= 40; i++) {
      double u = 10 + i, value = values[k] + (k == 0 ? slope * u : 0);
      json_array_append_new(band, interval(u, value, 0.02 * value));
    }
    json_object_set_new(polynomials, keys[k], json_pack("{s:o}", "band", band));
  }
  return json_pack("{s:s, s:o, s:o}", "name", name, "points", points, "polynomials", polynomials);
}

static json_t *measured_trial(int number) {
  double set_point = 10.0 * (1 + number % 3);
  bool held_out = number % 3 == 2;
  json_t *samples = json_array();
  char name[20];
  snprintf(name, sizeof name, "%d", number + 1);
  for (int i = 0; i <= 400; i++) {
    double t = 0.05 * i, p = set_point * (t < 10 ? 1 - exp(-2 * t) : exp(-2 * (t - 10)));
    json_array_append_new(
        samples, json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "time_s", t, "set_point_kPa",
                           t < 10 ? set_point : 0.0, "h_mm", 0.5 * p + held_out, "pressure_kPa", p,
                           "simulated_h_mm", 0.5 * p, "simulated_pressure_kPa", p));
  }
  return json_pack("{s:s, s:b, s:o}", "name", name, "held_out", held_out, "samples", samples);
}

json_t *plot_sample_identify(void) {
  json_t *trials = json_array();
  for (int i = 0; i < 9; i++) {
    json_array_append_new(trials, measured_trial(i));
  }
  return json_pack("{s:s, s:s, s:{s:f, s:f}, s:[o, o], s:o}", "status", "succeeded", "kind",
                   "identify", "metrics", "held_out_r_squared_h", 0.99,
                   "held_out_r_squared_pressure", 0.98, "modes",
                   identified_mode("compressed", 6000, -50), identified_mode("stretched", 2000, 0),
                   "trials", trials);
}

json_t *plot_sample_motion(bool load) {
  json_t *samples = json_array(), *events = json_array();
  for (int i = 0; i <= 800; i++) {
    double t = 0.005 * i, h = 0;
    json_t *sample = json_pack("{s:f, s:f, s:f, s:i}", "time_s", t, "set_point_kPa", 40.0,
                               "pressure_kPa", 10.0 * t, "stretched_cells", t < 3 ? (int)t : 3);
    for (int cell = 0; cell < 3; cell++) {
      char key[20];
      double since = t - 1 - cell, own = since > 0 ? 10 * (1 - exp(-40 * since)) : 0;
      snprintf(key, sizeof key, "cell_%d_mm", cell + 1);
      json_object_set_new(sample, key, json_real(own));
      h += own;
    }
    json_object_set_new(sample, "h_mm", json_real(h));
    json_object_set_new(sample, "velocity_m_s", json_real(exp(-40 * fmod(t, 1))));
    if (load) {
      json_object_set_new(sample, "bending_angle_deg", json_real(2 * h));
      json_object_set_new(sample, "set_point_2_kPa", json_real(20));
      json_object_set_new(sample, "pressure_2_kPa", json_real(5 * t));
      json_object_set_new(sample, "load_h_mm", json_real(h + 1));
      json_object_set_new(sample, "load_velocity_m_s", json_real(0.1));
    }
    json_array_append_new(samples, sample);
  }
  for (int cell = 0; cell < 3; cell++) {
    json_array_append_new(events, json_pack("{s:s, s:f, s:f, s:f, s:f, s:f}", "type", "snap",
                                            "time_s", 1.0 + cell, "trigger_time_s", 0.99 + cell,
                                            "peak_time_s", 1.02 + cell, "peak_speed_m_s",
                                            1.0 + cell, "snap_time_s", 0.05));
    json_array_append_new(events, json_pack("{s:s, s:f}", "type", "stop", "time_s", 1.5 + cell));
  }
  return json_pack("{s:s, s:s, s:o, s:o}", "status", "succeeded", "kind", "bistable", "samples",
                   samples, "events", events);
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
