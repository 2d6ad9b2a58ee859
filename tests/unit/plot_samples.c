#include "tests/unit/plot_samples.h"

#include <math.h>
#include <stdlib.h>

static const double LENGTH = 118.0, WIDTH = 30.0, HEIGHT = 16.0; /* mm */

/* Point at arc length s and height z of a finger bent by `angle` radians to a circle. */
static void bend(double s, double z, double angle, double *x, double *down) {
  double theta = angle * s / LENGTH;
  double cx = angle > 1e-9 ? LENGTH / angle * sin(theta) : s;
  double cz = angle > 1e-9 ? -LENGTH / angle * (1 - cos(theta)) : 0;
  *x = cx + z * sin(theta);
  *down = cz + z * cos(theta);
}

static double angle_at(double slope, double kPa) {
  double more = kPa > 17 ? 0.12 * (kPa - 17) : 0;
  return slope * kPa * (1 - 0.0015 * kPa) + slope * more;
}

static json_t *sample(double slope, double kPa) {
  double degrees = angle_at(slope, kPa), x, z;
  bend(LENGTH, 0, degrees * M_PI / 180, &x, &z);
  return json_pack("{s:f,s:f,s:f,s:f,s:f,s:f,s:f,s:i}", "pressure_kPa", kPa, "bending_angle_deg",
                   degrees, "chord_angle_deg", degrees / 2, "end_face_angle_deg", 1.05 * degrees,
                   "tip_x_mm", x, "tip_y_mm", 0.0, "tip_z_mm", z, "newton_iterations", 4);
}

static json_t *midline(double slope, double kPa) {
  json_t *points = json_array();
  for (int i = 0; i <= 40; i++) {
    double x, z;
    bend(LENGTH * i / 40, 0, angle_at(slope, kPa) * M_PI / 180, &x, &z);
    json_array_append_new(points, json_pack("[f,f,f]", x, 0.0, z));
  }
  return json_pack("{s:f,s:o}", "pressure_kPa", kPa, "points_mm", points);
}

json_t *plot_sample_result(double slope, double top_kPa, int steps) {
  json_t *samples = json_array(), *midlines = json_array();
  for (int i = 0; i <= steps; i++) {
    double kPa = steps > 0 ? top_kPa * i / steps : top_kPa;
    json_array_append_new(samples, sample(slope, kPa));
    json_array_append_new(midlines, midline(slope, kPa));
  }
  double fitted = angle_at(slope, top_kPa) / top_kPa;
  return json_pack("{s:s,s:s,s:s,s:{s:f,s:f},s:o,s:o,s:{s:f,s:f,s:f,s:f,s:f},s:{s:s}}", "status",
                   "succeeded", "reason", "", "kind", "response", "metrics",
                   "sensitivity_deg_per_kPa", fitted, "contact_onset_kPa", 17.0, "samples", samples,
                   "midlines", midlines, "fit", "from_kPa", 0.0, "to_kPa", top_kPa,
                   "slope_deg_per_kPa", fitted, "intercept_deg", -0.6, "r_squared", 0.99912,
                   "provenance", "version", "0.1.0");
}

/* A grid of cells along the finger, of which some are solid; six axial cells a chamber, the last
 * of them the gap. */
enum { PER_CHAMBER = 6, ACROSS = 8, UP = 8, FLOOR = 3 };

static int is_solid(int chambers, int i, int j, int k) {
  int phase = i % PER_CHAMBER;
  if (i < 0 || j < 0 || k < 0 || i >= chambers * PER_CHAMBER - 1 || j >= ACROSS || k >= UP) {
    return 0;
  }
  if (k < FLOOR) {
    return 1;
  }
  if (phase == PER_CHAMBER - 1) {
    return 0;
  }
  int hollow = phase > 0 && phase < PER_CHAMBER - 2 && j > 0 && j < ACROSS - 1 && k < UP - 1;
  return !hollow;
}

static json_t *state(int chambers, double angle, double kPa) {
  json_t *points = json_array(), *stretch = json_array();
  int cells = chambers * PER_CHAMBER - 1;
  for (int i = 0; i <= cells; i++) {
    for (int j = 0; j <= ACROSS; j++) {
      for (int k = 0; k <= UP; k++) {
        double up = (double)k / UP, phase = sin(M_PI * (i % PER_CHAMBER) / (PER_CHAMBER - 1.0));
        double swell = angle * phase * phase * up, side = 2.0 * j / ACROSS - 1, x, z;
        bend(LENGTH * i / cells, HEIGHT * up * (1 + 0.08 * swell), angle, &x, &z);
        double y = WIDTH / 2 * side * (1 + 0.07 * swell);
        json_array_append_new(points, json_pack("[f,f,f]", x, y, z));
        json_array_append_new(stretch,
                              json_real(1 + 0.02 * angle + 0.3 * swell * (1 - 0.5 * side * side)));
      }
    }
  }
  return json_pack("{s:f,s:o,s:o}", "pressure_kPa", kPa, "points_mm", points, "stretch", stretch);
}

static int node(int i, int j, int k) {
  return (i * (ACROSS + 1) + j) * (UP + 1) + k;
}

/* Adds the face of cell (i, j, k) towards axis +-1 when that side is empty. */
static void add_face(json_t *quads, int chambers, const int cell[3], int axis, int side) {
  int next[3] = {cell[0], cell[1], cell[2]};
  next[axis] += side ? 1 : -1;
  if (is_solid(chambers, next[0], next[1], next[2])) {
    return;
  }
  static const int turn[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  json_t *quad = json_array();
  for (int c = 0; c < 4; c++) {
    const int *t = turn[side ? c : 3 - c];
    int at[3] = {cell[0], cell[1], cell[2]};
    at[axis] += side;
    at[(axis + 1) % 3] += t[0];
    at[(axis + 2) % 3] += t[1];
    json_array_append_new(quad, json_integer(node(at[0], at[1], at[2])));
  }
  json_array_append_new(quads, quad);
}

json_t *plot_sample_surface(int chambers, double degrees, double top_kPa) {
  json_t *quads = json_array();
  int cells = chambers * PER_CHAMBER - 1;
  for (int at = 0; at < cells * ACROSS * UP; at++) {
    int cell[3] = {at / (ACROSS * UP), at / UP % ACROSS, at % UP};
    for (int face = 0; face < 6 && is_solid(chambers, cell[0], cell[1], cell[2]); face++) {
      add_face(quads, chambers, cell, face / 2, face % 2);
    }
  }
  return json_pack("{s:o,s:[o,o]}", "quads", quads, "states", state(chambers, 0, 0),
                   state(chambers, degrees * M_PI / 180, top_kPa));
}
