/* Paths that start from those of neighbouring designs: the same answers for less work. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "solver/fe/section_form.h"
#include "solver/base/vec3.h"
#include "solver/fe/warm.h"
#include "tests/physics/pneunet_case.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

enum { STEPS = 4 };

static void warm_spec(struct job_spec *spec) {
  case_prototype(spec, 3);
  spec->mesh = (struct mesh_spec){2, 1, 1, 1, 1, 1, 1, 1};
  spec->contact = true;
  spec->load = (struct load_spec){.pressure_to = 40e3, .steps = STEPS};
}

/* What a path has shown. */
struct walked {
  struct path_record *record; /* filled unless NULL */
  const struct mesh *mesh;
  int count, factorizations;
  double pressure[STEPS + 1], angle[STEPS + 1];
};

static enum status note(void *context, const struct path_point *point) {
  struct walked *w = context;
  if (!point->recorded) {
    return STATUS_OK;
  }
  ck_assert_int_le(w->count, STEPS);
  w->pressure[w->count] = point->pressure;
  w->angle[w->count++] = case_angle(w->mesh, point->state->u);
  return w->record ? path_record_add(w->record, point->pressure, point->state) : STATUS_OK;
}

/* Walks the path of a design, from `from` or, without it, cold. Returns whether it was warm; with
 * `keep` not NULL the caller gets the record of the path. */
static bool walk(const struct job_spec *spec, const struct path_record *from,
                 struct path_record **keep, struct walked *w) {
  struct pneunet_case c;
  struct error error = {0};
  bool warm = false;
  case_open(&c, spec);
  /* A path that ends a little below the onset of contact differs within this tolerance. */
  c.solver->options.traction_tolerance *= 0.1;
  *w = (struct walked){.mesh = &c.mesh};
  if (keep) {
    ck_assert_int_eq(path_record_create(c.model, &w->record), STATUS_OK);
    *keep = w->record;
  }
  struct path_options path = {
      .pressure_to = spec->load.pressure_to, .steps = STEPS, .visit = note, .context = w};
  enum status status = from ? path_follow_warm(c.solver, &path, from, &c.state, &warm, &error)
                            : path_follow(c.solver, &path, &c.state, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  ck_assert_int_eq(w->count, STEPS + 1);
  w->factorizations = c.model->statistics.factorizations;
  /* The walk leaves the state of the highest load. */
  ck_assert_double_eq(case_angle(&c.mesh, c.state.u), w->angle[STEPS]);
  case_close(&c);
  return warm;
}

static void check_same(const struct walked *a, const struct walked *b, double tolerance) {
  for (int k = 0; k <= STEPS; k++) {
    ck_assert_double_eq_tol(a->pressure[k], b->pressure[k], 1e-9 * a->pressure[STEPS]);
    ck_assert_double_le(fabs(a->angle[k] - b->angle[k]), tolerance * fabs(a->angle[STEPS]));
  }
}

/* ---- warm starts ---- */

/* The states of the same design are already those that are looked for. */
START_TEST(same_design) {
  struct job_spec spec;
  struct path_record *record;
  struct walked cold, warm;
  warm_spec(&spec);
  walk(&spec, NULL, &record, &cold);
  ck_assert(walk(&spec, record, NULL, &warm));
  check_same(&cold, &warm, 1e-4);
  printf("same design: %d factorisations cold, %d warm\n", cold.factorizations,
         warm.factorizations);
  ck_assert_int_le(warm.factorizations, STEPS);
  path_record_destroy(record);
}
END_TEST

START_TEST(neighbouring_designs) {
  static const char *const name[] = {"gap wall + 5 %", "height - 5 %",   "bottom + 5 %",
                                     "width - 5 %",    "gap wall - 5 %", "modulus + 5 %"};
  struct job_spec spec;
  struct path_record *record;
  struct walked first;
  int cold_work = 0, warm_work = 0;
  warm_spec(&spec);
  walk(&spec, NULL, &record, &first);
  for (int k = 0; k < (SANITIZED ? 4 : 6); k++) {
    struct job_spec other = spec;
    struct pneunet_spec *p = &other.pneunet;
    struct walked cold, warm;
    double wall = p->gap_wall;
    p->gap_wall *= k == 0 ? 1.05 : k == 4 ? 0.95 : 1;
    p->length += 2 * p->chamber_count * (p->gap_wall - wall);
    p->height_base = p->height_tip *= k == 1 ? 0.95 : 1;
    p->bottom_layer *= k == 2 ? 1.05 : 1;
    p->width *= k == 3 ? 0.95 : 1;
    other.material.c[0] *= k == 5 ? 1.05 : 1;
    walk(&other, NULL, NULL, &cold);
    bool was_warm = walk(&other, record, NULL, &warm);
    ck_assert_msg(was_warm, "%s was not warm", name[k]);
    report_check("3 chambers, warm against cold, degrees", name[k], cold.angle[STEPS],
                 warm.angle[STEPS], 1e-3);
    check_same(&cold, &warm, 1e-3);
    ck_assert_double_gt(fabs(cold.angle[STEPS] / first.angle[STEPS] - 1), 2e-3);
    cold_work += cold.factorizations;
    warm_work += warm.factorizations;
  }
  printf("neighbours: %d factorisations cold, %d warm\n", cold_work, warm_work);
  ck_assert_int_lt(warm_work, cold_work);
  path_record_destroy(record);
}
END_TEST

/* Other steps and other loads than the record has. */
START_TEST(other_pressures) {
  static const double pressure[2] = {30e3, 44e3};
  struct job_spec spec;
  struct path_record *record;
  struct walked cold, warm;
  warm_spec(&spec);
  walk(&spec, NULL, &record, &cold);
  for (int k = 0; k < 2; k++) {
    spec.load.pressure_to = pressure[k];
    walk(&spec, NULL, NULL, &cold);
    walk(&spec, record, NULL, &warm);
    check_same(&cold, &warm, 1e-3);
  }
  path_record_destroy(record);
}
END_TEST

/* Another number of chambers does not fit; states of no body at all fit, but lead nowhere. Both
 * are solved cold: the same numbers, and no claim of a warm start. A design far away gets its own
 * numbers, whichever way. */
START_TEST(useless_records) {
  struct job_spec spec, other, far;
  struct path_record *record;
  struct walked first, cold, warm;
  struct pneunet_case c;
  warm_spec(&spec);
  walk(&spec, NULL, &record, &first);
  other = spec;
  other.pneunet.chamber_count = other.pneunet.runs[0].count = 2;
  other.pneunet.length = 0.018;
  case_open(&c, &other);
  ck_assert(!path_record_fits(record, c.model));
  case_close(&c);
  walk(&other, NULL, NULL, &cold);
  ck_assert(!walk(&other, record, NULL, &warm));
  check_same(&cold, &warm, 0);
  ck_assert_int_eq(warm.factorizations, cold.factorizations);

  far = spec;
  far.pneunet.bottom_layer *= 1.6;
  far.pneunet.top_wall *= 2;
  far.material.c[0] *= 2;
  walk(&far, NULL, NULL, &cold);
  walk(&far, record, NULL, &warm);
  check_same(&cold, &warm, 1e-3);

  far = spec;
  for (int i = 0; i < record->count; i++) { /* states of no body at all */
    for (int d = 0; d < 3 * record->node_count; d++) {
      record->state[i].u[d] += 5e-3 * sin(37.0 * d);
    }
  }
  walk(&far, NULL, NULL, &cold);
  ck_assert(!walk(&far, record, NULL, &warm));
  check_same(&cold, &warm, 1e-3);
  path_record_destroy(record);
}
END_TEST

/* ---- files ---- */

struct scratch {
  char directory[40], path[60];
};

static void scratch_open(struct scratch *s) {
  strcpy(s->directory, "/tmp/test-warm-XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(s->directory));
  snprintf(s->path, sizeof s->path, "%s/a.path", s->directory);
}

static void scratch_close(const struct scratch *s) {
  remove(s->path);
  ck_assert_int_eq(rmdir(s->directory), 0); /* nothing else was left there */
}

/* A small record with numbers of all kinds. */
static struct path_record *small_record(void) {
  struct job_spec spec;
  struct pneunet_case c;
  struct path_record *record;
  case_prototype(&spec, 1);
  spec.mesh = (struct mesh_spec){1, 1, 1, 1, 1, 1, 1, 1};
  case_open(&c, &spec);
  ck_assert_int_eq(path_record_create(c.model, &record), STATUS_OK);
  for (int k = 0; k < 11; k++) {
    for (int d = 0; d < 3 * c.mesh.node_count; d++) {
      c.state.u[d] = 1e-3 * sin(d + k) / (1 + d);
    }
    for (int d = 0; d < ELEMENT_PRESSURES * c.mesh.element_count; d++) {
      c.state.p[d] = -1e5 * cos(d + 3 * k);
    }
    for (int i = 0; i < c.model->contact.point_count; i++) {
      c.state.lambda[i] = i % 3 == 0 ? 17.0 * k : 0;
    }
    ck_assert_int_eq(path_record_add(record, 1e3 * k, &c.state), STATUS_OK);
  }
  case_close(&c);
  return record;
}

START_TEST(file_gives_back_the_record) {
  struct scratch s;
  struct error error = {0};
  struct path_record *a = small_record(), *b;
  scratch_open(&s);
  for (int pass = 0; pass < 2; pass++) { /* a file that is there is replaced */
    ck_assert_int_eq(path_record_write(a, s.path, &error), STATUS_OK);
  }
  ck_assert_int_eq(path_record_read(s.path, &b, &error), STATUS_OK);
  ck_assert_int_eq(a->node_count, b->node_count);
  ck_assert_int_eq(a->element_count, b->element_count);
  ck_assert_int_eq(a->section_count, b->section_count);
  ck_assert_int_eq(a->point_count, b->point_count);
  ck_assert_int_eq(a->count, b->count);
  ck_assert_mem_eq(a->x, b->x, sizeof *a->x * 3 * (size_t)a->node_count);
  for (int k = 0; k < a->count; k++) {
    const struct fe_state *p = &a->state[k], *q = &b->state[k];
    ck_assert_double_eq(a->pressure[k], b->pressure[k]);
    ck_assert_mem_eq(p->u, q->u, sizeof *p->u * 3 * (size_t)a->node_count);
    ck_assert_mem_eq(p->p, q->p, sizeof *p->p * ELEMENT_PRESSURES * (size_t)a->element_count);
    ck_assert_mem_eq(p->lambda, q->lambda, sizeof *p->lambda * (size_t)a->point_count);
  }
  path_record_destroy(a);
  path_record_destroy(b);
  path_record_destroy(NULL);
  scratch_close(&s);
}
END_TEST

static void check_refused(const struct scratch *s) {
  struct path_record *record;
  struct error error = {0};
  ck_assert_int_eq(path_record_read(s->path, &record, &error), STATUS_IO);
  ck_assert_ptr_null(record);
  ck_assert_int_eq(error.status, STATUS_IO);
  ck_assert_uint_gt(strlen(error.message), 10);
}

static void write_bytes(const struct scratch *s, const unsigned char *data, size_t size) {
  FILE *file = fopen(s->path, "wb");
  ck_assert_ptr_nonnull(file);
  ck_assert_uint_eq(fwrite(data, 1, size, file), size);
  ck_assert_int_eq(fclose(file), 0);
}

/* Every cut, and every wrong byte of the head, is refused with a message. */
START_TEST(damaged_files_are_refused) {
  enum { HEAD = 40 };
  struct scratch s;
  struct error error = {0};
  struct path_record *record = small_record();
  scratch_open(&s);
  check_refused(&s); /* there is none yet */
  ck_assert_int_eq(path_record_write(record, s.path, &error), STATUS_OK);
  FILE *file = fopen(s.path, "rb");
  ck_assert_ptr_nonnull(file);
  size_t size = 0, room = 1 << 24;
  unsigned char *data = malloc(room);
  ck_assert_ptr_nonnull(data);
  size = fread(data, 1, room, file);
  fclose(file);
  ck_assert_uint_gt(size, HEAD);
  ck_assert_uint_lt(size, room);
  for (size_t length = 0; length < size; length += length < 2 * HEAD ? 1 : size / 23) {
    write_bytes(&s, data, length);
    check_refused(&s);
  }
  write_bytes(&s, data, size - 1);
  check_refused(&s);
  for (int byte = 0; byte < 16; byte++) { /* magic, byte order, version */
    data[byte] ^= 0x21;
    write_bytes(&s, data, size);
    check_refused(&s);
    data[byte] ^= 0x21;
  }
  for (int count = 0; count < 5; count++) { /* negative, and far more than there is */
    for (int value = 0; value < 2; value++) {
      unsigned char kept = data[16 + 4 * count + 3], second = data[16 + 4 * count + 2];
      data[16 + 4 * count + 3] = value == 0 ? 0xff : 0;
      data[16 + 4 * count + 2] = value == 0 ? 0xff : 0x3f;
      write_bytes(&s, data, size);
      if (count != 2) { /* no array has the length of the sections */
        check_refused(&s);
      }
      data[16 + 4 * count + 3] = kept;
      data[16 + 4 * count + 2] = second;
    }
  }
  free(data);
  path_record_destroy(record);
  scratch_close(&s);
}
END_TEST

START_TEST(unwritable_place_is_an_error) {
  struct error error = {0};
  struct path_record *record = small_record();
  ck_assert_int_eq(path_record_write(record, "/nowhere/at/all.path", &error), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(error.message, "/nowhere/at/all.path"));
  path_record_destroy(record);
}
END_TEST

/* Numbers that are none: the path is solved cold, and nothing hangs. */
START_TEST(numbers_that_are_none) {
  static const double bad[3] = {NAN, INFINITY, 1e300};
  struct job_spec spec;
  struct walked cold, warm;
  case_prototype(&spec, 1);
  spec.mesh = (struct mesh_spec){1, 1, 1, 1, 1, 1, 1, 1};
  spec.contact = true;
  spec.load = (struct load_spec){.pressure_to = 20e3, .steps = STEPS};
  struct path_record *record;
  walk(&spec, NULL, &record, &cold);
  for (int k = 0; k < 9; k++) {
    struct fe_state *last = &record->state[record->count - 1];
    double *place = k / 3 == 0 ? last->u : k / 3 == 1 ? last->p : record->x, kept[60];
    memcpy(kept, place, sizeof kept);
    for (int d = 0; d < 60; d++) {
      place[d] = bad[k % 3];
    }
    walk(&spec, record, NULL, &warm);
    check_same(&cold, &warm, 1e-3);
    memcpy(place, kept, sizeof kept);
  }
  path_record_destroy(record);
}
END_TEST

/* ---- the form that is carried ---- */

/* A body that is bent a lot, with something in every component. */
static void bent_state(const struct mesh *mesh, double *u) {
  for (int n = 0; n < mesh->node_count; n++) {
    const double *x = mesh->x + 3 * (size_t)n;
    double angle = 60 * x[0], radius = 1 / 60.0 - x[2];
    double place[3] = {sin(angle) * radius + x[2] * 0, 1.02 * x[1], 1 / 60.0 - cos(angle) * radius};
    for (int i = 0; i < 3; i++) {
      u[3 * n + i] = mesh->fixed[3 * n + i] ? 0 : place[i] - x[i] + 2e-5 * sin(1e3 * x[i] + n);
    }
  }
}

START_TEST(form_gives_back_the_state) {
  for (int half = 0; half < 2; half++) {
    struct job_spec spec;
    struct pneunet_case c;
    struct section_form form;
    warm_spec(&spec);
    spec.half_model = half;
    case_open(&c, &spec);
    size_t size = 3 * (size_t)c.mesh.node_count;
    double *u = calloc(2 * size, sizeof *u), *v = u + size, length = spec.pneunet.length;
    ck_assert_ptr_nonnull(u);
    bent_state(&c.mesh, u);
    ck_assert_int_eq(section_form_create(&c.mesh, &form), STATUS_OK);
    ck_assert_int_eq(section_form_take(&c.mesh, u, &form), STATUS_OK);
    ck_assert_int_eq(section_form_give(&c.mesh, &form, v), STATUS_OK);
    for (size_t d = 0; d < size; d++) {
      ck_assert_double_eq_tol(v[d], u[d], 1e-12 * length);
    }
    section_form_release(&form);
    free(u);
    case_close(&c);
  }
}
END_TEST

/* A rigid motion of the whole body (about y and within the plane of symmetry, which is all that a
 * half model allows) changes the rotations alone, and them by the rotation. */
START_TEST(form_does_not_see_rigid_motion) {
  const double angle = 0.8, shift[3] = {0.01, 0, -0.02};
  const double turn[9] = {cos(angle), 0, sin(angle), 0, 1, 0, -sin(angle), 0, cos(angle)};
  struct job_spec spec;
  struct pneunet_case c;
  struct section_form a, b;
  warm_spec(&spec);
  case_open(&c, &spec);
  const struct mesh *mesh = &c.mesh;
  double *u = calloc(6 * (size_t)mesh->node_count, sizeof *u), *v = u + 3 * mesh->node_count;
  ck_assert_ptr_nonnull(u);
  bent_state(mesh, u);
  for (int n = 0; n < mesh->node_count; n++) {
    double place[3], turned[3];
    for (int i = 0; i < 3; i++) {
      place[i] = mesh->x[3 * n + i] + u[3 * n + i];
    }
    mat3_apply(turn, place, turned);
    for (int i = 0; i < 3; i++) {
      v[3 * n + i] = turned[i] + shift[i] - mesh->x[3 * n + i];
    }
  }
  ck_assert_int_eq(section_form_create(mesh, &a), STATUS_OK);
  ck_assert_int_eq(section_form_create(mesh, &b), STATUS_OK);
  ck_assert_int_eq(section_form_take(mesh, u, &a), STATUS_OK);
  ck_assert_int_eq(section_form_take(mesh, v, &b), STATUS_OK);
  for (int d = 0; d < 3 * mesh->node_count; d++) {
    ck_assert_double_eq_tol(a.local[d], b.local[d], 1e-12);
  }
  for (int d = 3; d < 3 * mesh->section_count; d++) { /* the first step is the body's own motion */
    ck_assert_double_eq_tol(a.step[d], b.step[d], 1e-12);
  }
  for (int k = 0; k < 9 * mesh->section_count; k++) {
    double expected = 0;
    for (int m = 0; m < 3; m++) {
      expected += turn[3 * (k % 9 / 3) + m] * a.rotation[9 * (k / 9) + 3 * m + k % 3];
    }
    ck_assert_double_eq_tol(b.rotation[k], expected, 1e-10);
  }
  section_form_release(&a);
  section_form_release(&b);
  free(u);
  case_close(&c);
}
END_TEST

/* form + 1 (to - from) from form = from is `to`, over a large difference of rotations. */
START_TEST(extrapolation_reaches_the_other_form) {
  struct job_spec spec;
  struct pneunet_case c;
  struct section_form form[3];
  warm_spec(&spec);
  case_open(&c, &spec);
  size_t size = 3 * (size_t)c.mesh.node_count;
  double *u = calloc(2 * size, sizeof *u), *v = u + size;
  ck_assert_ptr_nonnull(u);
  for (int k = 0; k < 3; k++) {
    ck_assert_int_eq(section_form_create(&c.mesh, &form[k]), STATUS_OK);
  }
  ck_assert_int_eq(section_form_take(&c.mesh, v, &form[0]), STATUS_OK);
  ck_assert_int_eq(section_form_take(&c.mesh, v, &form[1]), STATUS_OK);
  bent_state(&c.mesh, u);
  ck_assert_int_eq(section_form_take(&c.mesh, u, &form[2]), STATUS_OK);
  section_form_extrapolate(&c.mesh, &form[0], 1, &form[1], &form[2]);
  ck_assert_int_eq(section_form_give(&c.mesh, &form[0], v), STATUS_OK);
  for (size_t d = 0; d < size; d++) {
    ck_assert_double_eq_tol(v[d], u[d], 1e-11);
  }
  for (int k = 0; k < 3; k++) {
    section_form_release(&form[k]);
  }
  free(u);
  case_close(&c);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("warm");
  TCase *warm = tcase_create("warm");
  tcase_set_timeout(warm, 100);
  tcase_add_test(warm, same_design);
  tcase_add_test(warm, neighbouring_designs);
  tcase_add_test(warm, other_pressures);
  tcase_add_test(warm, useless_records);
  tcase_add_test(warm, file_gives_back_the_record);
  tcase_add_test(warm, damaged_files_are_refused);
  tcase_add_test(warm, unwritable_place_is_an_error);
  tcase_add_test(warm, numbers_that_are_none);
  tcase_add_test(warm, form_gives_back_the_state);
  tcase_add_test(warm, form_does_not_see_rigid_motion);
  tcase_add_test(warm, extrapolation_reaches_the_other_form);
  suite_add_tcase(suite, warm);
  return suite_run(suite);
}
