#include "solver/fe/forecast.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/lapack.h"
#include "solver/base/vec3.h"
#include "solver/fe/section_form.h"

/* Length over which the correlation falls, in ranges of the coordinates; and what is added to the
 * correlation of a point with itself, because states are only known to the tolerance of a solve. */
static const double correlation_length = 1.5, nugget = 1e-6;

/* What is known may take so much memory; the oldest designs, in a chain the farthest, go first. */
static const size_t bytes_max = (size_t)200 << 20;

/* A design that was solved. */
struct known {
  struct path_record *record;
  struct section_form *form; /* of every state, instead of its displacements; NULL before use */
};

struct forecast {
  int count, capacity;
  struct known *known; /* all of one topology, oldest first */
};

struct forecast *forecast_create(void) {
  return calloc(1, sizeof(struct forecast));
}

static void known_release(struct known *known) {
  for (int k = 0; known->form && k < known->record->count; k++) {
    section_form_release(&known->form[k]);
  }
  free(known->form);
  path_record_destroy(known->record);
}

/* Gives up the `count` oldest designs. */
static void forget(struct forecast *f, int count) {
  for (int i = 0; i < count; i++) {
    known_release(&f->known[i]);
  }
  f->count -= count;
  if (count > 0) {
    memmove(f->known, f->known + count, sizeof *f->known * (size_t)f->count);
  }
}

static size_t bytes_of(const struct path_record *r) {
  size_t state = 3 * (size_t)r->node_count + ELEMENT_PRESSURES * (size_t)r->element_count +
                 (size_t)r->point_count;
  return sizeof(double) * (3 * (size_t)r->node_count + state * (size_t)r->count);
}

/* Designs from the newest back that there is memory for. */
static int affordable(const struct forecast *f) {
  size_t bytes = 0;
  int count = 0;
  while (count < f->count) {
    bytes += bytes_of(f->known[f->count - 1 - count].record);
    if (bytes > bytes_max && count > 0) {
      break;
    }
    count++;
  }
  return count;
}

void forecast_destroy(struct forecast *f) {
  if (f) {
    forget(f, f->count);
    free(f->known);
    free(f);
  }
}

enum status forecast_add(struct forecast *f, struct path_record *record) {
  if (f->count > 0 && f->known[f->count - 1].record->topology != record->topology) {
    forget(f, f->count);
  }
  if (f->count == f->capacity) {
    int capacity = 2 * f->capacity + 8;
    struct known *known = realloc(f->known, sizeof *known * (size_t)capacity);
    if (!known) {
      path_record_destroy(record);
      return STATUS_NO_MEMORY;
    }
    f->known = known;
    f->capacity = capacity;
  }
  f->known[f->count++] = (struct known){.record = record};
  forget(f, f->count - affordable(f));
  return STATUS_OK;
}

/* ---- weights ------------------------------------------------------------------------------ */

/* Square of the distance of two points, by the ranges of the coordinates (0: all are equal). */
static double apart(const double *a, const double *b, const double *range) {
  double sum = 0;
  for (int d = 0; d < DESIGN_NUMBERS; d++) {
    double difference = range[d] > 0 ? (a[d] - b[d]) / range[d] : 0;
    sum += difference * difference;
  }
  return sum;
}

static void find_ranges(const double *known, int count, const double *place, double *range) {
  for (int d = 0; d < DESIGN_NUMBERS; d++) {
    double low = place[d], high = place[d];
    for (int i = 0; i < count; i++) {
      low = fmin(low, known[i * DESIGN_NUMBERS + d]);
      high = fmax(high, known[i * DESIGN_NUMBERS + d]);
    }
    range[d] = high - low > 1e-9 * fmax(fabs(high), fabs(low)) ? high - low : 0;
  }
}

static double correlation(const double *a, const double *b, const double *range) {
  return exp(-0.5 * apart(a, b, range) / (correlation_length * correlation_length));
}

enum status forecast_weights(const double *known, int count, const double *place, double *weight) {
  size_t n = (size_t)count;
  double range[DESIGN_NUMBERS], ones = 0, sum = 0;
  double *matrix = malloc(sizeof *matrix * n * (n + 2));
  if (!matrix) {
    return STATUS_NO_MEMORY;
  }
  double *solved = matrix + n * n, *one = solved + n;
  find_ranges(known, count, place, range);
  for (int i = 0; i < count; i++) {
    const double *at = known + (size_t)i * DESIGN_NUMBERS;
    for (int j = 0; j < count; j++) {
      matrix[i * count + j] =
          correlation(at, known + (size_t)j * DESIGN_NUMBERS, range) + (i == j ? nugget : 0);
    }
    solved[i] = correlation(at, place, range);
    one[i] = 1;
  }
  int columns = 2, info;
  dposv_("L", &count, &columns, matrix, &count, solved, &count, &info);
  for (int i = 0; i < count; i++) {
    ones += one[i];
    sum += solved[i];
  }
  for (int i = 0; i < count; i++) {
    weight[i] = info == 0 ? solved[i] + (1 - sum) / ones * one[i] : i + 1 == count;
  }
  free(matrix);
  return STATUS_OK;
}

/* ---- states ------------------------------------------------------------------------------- */

/* The forms of a record's states, which then do without their displacements; once. */
static enum status see_from_sections(struct known *known, const struct mesh *mesh) {
  struct path_record *r = known->record;
  struct mesh before = *mesh;
  enum status status = STATUS_OK;
  if (known->form || mesh->section_count == 0) {
    return STATUS_OK;
  }
  before.x = r->x;
  known->form = calloc((size_t)r->count, sizeof *known->form);
  if (!known->form) {
    return STATUS_NO_MEMORY;
  }
  for (int k = 0; k < r->count && status == STATUS_OK; k++) {
    status = section_form_create(mesh, &known->form[k]);
    if (status == STATUS_OK) {
      status = section_form_take(&before, r->state[k].u, &known->form[k]);
    }
    if (status == STATUS_OK) {
      free(r->state[k].u);
      r->state[k].u = NULL;
    }
  }
  return status;
}

static void add_scaled(double *sum, double weight, const double *values, size_t count) {
  for (size_t i = 0; i < count; i++) {
    sum[i] += weight * values[i];
  }
}

/* A mixture of records: those with weights, and of them the one that the others are seen from. */
struct mixture {
  const struct known *known;
  const double *weight;
  int count, middle;
};

/* Adds up rotations as vectors seen from the middle's, and steps as strains. */
static void mix_sections(const struct mixture *mix, const struct mesh *mesh, int index,
                         struct section_form *out) {
  for (int s = 0; s < mesh->section_count; s++) {
    const double *middle = mix->known[mix->middle].form[index].rotation + 9 * s;
    double spin[3] = {0}, turn[9], *rotation = out->rotation + 9 * s;
    out->length[s] = 1;
    for (int i = 0; i < mix->count; i++) {
      const struct section_form *form = &mix->known[i].form[index];
      double w[3];
      rotation_between(middle, form->rotation + 9 * s, w);
      add_scaled(spin, mix->weight[i], w, 3);
      double unit = form->length[s] > 0 ? 1 / form->length[s] : 1;
      add_scaled(out->step + 3 * s, mix->weight[i] * unit, form->step + 3 * s, 3);
    }
    rotation_matrix(spin, turn);
    for (int i = 0; i < 9; i++) {
      rotation[i] = 0;
      for (int k = 0; k < 3; k++) {
        rotation[i] += middle[i / 3 * 3 + k] * turn[3 * k + i % 3];
      }
    }
  }
}

static enum status mix_displacements(const struct mixture *mix, const struct mesh *mesh, int index,
                                     double *u) {
  size_t values = 3 * (size_t)mesh->node_count;
  struct section_form form = {0};
  if (mesh->section_count == 0) {
    for (int i = 0; i < mix->count; i++) {
      add_scaled(u, mix->weight[i], mix->known[i].record->state[index].u, values);
    }
    return STATUS_OK;
  }
  enum status status = section_form_create(mesh, &form);
  if (status == STATUS_OK) {
    mix_sections(mix, mesh, index, &form);
    for (int i = 0; i < mix->count; i++) {
      add_scaled(form.local, mix->weight[i], mix->known[i].form[index].local, values);
    }
    status = section_form_give(mesh, &form, u);
  }
  section_form_release(&form);
  return status;
}

/* Mixes one state. Contact only pushes. */
static enum status mix_state(const struct mixture *mix, const struct fe_model *m, int index,
                             struct fe_state *state, double *pressure) {
  *pressure = 0;
  state_clear(m, state);
  for (int i = 0; i < mix->count; i++) {
    const struct path_record *r = mix->known[i].record;
    const struct fe_state *from = &r->state[index];
    *pressure += mix->weight[i] * r->pressure[index];
    add_scaled(state->p, mix->weight[i], from->p, ELEMENT_PRESSURES * (size_t)r->element_count);
    add_scaled(state->lambda, mix->weight[i], from->lambda, (size_t)r->point_count);
  }
  for (int i = 0; i < m->contact.point_count; i++) {
    state->lambda[i] = fmax(0, state->lambda[i]);
  }
  return mix_displacements(mix, m->mesh, index, state->u);
}

static enum status mix_path(const struct mixture *mix, const struct fe_model *m,
                            struct path_record **out) {
  const struct path_record *last = mix->known[mix->count - 1].record;
  struct fe_state state = {0};
  double pressure;
  enum status status = state_create(m, &state);
  if (status == STATUS_OK) {
    status = path_record_create(m, out);
  }
  for (int k = 0; k < last->count && status == STATUS_OK; k++) {
    status = mix_state(mix, m, k, &state, &pressure);
    if (status == STATUS_OK) {
      status = path_record_add(*out, pressure, &state);
    }
  }
  if (status == STATUS_OK) {
    (*out)->mixed = mix->count > 1;
    memcpy((*out)->facing, last->facing, (size_t)last->facing_count);
  }
  state_release(&state);
  return status;
}

enum status forecast_make(struct forecast *f, const struct fe_model *m, const double *place,
                          struct path_record **out) {
  enum status status = STATUS_OK;
  *out = NULL;
  if (f->count == 0 || !path_record_fits(f->known[f->count - 1].record, m)) {
    return STATUS_OK;
  }
  /* Paths with another number of states than the last are of no use beside it. */
  int states = f->known[f->count - 1].record->count, count = 0;
  struct known *known = malloc(sizeof *known * (size_t)f->count);
  double *places = calloc((size_t)f->count * (DESIGN_NUMBERS + 1), sizeof *places);
  if (!known || !places) {
    status = STATUS_NO_MEMORY;
  }
  for (int i = 0; i < f->count && status == STATUS_OK; i++) {
    struct known *at = &f->known[i];
    if (at->record->count == states && path_record_fits(at->record, m)) {
      status = see_from_sections(at, m->mesh);
      memcpy(places + (size_t)count * DESIGN_NUMBERS, at->record->place, sizeof at->record->place);
      known[count++] = *at;
    }
  }
  if (status == STATUS_OK) {
    double *weight = places + (size_t)f->count * DESIGN_NUMBERS;
    struct mixture mix = {known, weight, count, 0};
    status = forecast_weights(places, count, place, weight);
    for (int i = 1; i < count; i++) {
      mix.middle = weight[i] > weight[mix.middle] ? i : mix.middle;
    }
    status = status == STATUS_OK ? mix_path(&mix, m, out) : status;
  }
  if (status != STATUS_OK) {
    path_record_destroy(*out);
    *out = NULL;
    forget(f, f->count); /* some may have been seen from their sections by half */
  }
  free(known);
  free(places);
  return status;
}
