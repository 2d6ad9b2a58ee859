/* Meshes of bellows: what they enclose, how they lie, how they are held. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/axi/element.h"
#include "solver/snap/bellows.h"
#include "solver/snap/carry.h"
#include "tests/physics/snap_case.h"
#include "tests/unit/suite.h"

static const double deg = M_PI / 180.0;

static const struct {
  const char *actuator;
  int snapping, sheets;
} bodies[] = {
    {"", 1, 3},
    {", \"pairs\": 3", 3, 7},
    {", \"ends\": \"plates\"", 1, 3},
    {", \"ends\": \"plates\", \"pairs\": 3, \"supporting_pet\": \"4 mm\"", 3, 7},
    {", \"supporting_pet\": \"2 mm\"", 1, 2},
    {", \"supporting_pet\": \"6 mm\", \"hinge_length\": \"2 mm\"", 1, 3},
    {", \"hinge_wall\": \"1.2 mm\", \"pairs\": 2, \"imperfection\": {\"pet_thickness\": [0.8, "
     "1.2], "
     "\"snapping_angle\": [1.05, 1], \"snapping_slant\": [1, 1.1]}",
     2, 5},
    {", \"ends\": \"plates\", \"pairs\": 2, \"supporting_slant\": \"7 mm\"", 2, 5},
};
enum { BODIES = sizeof bodies / sizeof *bodies };

static void build(const char *actuator, enum accuracy accuracy, struct job_spec *job,
                  struct bellows *b) {
  struct error error;
  struct bellows_fineness fineness = bellows_fineness(accuracy);
  snap_case_must_read(actuator, "", job);
  ck_assert_int_eq(bellows_create(job->snap, &fineness, b, &error), STATUS_OK);
}

static void element_nodes(const struct axi_mesh *mesh, int e, double x[AXI_NODES][2]) {
  for (int a = 0; a < AXI_NODES; a++) {
    x[a][0] = mesh->position[2 * mesh->element[e].node[a]];
    x[a][1] = mesh->position[2 * mesh->element[e].node[a] + 1];
  }
}

/* Volume of the elements of a region, -1 for all; asserts that none is turned inside out. */
static double volume(const struct axi_mesh *mesh, int region) {
  double sum = 0.0;
  for (int e = 0; e < mesh->element_count; e++) {
    double x[AXI_NODES][2];
    struct axi_geometry g;
    element_nodes(mesh, e, x);
    ck_assert_msg(axi_geometry_init(x, &g), "element %d", e);
    for (int q = 0; q < AXI_POINTS; q++) {
      ck_assert_double_gt(g.point[q].weight, 0.0);
      sum += region < 0 || mesh->element[e].region == region ? g.point[q].weight : 0.0;
    }
  }
  return sum;
}

/* Integral of pi r^2 dz along edges, upwards for the outer ones. */
static double enclosed(const struct axi_mesh *mesh, const struct axi_edge *edge, int count) {
  double sum = 0.0, gradient[AXI_EDGE_DOFS];
  for (int k = 0; k < count; k++) {
    double x[AXI_EDGE_NODES][2];
    for (int a = 0; a < AXI_EDGE_NODES; a++) {
      x[a][0] = mesh->position[2 * edge[k].node[a]];
      x[a][1] = mesh->position[2 * edge[k].node[a] + 1];
    }
    sum += axi_edge_volume(x, gradient, NULL);
  }
  return fabs(sum);
}

/* Guldin's rule for one period: 2 pi times the sum of area times radius of the centroid. */
static double by_guldin(const struct snap_spec *s, double thickness, bool shells_only) {
  double a = s->given.snapping_angle, b = s->supporting_angle, turn = M_PI - a - b;
  double q = s->hinge_length / turn, r0 = s->crest_radius;
  double slant = s->pair[0].snapping_slant, support = s->pair[0].supporting_slant;
  double top = r0 - q * (1.0 - sin(a)); /* outer end of the snapping shell */
  double low = top - slant * cos(a);    /* inner end */
  double shells = slant * (top - 0.5 * slant * cos(a)) +
                  support * (r0 - q * (1.0 - sin(b)) - 0.5 * support * cos(b));
  double sum = shells * thickness;
  if (!shells_only) {
    /* Sectors of rings about the centres of the arcs; the direction of the bisector. */
    double ro = q + 0.5 * thickness, ri = q - 0.5 * thickness;
    double arm = 2.0 / 3.0 * (ro * ro * ro - ri * ri * ri) / (ro * ro - ri * ri) * sin(0.5 * turn) /
                 (0.5 * turn);
    double tilt = cos(0.5 * (a - b)), area = turn * q * thickness;
    double outer = r0 - q, inner = low + q * sin(a); /* radii of the centres */
    sum += area * (outer + arm * tilt) + area * (inner - arm * tilt);
  }
  return 2.0 * M_PI * sum;
}

START_TEST(the_wall_has_the_volume_of_guldin) {
  static const double tolerance[] = {1e-4, 1e-5, 1e-6};
  for (int k = ACCURACY_FAST; k <= ACCURACY_FINE; k++) {
    struct job_spec job;
    struct bellows b;
    build("", (enum accuracy)k, &job, &b);
    double exact = by_guldin(job.snap, job.snap->wall, false);
    ck_assert_double_eq_tol(volume(&b.mesh, -1) / exact, 1.0, tolerance[k]);
    double pet = by_guldin(job.snap, job.snap->given.pet_thickness, true);
    ck_assert_double_eq_tol(volume(&b.mesh, BELLOWS_PET) / pet, 1.0, 1e-12);
    bellows_release(&b);
    job_spec_release(&job);
  }
}
END_TEST

START_TEST(wall_and_cavity_fill_the_outside) {
  for (int k = 0; k < BODIES; k++) {
    struct job_spec job;
    struct bellows b;
    build(bodies[k].actuator, ACCURACY_STANDARD, &job, &b);
    double wall = volume(&b.mesh, -1);
    const struct axi_mesh *m = &b.mesh;
    double inner = enclosed(m, m->inner, m->inner_count);
    double outer = enclosed(m, m->outer, m->outer_count);
    /* The cuts of a row are cones, equal ones at both ends; those between plates are flat. */
    ck_assert_double_eq_tol((outer - inner) / wall, 1.0, 1e-10);
    bellows_release(&b);
    job_spec_release(&job);
  }
}
END_TEST

START_TEST(the_cavity_is_on_the_right_of_the_inner_edges) {
  struct job_spec job;
  struct bellows b;
  build(", \"pairs\": 2", ACCURACY_FAST, &job, &b);
  double inner[2] = {0}, outer[2] = {0};
  for (int i = 0; i < b.mesh.inner_count; i++) {
    const int *n = b.mesh.inner[i].node, *o = b.mesh.outer[i].node;
    for (int k = 0; k < 2; k++) {
      inner[k] += b.mesh.position[2 * n[1] + k] - b.mesh.position[2 * n[0] + k];
      outer[k] += b.mesh.position[2 * o[1] + k] - b.mesh.position[2 * o[0] + k];
    }
  }
  ck_assert_double_eq_tol(inner[1], -b.line.length, 1e-12);
  ck_assert_double_eq_tol(outer[1], b.line.length, 1e-12);
  ck_assert_double_eq_tol(inner[0], 0.0, 1e-12);
  bellows_release(&b);
  job_spec_release(&job);
}
END_TEST

START_TEST(crests_angles_and_lengths_are_those_of_the_job) {
  for (int k = 0; k < BODIES; k++) {
    struct job_spec job;
    struct bellows b;
    build(bodies[k].actuator, ACCURACY_FINE, &job, &b);
    double widest = 0.0;
    for (int n = 0; n < b.mesh.node_count; n++) {
      widest = fmax(widest, b.mesh.position[2 * n]);
    }
    if (isnan(job.snap->given.supporting_slant)) {
      /* Where a hinge is thinner than the shells, the widest place is beside its crest. */
      double thinner = job.snap->wall - job.snap->hinge_wall;
      ck_assert_double_eq_tol(widest, 20e-3, 0.03e-3 + 0.1 * thinner);
    }
    for (int p = 0; p < bodies[k].snapping; p++) {
      ck_assert_double_eq_tol(bellows_shell_angle(&b, p, NULL), job.snap->pair[p].snapping_angle,
                              1e-12);
    }
    ck_assert_double_eq_tol(
        b.line.length,
        b.mesh.position[2 * bellows_node(&b, b.row_count - 1, b.core_from) + 1] -
            b.mesh.position[2 * bellows_node(&b, 0, b.core_from) + 1],
        1e-12);
    ck_assert_int_eq(b.sheet_count, bodies[k].sheets);
    ck_assert_int_eq(bellows_inverted(&b, job.snap->pair_count, NULL), 0);
    bellows_release(&b);
    job_spec_release(&job);
  }
}
END_TEST

START_TEST(a_pair_is_as_long_as_its_parts) {
  struct job_spec job;
  struct bellows b;
  build("", ACCURACY_FAST, &job, &b);
  const struct snap_spec *s = job.snap;
  double q = 3e-3 / (85.0 * deg);
  double length = 5e-3 * sin(40.0 * deg) + s->pair[0].supporting_slant * sin(55.0 * deg) +
                  2.0 * q * (cos(40.0 * deg) + cos(55.0 * deg));
  ck_assert_double_eq_tol(b.line.length, length, 1e-12);
  bellows_release(&b);
  job_spec_release(&job);
}
END_TEST

/* Whether the straight parts p q and s t of the outline cross. */
static bool cross(const double p[2], const double q[2], const double s[2], const double t[2]) {
  double d[2] = {q[0] - p[0], q[1] - p[1]}, e[2] = {t[0] - s[0], t[1] - s[1]};
  double a = d[0] * (s[1] - p[1]) - d[1] * (s[0] - p[0]);
  double b = d[0] * (t[1] - p[1]) - d[1] * (t[0] - p[0]);
  double c = e[0] * (p[1] - s[1]) - e[1] * (p[0] - s[0]);
  double f = e[0] * (q[1] - s[1]) - e[1] * (q[0] - s[0]);
  return a * b < 0.0 && c * f < 0.0;
}

START_TEST(walls_do_not_overlap) {
  for (int k = 0; k < BODIES; k++) {
    struct job_spec job;
    struct bellows b;
    build(bodies[k].actuator, ACCURACY_FAST, &job, &b);
    const double *x = b.mesh.position;
    const int columns[2] = {0, b.column_count - 1};
    for (int c = 0; c < 4; c++) {
      for (int i = 0; i + 1 < b.row_count; i++) {
        for (int j = 0; j + 1 < b.row_count; j++) {
          const double *p = x + 2 * bellows_node(&b, i, columns[c / 2]);
          const double *q = x + 2 * bellows_node(&b, i + 1, columns[c / 2]);
          const double *s = x + 2 * bellows_node(&b, j, columns[c % 2]);
          const double *t = x + 2 * bellows_node(&b, j + 1, columns[c % 2]);
          ck_assert(!cross(p, q, s, t));
          ck_assert_double_gt(p[0], 0.0);
        }
      }
    }
    bellows_release(&b);
    job_spec_release(&job);
  }
}
END_TEST

START_TEST(ends_are_held_as_asked) {
  struct job_spec job;
  struct bellows b;
  build("", ACCURACY_FAST, &job, &b);
  int fixed = 0, ahead = 0;
  for (int n = 0; n < b.mesh.node_count; n++) {
    fixed += b.mesh.hold[2 * n] == AXI_FIXED;
    fixed += b.mesh.hold[2 * n + 1] == AXI_FIXED;
    if (b.mesh.hold[2 * n + 1] == AXI_AHEAD) {
      int master = b.mesh.master[n];
      ahead++;
      ck_assert_int_eq(b.mesh.hold[2 * n], AXI_TIED);
      ck_assert_double_eq_tol(b.mesh.position[2 * n], b.mesh.position[2 * master], 1e-15);
      ck_assert_double_eq_tol(b.mesh.position[2 * n + 1],
                              b.mesh.position[2 * master + 1] + b.line.length, 1e-15);
    }
  }
  ck_assert_int_eq(fixed, 1);
  ck_assert_int_eq(ahead, b.column_count);
  bellows_release(&b);
  job_spec_release(&job);
  build(", \"ends\": \"plates\"", ACCURACY_FAST, &job, &b);
  int last = b.row_count - 1;
  for (int j = 0; j < b.column_count; j++) {
    int low = bellows_node(&b, 0, j), high = bellows_node(&b, last, j);
    ck_assert_double_eq_tol(b.mesh.position[2 * low + 1], 0.0, 1e-15);
    ck_assert_double_eq_tol(b.mesh.position[2 * high + 1], b.line.length, 1e-15);
    ck_assert_int_eq(b.mesh.hold[2 * low + 1], AXI_FIXED);
    ck_assert_int_eq(b.mesh.hold[2 * high + 1], AXI_PLATE);
  }
  bellows_release(&b);
  job_spec_release(&job);
}
END_TEST

/* ---- jobs --------------------------------------------------------------------------------- */

static const struct {
  const char *actuator, *job, *pointer, *phrase;
} refused[] = {
    {", \"hinge_length\": \"1.5 mm\"", "", "/actuator/hinge_length", "too short"},
    {", \"hinge_length\": \"1 um\"", "", "/actuator/hinge_length", "1.562 mm"},
    {", \"pairs\": 64", "", "/actuator/pairs", "from 1 to 8"},
    {", \"hinge_wall\": \"0.3 mm\"", "", "/actuator/hinge_wall", "at least 0.35 mm"},
    {", \"supporting_slant\": \"8 mm\"", "", "/actuator/supporting_slant", "7.921371 mm"},
    {", \"supporting_pet\": \"9 mm\"", "", "/actuator/supporting_pet", "do not fit"},
    {", \"supporting_pet\": \"0.1 mm\"", "", "/actuator/supporting_pet", "too short"},
    {", \"imperfection\": {\"pet_thickness\": [1, 2]}", "", "/actuator/imperfection/pet_thickness",
     "2 factors for 1 pair"},
    {", \"imperfection\": {\"snapping_angle\": [1.5]}", "",
     "/actuator/imperfection/snapping_angle/0", "steep"},
    {", \"imperfection\": {\"snapping_slant\": [0]}", "", "/actuator/imperfection/snapping_slant/0",
     "0.5"},
    {"", ", \"load\": {\"law\": [\"5 kPa\", \"3 kPa\"]}", "/load/law/1", "must rise"},
    {", \"pairs\": 2", ", \"load\": {\"law\": [\"5 kPa\"]}", "/load/law", "one pair"},
    {"", ", \"load\": {\"extension_at\": \"70 kPa\"}", "/load/extension_at", "60 kPa"},
    {"", ", \"load\": {\"vacuum_to\": \"5 kPa\"}", "/load/vacuum_to", "0 kPa"},
    {"", ", \"pet\": {\"poisson_ratio\": 0.5}", "/pet/poisson_ratio", "0.4999"},
    {"", ", \"pet\": {\"modulus\": \"3 mm\"}", "/pet/modulus", "GPa"},
    {"",
     ", \"calibrate\": {\"pointer\": \"/actuator/wall\", \"target\": \"34.9 kPa\", \"from\": "
     "\"1 mm\", \"to\": \"2 mm\"}",
     "/calibrate/pointer", "/actuator/hinge_wall"},
    {"",
     ", \"calibrate\": {\"pointer\": \"/actuator/snapping_slant\", \"target\": \"34.9 mm\", "
     "\"from\": \"4 mm\", \"to\": \"6 mm\"}",
     "/calibrate/target", "pressure"},
    {"",
     ", \"calibrate\": {\"pointer\": \"/actuator/snapping_slant\", \"target\": \"34.9 kPa\", "
     "\"from\": \"6 mm\", \"to\": \"4 mm\"}",
     "/calibrate/to", "not above"},
    {"",
     ", \"calibrate\": {\"pointer\": \"/actuator/snapping_slant\", \"target\": \"34.9 kPa\", "
     "\"from\": \"4 mm\", \"to\": \"60 mm\"}",
     "/calibrate/to", "across the axis"},
    {"",
     ", \"calibrate\": {\"pointer\": \"/pet/modulus\", \"target\": \"34.9 kPa\", "
     "\"from\": \"-1 GPa\", \"to\": \"3 GPa\"}",
     "/calibrate/from", "positive"},
};

START_TEST(impossible_bodies_are_refused) {
  struct job_spec job;
  struct error error;
  enum status status = snap_case_read(refused[_i].actuator, refused[_i].job, &job, &error);
  ck_assert(status == STATUS_INVALID || status == STATUS_GEOMETRY);
  ck_assert_str_eq(error.pointer, refused[_i].pointer);
  ck_assert_msg(strstr(error.message, refused[_i].phrase) != NULL, "%s", error.message);
}
END_TEST

/* Replaces a length of the form's job. */
static const struct {
  const char *key, *value, *pointer, *phrase;
} replaced[] = {
    {"snapping_angle", "60 deg", "/actuator/snapping_angle", "than the 55 deg"},
    {"snapping_slant", "25 mm", "/actuator/snapping_slant", "21.3503 mm"},
    {"snapping_slant", "0.01 mm", "/actuator/snapping_slant", "too short"},
    {"outer_diameter", "8 mm", "/actuator/snapping_slant", "across the axis"},
    {"outer_diameter", "4 mm", "/actuator/outer_diameter", "too narrow"},
    {"pet_thickness", "3 mm", "/actuator/wall", "at least 3.1 mm"},
    {"pet_thickness", "2 mm", "/actuator/wall", "at least 2.1 mm"},
    {"pet_thickness", "2", "/actuator/pet_thickness", "unit"},
};

START_TEST(dimensions_that_exclude_each_other_are_refused) {
  struct job_spec job;
  struct error error = {.status = STATUS_OK};
  json_t *document = json_loads(
      "{\"kind\": \"snap\", \"actuator\": {\"family\": \"frustum-bellows\", \"outer_diameter\": "
      "\"40 mm\", \"wall\": \"2 mm\", \"snapping_angle\": \"40 deg\", \"supporting_angle\": "
      "\"55 deg\", \"snapping_slant\": \"5 mm\", \"pet_thickness\": \"0.25 mm\"}, \"silicone\": "
      "\"dragon-skin-20\"}",
      0, NULL);
  bool bare = replaced[_i].value[1] == '\0';
  json_object_set_new(json_object_get(document, "actuator"), replaced[_i].key,
                      bare ? json_integer(2) : json_string(replaced[_i].value));
  char *text = json_dumps(document, 0);
  enum status status = job_spec_read(text, strlen(text), &job, &error);
  ck_assert(status == STATUS_INVALID || status == STATUS_GEOMETRY);
  ck_assert_str_eq(error.pointer, replaced[_i].pointer);
  ck_assert_msg(strstr(error.message, replaced[_i].phrase) != NULL, "%s", error.message);
  free(text);
  json_decref(document);
}
END_TEST

static const char *const files[] = {"20A-0.18", "20A-0.25",           "30A-0.18",
                                    "30A-0.25", "20A-0.25-calibrate", "20A-0.25-actuator"};

/* One body but for the PET, the silicone and the number that is fitted. */
START_TEST(the_jobs_of_the_project_are_of_one_body) {
  static char text[1 << 14];
  const char *source = getenv("srcdir");
  char name[600];
  snprintf(name, sizeof name, "%s/jobs/beast/snap-%s.json", source ? source : ".", files[_i]);
  FILE *file = fopen(name, "rb");
  ck_assert_msg(file != NULL, "%s cannot be opened", name);
  size_t size = fread(text, 1, sizeof text - 1, file);
  fclose(file);
  struct job_spec job;
  struct error error = {.status = STATUS_OK};
  ck_assert_msg(job_spec_read(text, size, &job, &error) == STATUS_OK, "%s: %s", error.pointer,
                error.message);
  const struct snap_spec *s = job.snap;
  bool hard = strncmp(files[_i], "30A", 3) == 0, thin = strstr(files[_i], "0.18") != NULL;
  suite_check_near(s->crest_radius, 19e-3);
  suite_check_near(s->silicone.c[0], hard ? 0.34e6 : 0.19e6);
  suite_check_near(s->given.pet_thickness, thin ? 0.18e-3 : 0.25e-3);
  suite_check_near(s->given.hinge_length, 3e-3);
  ck_assert_double_eq_tol(s->given.snapping_slant, s->calibrate.asked ? 5e-3 : 5.173e-3, 1e-9);
  ck_assert_double_eq_tol(s->rest_length * 3.0 / s->pair_count, 82e-3, 0.02e-3);
  job_spec_release(&job);
}
END_TEST

START_TEST(a_job_arrives_in_si_units) {
  struct job_spec job;
  snap_case_must_read(", \"pairs\": 2, \"rest_length\": \"82 mm\", \"imperfection\": "
                      "{\"snapping_slant\": [1, 1.1]}",
                      ", \"load\": {\"pressure_to\": \"8 psi\", \"vacuum_to\": \"-20 kPa\"}, "
                      "\"pet\": {\"modulus\": \"3 GPa\", \"poisson_ratio\": 0.39}, \"harmonics\": "
                      "{\"to\": 4}, \"contact\": false, \"calibrate\": {\"pointer\": "
                      "\"/actuator/snapping_angle\", \"metric\": \"travel_per_pair_mm\", "
                      "\"target\": \"8 mm\", \"from\": \"38 deg\", \"to\": \"42 deg\"}",
                      &job);
  struct snap_spec *s = job.snap;
  ck_assert_int_eq(job.kind, JOB_SNAP);
  suite_check_near(s->pressure_to, 8.0 * 6894.757293168361);
  suite_check_near(s->extension_at, s->pressure_to);
  suite_check_near(s->vacuum_to, -20e3);
  suite_check_near(s->rest_length, 0.082);
  suite_check_near(s->crest_radius, 0.019);
  suite_check_near(s->pair[1].snapping_slant, 5.5e-3);
  suite_check_near(s->pet.c[0], 3e9 / 2.78);
  suite_check_near(s->pet.bulk_ratio * s->pet.c[0], 3e9 / 0.66);
  ck_assert(!s->contact && s->harmonics_to == 4 && s->model == SNAP_SOLID);
  suite_check_near(s->calibrate.target, 8e-3);
  suite_check_near(s->calibrate.to, 42.0 * deg);
  double before = s->pair[0].supporting_slant;
  struct error error;
  ck_assert_int_eq(snap_set(s, 41.0 * deg, &error), STATUS_OK);
  suite_check_near(s->pair[1].snapping_angle, 41.0 * deg);
  ck_assert_double_lt(s->pair[0].supporting_slant, before);
  job_spec_release(&job);
}
END_TEST

/* What is linear along the axis is carried over exactly: a row stretched as one, whatever the
 * meshes; and on meshes alike every pair moves as the one, on top of those below. */
START_TEST(a_pair_is_carried_to_a_row) {
  struct job_spec one, row;
  struct bellows from, to;
  struct error error;
  double h = 2e-3, elongation = 0.0;
  build("", ACCURACY_FAST, &one, &from);
  build(", \"pairs\": 3", ACCURACY_FAST, &row, &to);
  double *u = calloc(2 * (size_t)from.mesh.node_count, sizeof *u);
  double *v = calloc(2 * (size_t)to.mesh.node_count, sizeof *v);
  int rows = from.row_count - 1, columns = from.column_count;
  for (int i = 0; i < from.mesh.node_count; i++) {
    double z = from.mesh.position[2 * i + 1];
    u[2 * i] = 1e-4 * sin(2.0 * M_PI * (i / columns) / rows);
    u[2 * i + 1] = h * z / from.line.length;
  }
  ck_assert_int_eq(carry_pair(&from, u, h, &to, v, &elongation, &error), STATUS_OK);
  suite_check_near(elongation, 3.0 * h);
  double base = v[2 * bellows_node(&to, 0, columns / 2) + 1];
  double low = u[2 * (columns / 2) + 1];
  for (int i = 0; i < to.mesh.node_count; i++) {
    int place = i / columns, pair = place / rows, column = i % columns;
    if (place == to.row_count - 1) {
      pair--;
    }
    int same = bellows_node(&from, place - pair * rows, column);
    ck_assert_double_eq_tol(v[2 * i], u[2 * same], 1e-9);
    ck_assert_double_eq_tol(v[2 * i + 1] - base, u[2 * same + 1] - low + pair * h, 1e-9);
  }
  free(u);
  free(v);
  bellows_release(&from);
  bellows_release(&to);
  job_spec_release(&one);
  job_spec_release(&row);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("snap: bellows");
  TCase *shapes = tcase_create("shapes"), *jobs = tcase_create("jobs");
  tcase_add_test(shapes, the_wall_has_the_volume_of_guldin);
  tcase_add_test(shapes, wall_and_cavity_fill_the_outside);
  tcase_add_test(shapes, the_cavity_is_on_the_right_of_the_inner_edges);
  tcase_add_test(shapes, crests_angles_and_lengths_are_those_of_the_job);
  tcase_add_test(shapes, a_pair_is_as_long_as_its_parts);
  tcase_add_test(shapes, walls_do_not_overlap);
  tcase_add_test(shapes, ends_are_held_as_asked);
  tcase_add_test(shapes, a_pair_is_carried_to_a_row);
  tcase_add_test(jobs, a_job_arrives_in_si_units);
  tcase_add_loop_test(jobs, the_jobs_of_the_project_are_of_one_body, 0,
                      (int)(sizeof files / sizeof *files));
  tcase_add_loop_test(jobs, impossible_bodies_are_refused, 0,
                      (int)(sizeof refused / sizeof *refused));
  tcase_add_loop_test(jobs, dimensions_that_exclude_each_other_are_refused, 0,
                      (int)(sizeof replaced / sizeof *replaced));
  suite_add_tcase(suite, shapes);
  suite_add_tcase(suite, jobs);
  return suite_run(suite);
}
