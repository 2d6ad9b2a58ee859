/* Recorded states of a path: in memory and in files. */
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/warm.h"

/* Head of a file; the numbers are in the machine's own format, which `order` betrays. */
struct head {
  char magic[8];
  uint32_t order, version;
  int32_t node_count, element_count, section_count, point_count, count, facing_count;
  uint64_t topology;
};
static const char magic[8] = "pneupath";
enum { BYTE_ORDER_MARK = 0x01020304, FILE_VERSION = 4, COUNT_MAX = 1 << 24 };

static bool allocate_state(const struct path_record *r, struct fe_state *state) {
  state->u = malloc(sizeof *state->u * (3 * (size_t)r->node_count + 1));
  state->p = malloc(sizeof *state->p * (ELEMENT_PRESSURES * (size_t)r->element_count + 1));
  state->lambda = malloc(sizeof *state->lambda * ((size_t)r->point_count + 1));
  if (!state->u || !state->p || !state->lambda) {
    state_release(state);
    return false;
  }
  return true;
}

/* Makes room for one more state. */
static bool grow(struct path_record *r) {
  if (r->count == r->capacity) {
    int capacity = 2 * r->capacity + 8;
    double *pressure = realloc(r->pressure, sizeof *pressure * (size_t)capacity);
    r->pressure = pressure ? pressure : r->pressure;
    struct fe_state *state = realloc(r->state, sizeof *state * (size_t)capacity);
    r->state = state ? state : r->state;
    if (!pressure || !state) {
      return false;
    }
    r->capacity = capacity;
  }
  r->state[r->count] = (struct fe_state){0};
  return allocate_state(r, &r->state[r->count]);
}

/* A number that tells which nodes make each element (FNV-1a: Fowler, Noll and Vo). */
static uint64_t mesh_topology(const struct mesh *mesh) {
  uint64_t hash = 14695981039346656037u;
  for (size_t i = 0; i < (size_t)HEX27_NODES * (size_t)mesh->element_count; i++) {
    hash = (hash ^ (uint64_t)mesh->element_nodes[i]) * 1099511628211u;
  }
  return hash;
}

enum status path_record_create(const struct fe_model *m, struct path_record **out) {
  const struct mesh *mesh = m->mesh;
  struct path_record *r = calloc(1, sizeof *r);
  *out = NULL;
  if (!r) {
    return STATUS_NO_MEMORY;
  }
  *r = (struct path_record){.node_count = mesh->node_count,
                            .element_count = mesh->element_count,
                            .section_count = mesh->section_count,
                            .point_count = m->contact.point_count,
                            .facing_count = mesh->facing_count,
                            .topology = mesh_topology(mesh)};
  r->x = malloc(sizeof *r->x * (3 * (size_t)mesh->node_count + 1));
  r->facing = calloc((size_t)mesh->facing_count + 1, 1);
  if (!r->x || !r->facing) {
    path_record_destroy(r);
    return STATUS_NO_MEMORY;
  }
  memcpy(r->x, mesh->x, sizeof *r->x * 3 * (size_t)mesh->node_count);
  *out = r;
  return STATUS_OK;
}

void path_record_destroy(struct path_record *r) {
  if (!r) {
    return;
  }
  for (int k = 0; k < r->count; k++) {
    state_release(&r->state[k]);
  }
  free(r->x);
  free(r->facing);
  free(r->pressure);
  free(r->state);
  free(r);
}

void path_record_note_pairs(struct path_record *r, const struct fe_model *m) {
  model_tell_pattern(m, r->facing);
}

enum status path_record_add(struct path_record *r, double pressure, const struct fe_state *state) {
  if (!grow(r)) {
    return STATUS_NO_MEMORY;
  }
  struct fe_state *copy = &r->state[r->count];
  memcpy(copy->u, state->u, sizeof *copy->u * 3 * (size_t)r->node_count);
  memcpy(copy->p, state->p, sizeof *copy->p * ELEMENT_PRESSURES * (size_t)r->element_count);
  memcpy(copy->lambda, state->lambda, sizeof *copy->lambda * (size_t)r->point_count);
  r->pressure[r->count++] = pressure;
  return STATUS_OK;
}

/* Moves `count` numbers between file and memory. */
static bool transfer(FILE *file, bool writing, double *data, size_t count) {
  return (writing ? fwrite(data, sizeof *data, count, file)
                  : fread(data, sizeof *data, count, file)) == count;
}

static bool transfer_state(FILE *file, bool writing, const struct path_record *r, int index) {
  struct fe_state *s = &r->state[index];
  return transfer(file, writing, &r->pressure[index], 1) &&
         transfer(file, writing, s->u, 3 * (size_t)r->node_count) &&
         transfer(file, writing, s->p, ELEMENT_PRESSURES * (size_t)r->element_count) &&
         transfer(file, writing, s->lambda, (size_t)r->point_count);
}

static bool write_all(FILE *file, const struct path_record *r) {
  struct head head = {.order = BYTE_ORDER_MARK,
                      .version = FILE_VERSION,
                      .node_count = r->node_count,
                      .element_count = r->element_count,
                      .section_count = r->section_count,
                      .point_count = r->point_count,
                      .count = r->count,
                      .facing_count = r->facing_count,
                      .topology = r->topology};
  memcpy(head.magic, magic, sizeof magic);
  bool good = fwrite(&head, sizeof head, 1, file) == 1 &&
              fwrite(r->place, sizeof r->place, 1, file) == 1 &&
              transfer(file, true, r->x, 3 * (size_t)r->node_count) &&
              fwrite(r->facing, 1, (size_t)r->facing_count, file) == (size_t)r->facing_count;
  for (int k = 0; k < r->count && good; k++) {
    good = transfer_state(file, true, r, k);
  }
  return good;
}

enum status path_record_write(const struct path_record *r, const char *path, struct error *error) {
  char name[4096];
  enum status status = STATUS_OK;
  int length = snprintf(name, sizeof name, "%s.part", path);
  FILE *file = length > 0 && (size_t)length < sizeof name ? fopen(name, "wb") : NULL;
  bool good = file && write_all(file, r);
  if (file) {
    good = fclose(file) == 0 && good;
  }
  if (!good || rename(name, path) != 0) {
    status = error_set(error, STATUS_IO, NULL, "cannot write %s: %s", path, strerror(errno));
    if (file) {
      remove(name);
    }
  }
  return status;
}

static bool plausible(const struct head *h) {
  const int32_t counts[] = {h->node_count,  h->element_count, h->section_count,
                            h->point_count, h->count,         h->facing_count};
  bool good = memcmp(h->magic, magic, sizeof magic) == 0 && h->order == BYTE_ORDER_MARK &&
              h->version == FILE_VERSION;
  for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
    good = good && counts[i] >= 0 && counts[i] < COUNT_MAX;
  }
  return good;
}

static enum status read_all(FILE *file, struct path_record *r, struct error *error) {
  static const char damaged[] = "is not a path of this version of the program on this machine";
  struct head h;
  if (fread(&h, sizeof h, 1, file) != 1 || !plausible(&h)) {
    return error_set(error, STATUS_IO, NULL, "the file %s", damaged);
  }
  *r = (struct path_record){.node_count = h.node_count,
                            .element_count = h.element_count,
                            .section_count = h.section_count,
                            .point_count = h.point_count,
                            .facing_count = h.facing_count,
                            .topology = h.topology};
  r->x = malloc(sizeof *r->x * (3 * (size_t)r->node_count + 1));
  r->facing = malloc((size_t)r->facing_count + 1);
  if (!r->x || !r->facing) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a path");
  }
  bool good = fread(r->place, sizeof r->place, 1, file) == 1 &&
              transfer(file, false, r->x, 3 * (size_t)r->node_count) &&
              fread(r->facing, 1, (size_t)r->facing_count, file) == (size_t)r->facing_count;
  for (int k = 0; k < h.count && good; k++) {
    if (!grow(r)) {
      return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a path");
    }
    r->count++;
    good = transfer_state(file, false, r, k);
  }
  return good ? STATUS_OK : error_set(error, STATUS_IO, NULL, "the file is cut off");
}

enum status path_record_read(const char *path, struct path_record **out, struct error *error) {
  FILE *file = fopen(path, "rb");
  struct path_record *r = calloc(1, sizeof *r);
  enum status status = STATUS_OK;
  *out = NULL;
  if (!file) {
    status = error_set(error, STATUS_IO, NULL, "cannot read %s: %s", path, strerror(errno));
  } else if (!r) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a path");
  } else {
    status = read_all(file, r, error);
  }
  if (file) {
    fclose(file);
  }
  if (status != STATUS_OK) {
    path_record_destroy(r);
    r = NULL;
  }
  *out = r;
  return status;
}

bool path_record_fits(const struct path_record *r, const struct fe_model *m) {
  return r->count > 0 && r->node_count == m->mesh->node_count &&
         r->element_count == m->mesh->element_count && r->section_count == m->mesh->section_count &&
         r->point_count == m->contact.point_count && r->facing_count == m->mesh->facing_count &&
         r->topology == mesh_topology(m->mesh);
}
