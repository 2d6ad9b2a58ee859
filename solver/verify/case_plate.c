/* Bodies under a rigid plate, in plane strain: the crushed rubber cylinder, and Hertz's line
 * contact. */
#include <math.h>
#include "solver/verify/cases.h"
#include "solver/verify/plane_contact.h"

/* ---- crushed cylinder: a quarter of a disc of radius 0.2 m ---- */

static const double disc_radius = 0.2, disc_depth = 0.02;

/* Three blocks: an inner quadrilateral and two between it and the arc. */
static void disc_map(const void *context, int block, const double s[3], double x[3]) {
  static const double a = 0.5, b = 0.42; /* corners (a, 0), (b, b), (0, a) of the inner block */
  (void)context;
  double inner[2], outer[2], blend = 0;
  if (block == 0) {
    inner[0] = s[0] * (a + (b - a) * s[1]);
    inner[1] = s[1] * (a + (b - a) * s[0]);
    outer[0] = outer[1] = 0;
  } else {
    /* Along the inner block's side and along the arc: t from the axis to the diagonal. */
    double t = block == 1 ? s[1] : 1 - s[1], angle = 0.25 * M_PI * t;
    double side[2] = {a + (b - a) * t, b * t}, arc[2] = {cos(angle), sin(angle)};
    int first = block == 1 ? 0 : 1;
    inner[first] = side[0];
    inner[1 - first] = side[1];
    outer[first] = arc[0];
    outer[1 - first] = arc[1];
    blend = s[0];
  }
  for (int i = 0; i < 2; i++) {
    x[i] = disc_radius * ((1 - blend) * inner[i] + blend * outer[i]);
  }
  x[2] = disc_depth * s[2];
}

/* Force on the whole cylinder per length in kN/mm at the crush (m), twice the plate's way. */
static const struct { double crush, force; } published[] = {{0.114, 0.343}, {0.200, 1.418}};

static enum status crush(struct verify_run *run, struct verify_body *b, struct error *error) {
  struct plate plate;
  enum status status = plate_open(&plate, b, disc_radius, run, error);
  verify_points_clear(run);
  plate.penalty = true;
  for (int k = 0; status == STATUS_OK && k < 2; k++) {
    const int steps = 10;
    double from = k == 0 ? 0 : published[k - 1].crush, to = published[k].crush;
    for (int i = 1; status == STATUS_OK && i <= steps; i++) {
      double way = from + (to - from) * i / steps;
      status = plate_move(&plate, disc_radius - 0.5 * way, error);
      double force = 2 * plate.force / disc_depth * 1e-6;
      verify_point(run, 1e3 * way, force, i == steps ? published[k].force : NAN);
      verify_result(run, force, published[k].force, 0);
    }
  }
  plate_close(&plate);
  return status;
}

enum status case_crushed_cylinder(struct verify_run *run, struct error *error) {
  static const int cells[] = {4, 6, 8, 12};
  const double c10 = 0.293e6, c01 = 0.177e6, bulk = 1410e6;
  struct material_spec material = {.model = MATERIAL_MOONEY_RIVLIN,
                                   .terms = 2,
                                   .c = {c10, c01},
                                   .bulk_ratio = bulk / (2 * (c10 + c01))};
  enum status status = STATUS_OK;
  for (int k = 0; status == STATUS_OK && k < run->refinement && k < 4; k++) {
    int n = cells[k];
    struct body body = {.blocks = 3, .cells = {n, n, 1}, .map = disc_map};
    struct verify_body b = {.model = NULL};
    status = body_build(&body, &b.mesh);
    if (status == STATUS_OK) {
      b.mesh.wall_thickness = disc_radius / 25000; /* the scale of the contact's stiffness */
      body_hold(&b.mesh, 0, 0, HOLD_X);
      body_hold(&b.mesh, 1, 0, HOLD_Y);
      body_hold(&b.mesh, -1, 0, HOLD_Z);
      status = verify_body_open(&b, &material, false, error);
    }
    if (status == STATUS_OK) {
      status = crush(run, &b, error);
    }
    if (status == STATUS_OK) {
      verify_row(run, 1.0 / n, run->report.computed, run->report.error, b.model,
                 "3 blocks of %d x %d", n, n);
    }
    verify_body_close(run, &b);
  }
  if (status == STATUS_OK) {
    verify_metric(run, "worst_error_percent", 100 * verify_points_worst(run));
  }
  return status;
}

/* ---- Hertz: a block of 1 x 1 with the top y = 1 - x^2 / 2, radius of curvature 1 ---- */

static const double hertz_depth = 0.02;
static const double hertz_half_width = 0.02; /* of the contact that the last step is to reach */

/* Half of the elements share twice the half width of the contact, the others grow away from it. */
static double graded(double s) {
  const double near = 4 * hertz_half_width;
  return near * s + (1 - near) * pow(fmax(0, 2 * s - 1), 3);
}

static void punch_map(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  x[0] = graded(s[0]);
  x[1] = (1 - graded(1 - s[1])) * (1 - 0.5 * x[0] * x[0]);
  x[2] = hertz_depth * s[2];
}

/* Half width from the second moment of the pressure, F b^2 / 4 for Hertz's semi-ellipse: it takes
 * in all of the profile. */
static double half_width_of(const struct plate *plate) {
  double force = 0, moment = 0;
  for (int f = 0; f < plate->body->model->contact.face_count; f++) {
    struct plate_share share = plate_face_share(plate, f);
    force += share.force;
    moment += share.force * share.square;
  }
  return 2 * sqrt(moment / force);
}

/* Integral of the semi-ellipse sqrt(1 - t^2) from 0 to t. */
static double ellipse(double t) {
  t = fmin(t, 1);
  return 0.5 * (t * sqrt(1 - t * t) + asin(t));
}

/* Mean pressure of every face that is wholly in contact, relative to the largest one. */
static void record_profile(struct verify_run *run, const struct plate *plate, double peak,
                           double half_width) {
  verify_points_clear(run);
  for (int f = 0; f < plate->body->model->contact.face_count; f++) {
    struct plate_share share = plate_face_share(plate, f);
    double left = share.left / half_width, right = share.right / half_width;
    if (share.force > 0 && right < 1) {
      double width = hertz_depth * half_width * (right - left);
      verify_point(run, 0.5 * (left + right), share.force / (width * peak),
                   (ellipse(right) - ellipse(left)) / (right - left));
    }
  }
}

static enum status press(struct verify_run *run, struct verify_body *b, double modulus, int n,
                         struct error *error) {
  struct plate plate;
  enum status status = plate_open(&plate, b, 1, run, error);
  double wanted = M_PI * modulus * hertz_half_width * hertz_half_width / 4;
  if (status == STATUS_OK) {
    plate.solver->options.traction_tolerance = 1e-5 * modulus;
    /* Small against the depth of the contact, or the pressure reaches beyond its edge. */
    b->model->contact.smoothing = 0.01 * hertz_half_width * hertz_half_width / 2;
  }
  /* The way is sought that gives the half width wanted; force grows about linearly with it. */
  for (int k = 0; status == STATUS_OK && 2 * plate.force / hertz_depth < wanted && k < 60; k++) {
    status = plate_move(&plate, plate.at - 1e-4, error);
  }
  if (status == STATUS_OK) {
    double force = 2 * plate.force / hertz_depth; /* of the whole body per length */
    double peak = sqrt(force * modulus / M_PI), half_width = sqrt(4 * force / (M_PI * modulus));
    double found_width = half_width_of(&plate), found = 2 * force / (M_PI * found_width);
    record_profile(run, &plate, peak, half_width);
    verify_result(run, found / modulus, peak / modulus, 0);
    verify_row(run, 1.0 / n, found / modulus, run->report.error, b->model, "%d x %d, graded", n, n);
    verify_row_other(run, fabs(found_width / half_width - 1));
  }
  plate_close(&plate);
  return status;
}

enum status case_hertz(struct verify_run *run, struct error *error) {
  static const int cells[] = {8, 12, 16, 24};
  const struct material_spec material = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 1000};
  double mu = material.c[0], kappa = mu * material.bulk_ratio;
  double modulus = 4 * mu * (3 * kappa + mu) / (3 * kappa + 4 * mu); /* E / (1 - nu^2) */
  enum status status = STATUS_OK;
  for (int k = 0; status == STATUS_OK && k < run->refinement && k < 4; k++) {
    int n = cells[k];
    struct body body = {.blocks = 1, .cells = {n, n, 1}, .map = punch_map};
    struct verify_body b = {.model = NULL};
    status = body_build(&body, &b.mesh);
    if (status == STATUS_OK) {
      b.mesh.wall_thickness = hertz_half_width;
      body_hold(&b.mesh, 0, 0, HOLD_X);
      body_hold(&b.mesh, 1, 0, HOLD_Y);
      body_hold(&b.mesh, -1, 0, HOLD_Z);
      status = verify_body_open(&b, &material, false, error);
    }
    if (status == STATUS_OK) {
      status = press(run, &b, modulus, n, error);
    }
    verify_body_close(run, &b);
  }
  return status;
}
