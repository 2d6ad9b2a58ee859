#include "tests/unit/plot_study_samples.h"

#include <math.h>
#include <stdio.h>

#include "tests/unit/plot_samples.h"

static json_t *study_of(json_t *members, json_t *parameters) {
  return json_pack("{s:s,s:s,s:s,s:{s:i},s:o,s:o,s:{s:s}}", "status", "succeeded", "reason", "",
                   "kind", "study", "metrics", "designs", (int)json_array_size(members),
                   "parameters", parameters, "members", members, "provenance", "version", "0.1.0");
}

/* A finger as a member. */
static json_t *member(size_t index, const char *name, json_t *values, double slope) {
  json_t *result = plot_sample_result(slope, 50, 10), *metrics;
  metrics = json_object_get(result, "metrics");
  json_object_set_new(metrics, "sensitivity_deg_per_kPa_error", json_real(0.03 * slope));
  json_object_set_new(metrics, "r_squared", json_real(0.99 - 0.01 * (double)(index % 4)));
  json_object_set_new(metrics, "bending_angle_deg", json_real(50 * slope));
  json_object_set_new(result, "index", json_integer((json_int_t)index));
  json_object_set_new(result, "name", json_string(name));
  json_object_set_new(result, "values", values);
  json_object_set_new(result, "same_as", json_null());
  json_object_set_new(result, "statistics",
                      json_pack("{s:f}", "unknowns", 2000 * pow(2.2, (double)index)));
  return result;
}

json_t *plot_sample_study(size_t count) {
  static const double published[3] = {1.62, 1.45, 1.22};
  json_t *members = json_array(), *paper = json_array();
  for (size_t i = 0; i < count; i++) {
    char value[32], name[64];
    snprintf(value, sizeof value, "%zu mm", i + 1);
    snprintf(name, sizeof name, "chamber gap %s", value);
    json_array_append_new(members,
                          member(i, name, json_pack("{s:s}", "/actuator/chamber_gap", value),
                                 1.2 / (0.6 + 0.14 * (double)i)));
    if (i < 3) {
      json_array_append_new(paper, json_pack("{s:i,s:s,s:f}", "member", (int)i, "metric",
                                             "sensitivity_deg_per_kPa", "value", published[i]));
    }
  }
  json_t *study = study_of(
      members, json_pack("[{s:s,s:s}]", "pointer", "/actuator/chamber_gap", "name", "chamber gap"));
  json_object_set_new(study, "published", paper);
  return study;
}

json_t *plot_sample_designs(size_t count) {
  json_t *members = json_array();
  for (size_t i = 0; i < count; i++) {
    char name[80];
    snprintf(name, sizeof name, "V%zu %c %zu deg", 1 + i / 16, (char)('A' + i / 4 % 4), 1 + i % 4);
    json_array_append_new(members,
                          member(i, name, json_pack("{s:s}", "/actuator/taper/left", name + 5),
                                 1.2 + 0.3 * sin(2.0 * (double)i)));
  }
  return study_of(members, json_array());
}

void plot_sample_rank(json_t *study, size_t count) {
  json_t *ranking = json_array(), *members = json_object_get(study, "members");
  for (size_t i = 0; i < count; i++) {
    double mean = 0.65 - 0.008 * (double)i, variance = 0.26 + 0.004 * (double)i;
    const json_t *name = json_object_get(json_array_get(members, i), "name");
    json_array_append_new(ranking, json_pack("{s:i,s:i,s:s,s:f,s:f,s:f}", "rank", (int)i + 1,
                                             "member", (int)i, "name", json_string_value(name),
                                             "mean_weighted", mean, "normalised_variance", variance,
                                             "final", 0.5 * mean + 0.5 * (1 - variance)));
  }
  json_object_set_new(study, "ranking",
                      json_pack("{s:f,s:o}", "mean_weight", 0.5, "designs", ranking));
}

/* The centreline of a body of 260 mm that bends by `bend` and drifts aside by `turn` radians. */
static json_t *curled(double bend, double turn, double *tip) {
  enum { POINTS = 60 };
  json_t *points = json_array();
  double at[3] = {0, 0, 0};
  for (int i = 0; i <= POINTS; i++) {
    json_array_append_new(points, json_pack("[f,f,f]", at[0], at[1], at[2]));
    double s = (i + 0.5) / POINTS, step = 260.0 / POINTS;
    double down = bend * s, aside = turn * s;
    for (int k = 0; k < 3; k++) {
      tip[k] = at[k];
    }
    at[0] += step * cos(down) * cos(aside);
    at[1] += step * cos(down) * sin(aside);
    at[2] -= step * sin(down);
  }
  return points;
}

/* Bends with the sum of both pressures and turns aside with their difference. */
static void add_samples(json_t *result, double left, double right, int steps) {
  json_t *samples = json_array(), *midlines = json_array();
  for (int i = 0; i <= steps; i++) {
    double share = (double)i / steps, kPa = share * fmax(left, right), tip[3];
    double bend = 3.2 * pow(share * (left + right) / 160, 1.6);
    double turn = 2.0 * pow(share * fabs(left - right) / 80, 1.4) * (left > right ? -1 : 1);
    json_t *points = curled(bend, turn, tip);
    double reach = sqrt(tip[0] * tip[0] + tip[1] * tip[1] + tip[2] * tip[2]);
    json_array_append_new(samples,
                          json_pack("{s:f,s:f,s:f,s:f,s:f,s:f,s:f}", "pressure_kPa", kPa,
                                    "bending_angle_deg", bend * 57.3, "twist_angle_deg",
                                    turn * 57.3, "contraction_pct", 100 * (1 - reach / 256),
                                    "tip_x_mm", tip[0], "tip_y_mm", tip[1], "tip_z_mm", tip[2]));
    json_array_append_new(midlines,
                          json_pack("{s:f,s:o}", "pressure_kPa", kPa, "points_mm", points));
  }
  json_object_set_new(result, "samples", samples);
  json_object_set_new(result, "midlines", midlines);
}

json_t *plot_sample_grid(int side) {
  json_t *members = json_array();
  for (int l = 0; l < side; l++) {
    for (int r = 0; r < side; r++) {
      double left = 80.0 * l / fmax(side - 1, 1), right = 80.0 * r / fmax(side - 1, 1);
      char texts[2][24], name[80];
      snprintf(texts[0], sizeof texts[0], "%g kPa", left);
      snprintf(texts[1], sizeof texts[1], "%g kPa", right);
      snprintf(name, sizeof name, "left %s, right %s", texts[0], texts[1]);
      json_t *one = json_pack("{s:s,s:s,s:{s:s,s:s},s:{s:f}}", "status", "succeeded", "name", name,
                              "values", "/load/pressure/left", texts[0], "/load/pressure/right",
                              texts[1], "metrics", "twist_angle_deg", left - right);
      add_samples(one, left, right, 8);
      json_array_append_new(members, one);
    }
  }
  json_t *study = study_of(members, json_pack("[{s:s,s:s},{s:s,s:s}]", "pointer",
                                              "/load/pressure/left", "name", "left row", "pointer",
                                              "/load/pressure/right", "name", "right row"));
  return study;
}

json_t *plot_sample_spatial(double twist_deg) {
  json_t *result = json_pack("{s:s,s:s,s:{s:f}}", "status", "succeeded", "kind", "response",
                             "metrics", "twist_angle_deg", twist_deg);
  add_samples(result, 80, 80 - 80 * twist_deg / 115, 8);
  return result;
}

void plot_sample_meshes(json_t *study) {
  json_t *members = json_object_get(study, "members");
  for (size_t i = 0; i < json_array_size(members); i++) {
    json_t *member = json_array_get(members, i), *metrics = json_object_get(member, "metrics");
    json_object_set_new(member, "values", json_pack("{s:s}", "/mesh/size", "1 mm"));
    json_object_set_new(member, "name", json_sprintf("%g mm", 4 - 0.5 * (double)i));
    json_object_set_new(metrics, "bending_angle_deg", json_real(64 + 8 * pow(0.5, (double)i)));
  }
}

void plot_sample_suckers(json_t *study) {
  json_t *members = json_object_get(study, "members");
  for (size_t i = 0; i < json_array_size(members); i++) {
    json_t *member = json_array_get(members, i), *metrics = json_object_get(member, "metrics");
    json_object_set_new(member, "values", json_pack("{s:[]}", "/actuator/suckers"));
    json_object_set_new(metrics, "suction_force_N", json_real(5.5 * (double)i));
    json_object_set_new(metrics, "sucker_count", json_integer((json_int_t)i));
    json_object_set_new(metrics, "bending_angle_deg", json_real(64 - 1.5 * (double)i));
  }
}
