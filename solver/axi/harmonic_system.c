/* Unknowns, cliques and factorisation of the forms. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/axi/harmonic_internal.h"

enum { CLIQUE_MAX = HARMONIC_TERMS * HARMONIC_ELEMENT };

static int kind_of(int n) {
  return n < HARMONIC_KINDS ? n : HARMONIC_KINDS - 1;
}

/* ---- unknowns ---- */

/* Whether a component is an unknown of its own. */
static bool is_own(const struct harmonic *h, int kind, int node, int part) {
  const unsigned char *hold = h->mesh->hold + 2 * node;
  if (h->mesh->position[2 * node] <= h->small) {
    switch (kind) {
    case 0:
      return part == 1 && hold[1] == AXI_FREE;
    case 1:
      return part == 0 && hold[1] == AXI_FREE;
    default:
      return false;
    }
  }
  if (part == 2) {
    return kind > 0 && hold[0] == AXI_FREE;
  }
  return hold[part] == AXI_FREE;
}

/* What a component is in terms of `own` unknowns, h for n = 0 and the sway for n = 1; the common
 * unknown of the plate is `plate`. */
static struct harmonic_term component(const struct harmonic *h, int kind, const int *own, int plate,
                                      int node, int part) {
  const unsigned char *hold = h->mesh->hold + 2 * node;
  int held = hold[part == 1], i = HARMONIC_PARTS * node;
  struct harmonic_term t = {{-1, -1}, {1, 1}};
  if (kind == 1 && part == 2 && h->mesh->position[2 * node] <= h->small) {
    t = component(h, kind, own, plate, node, 0);
    t.factor[0] = -t.factor[0];
  } else if (own[i + part] >= 0) {
    t.dof[0] = own[i + part];
  } else if (held == AXI_TIED || held == AXI_AHEAD) {
    t.dof[0] = own[HARMONIC_PARTS * h->mesh->master[node] + part];
    t.dof[1] = held == AXI_AHEAD && kind == 0 ? plate : -1;
  } else if (held == AXI_PLATE && kind == 0) {
    t.dof[0] = plate;
  } else if (kind == 1 && part != 1 && hold[1] == AXI_PLATE && h->plate == HARMONIC_SWAYING) {
    t.dof[0] = plate;
    t.factor[0] = part == 0 ? 1 : -1;
  }
  return t;
}

static enum status number_unknowns(const struct harmonic *h, int kind, struct harmonic_system *s) {
  int count = HARMONIC_PARTS * h->mesh->node_count, plates = 0;
  int *own = malloc(sizeof *own * (size_t)count);
  s->term = malloc(sizeof *s->term * (size_t)count);
  s->node_of = malloc(sizeof *s->node_of * ((size_t)count + 1));
  if (!own || !s->term || !s->node_of) {
    free(own);
    return STATUS_NO_MEMORY;
  }
  for (int i = 0; i < count; i++) {
    int node = i / HARMONIC_PARTS;
    own[i] = is_own(h, kind, node, i % HARMONIC_PARTS) ? s->dof_count : -1;
    if (own[i] >= 0) {
      s->node_of[s->dof_count++] = node;
    }
    plates += h->mesh->hold[2 * node + 1] == AXI_PLATE ||
              (kind == 0 && h->mesh->hold[2 * node + 1] == AXI_AHEAD);
  }
  int plate = -1;
  if (plates > 0 && (kind == 0 || (kind == 1 && h->plate == HARMONIC_SWAYING))) {
    plate = s->dof_count++;
    s->node_of[plate] = h->mesh->node_count;
  }
  for (int i = 0; i < count; i++) {
    s->term[i] = component(h, kind, own, plate, i / HARMONIC_PARTS, i % HARMONIC_PARTS);
  }
  free(own);
  return STATUS_OK;
}

/* ---- cliques: elements, edges of the cavity, touching points ---- */

/* Nodes of a clique; returns their number. */
static int clique_nodes(const struct harmonic *h, const struct harmonic_state *state, int clique,
                        const int **node) {
  const struct axi_mesh *mesh = h->mesh;
  if (clique < mesh->element_count) {
    *node = mesh->element[clique].node;
    return AXI_NODES;
  }
  clique -= mesh->element_count;
  if (clique < mesh->inner_count) {
    *node = mesh->inner[clique].node;
    return AXI_EDGE_NODES;
  }
  *node = state->touch[clique - mesh->inner_count].node;
  return state->touch[clique - mesh->inner_count].count;
}

/* Distinct unknowns of a clique into dofs; returns their number. */
static int clique_dofs(const struct harmonic_system *s, const int *node, int nodes, int *dofs) {
  int count = 0;
  for (int i = 0; i < HARMONIC_PARTS * nodes; i++) {
    const struct harmonic_term *t =
        &s->term[HARMONIC_PARTS * node[i / HARMONIC_PARTS] + i % HARMONIC_PARTS];
    for (int k = 0; k < HARMONIC_TERMS; k++) {
      int at = 0;
      while (at < count && dofs[at] != t->dof[k]) {
        at++;
      }
      if (t->dof[k] >= 0 && at == count) {
        dofs[count++] = t->dof[k];
      }
    }
  }
  return count;
}

static enum status gather_cliques(const struct harmonic *h, const struct harmonic_state *state,
                                  struct harmonic_system *s) {
  int dofs[CLIQUE_MAX];
  const int *node;
  s->clique_count = h->mesh->element_count + h->mesh->inner_count + state->touch_count;
  s->start = malloc(sizeof *s->start * ((size_t)s->clique_count + 1));
  s->values = malloc(sizeof *s->values * ((size_t)s->clique_count + 1));
  if (!s->start || !s->values) {
    return STATUS_NO_MEMORY;
  }
  size_t room = 0;
  s->start[0] = 0;
  for (int c = 0; c < s->clique_count; c++) {
    int nodes = clique_nodes(h, state, c, &node), count = clique_dofs(s, node, nodes, dofs);
    s->start[c + 1] = s->start[c] + count;
    room += (size_t)count * (size_t)(count + 1) / 2;
  }
  s->dofs = malloc(sizeof *s->dofs * ((size_t)s->start[s->clique_count] + CLIQUE_MAX));
  s->store = malloc(sizeof *s->store * (room + 1));
  if (!s->dofs || !s->store) {
    return STATUS_NO_MEMORY;
  }
  double *at = s->store;
  for (int c = 0; c < s->clique_count; c++) {
    int nodes = clique_nodes(h, state, c, &node);
    size_t count = (size_t)clique_dofs(s, node, nodes, s->dofs + s->start[c]);
    s->values[c] = at;
    at += count * (count + 1) / 2;
  }
  return STATUS_OK;
}

static void lump_mass(const struct harmonic *h, struct harmonic_system *s) {
  for (int e = 0; e < h->mesh->element_count; e++) {
    for (int i = 0; i < HARMONIC_ELEMENT; i++) {
      int a = i / HARMONIC_PARTS;
      const struct harmonic_term *t =
          &s->term[HARMONIC_PARTS * h->mesh->element[e].node[a] + i % HARMONIC_PARTS];
      for (int k = 0; k < HARMONIC_TERMS; k++) {
        if (t->dof[k] >= 0) {
          s->mass[t->dof[k]] += t->factor[k] * t->factor[k] * h->volume[AXI_NODES * e + a];
        }
      }
    }
  }
}

void harmonic_system_release(struct harmonic_system *s) {
  ldlt_destroy(s->ldlt);
  free(s->term);
  free(s->node_of);
  free(s->start);
  free(s->dofs);
  free(s->store);
  free(s->values);
  free(s->mass);
  memset(s, 0, sizeof *s);
}

static enum status system_create(const struct harmonic *h, const struct harmonic_state *state,
                                 int kind, struct harmonic_system *s, struct error *error) {
  memset(s, 0, sizeof *s);
  enum status status = number_unknowns(h, kind, s);
  if (status == STATUS_OK) {
    status = gather_cliques(h, state, s);
  }
  if (status == STATUS_OK) {
    s->mass = calloc((size_t)s->dof_count + 1, sizeof *s->mass);
    status = s->mass ? STATUS_OK : STATUS_NO_MEMORY;
  }
  if (status != STATUS_OK) {
    error_set(error, status, NULL, "no memory for the harmonics of %d nodes", h->mesh->node_count);
  } else if (s->dof_count > 0) {
    struct ldlt_pattern pattern = {.dof_count = s->dof_count,
                                   .node_count = h->mesh->node_count + 1,
                                   .node_of = s->node_of,
                                   .clique_count = s->clique_count,
                                   .start = s->start,
                                   .dofs = s->dofs};
    lump_mass(h, s);
    status = ldlt_create(&pattern, &s->ldlt, error);
  }
  if (status != STATUS_OK) {
    harmonic_system_release(s);
  }
  return status;
}

/* ---- values and factors ---- */

/* Where the terms of a clique's components are among its unknowns; -1: nowhere. */
static void locate_terms(const struct harmonic_system *s, int clique, const int *node, int width,
                         struct harmonic_term *local) {
  const int *dofs = s->dofs + s->start[clique];
  for (int i = 0; i < width; i++) {
    const struct harmonic_term *t =
        &s->term[HARMONIC_PARTS * node[i / HARMONIC_PARTS] + i % HARMONIC_PARTS];
    local[i] = *t;
    for (int k = 0; k < HARMONIC_TERMS; k++) {
      int at = s->start[clique + 1] - s->start[clique] - 1;
      while (at >= 0 && (t->dof[k] < 0 || dofs[at] != t->dof[k])) {
        at--;
      }
      local[i].dof[k] = at;
    }
  }
}

/* Packs a form over the components of the nodes, width x width, into the clique's unknowns, less
 * shift times the lumped volume (NULL: none) of the nodes. */
static void pack(struct harmonic_system *s, int clique, const int *node, int width,
                 const double *form, const double *volume, double shift) {
  double full[CLIQUE_MAX][CLIQUE_MAX] = {{0}}, *value = s->values[clique];
  int count = s->start[clique + 1] - s->start[clique];
  struct harmonic_term local[HARMONIC_ELEMENT];
  locate_terms(s, clique, node, width, local);
  for (int p = 0; p < HARMONIC_TERMS * width; p++) {
    int i = p / HARMONIC_TERMS, k = p % HARMONIC_TERMS, row = local[i].dof[k];
    double factor = local[i].factor[k];
    if (row < 0) {
      continue;
    }
    if (volume) {
      full[row][row] -= shift * factor * factor * volume[i / HARMONIC_PARTS];
    }
    for (int q = 0; q < HARMONIC_TERMS * width; q++) {
      int j = q / HARMONIC_TERMS, l = q % HARMONIC_TERMS, column = local[j].dof[l];
      if (column >= 0) {
        full[row][column] += factor * form[width * i + j] * local[j].factor[l];
      }
    }
  }
  for (int i = 0; i < count; i++) {
    for (int j = i; j < count; j++) {
      *value++ = full[i][j];
    }
  }
}

enum status harmonic_inverted(int element, struct error *error) {
  return error_set(error, STATUS_INVERTED, NULL,
                   "element %d of the axisymmetric state is turned inside out", element);
}

/* Factorises the form of n less shift times the mass; *negative receives the negative pivots. */
enum status harmonic_system_factor(const struct harmonic *h, struct harmonic_system *s,
                                   const struct harmonic_state *state, int n, double shift,
                                   int *negative, struct error *error) {
  const struct axi_mesh *mesh = h->mesh;
  double form[HARMONIC_ELEMENT * HARMONIC_ELEMENT];
  const int *node;
  int c = 0;
  for (int e = 0; e < mesh->element_count; e++, c++) {
    if (!harmonic_element(mesh, &h->geometry[e], e, state->u, n, form)) {
      return harmonic_inverted(e, error);
    }
    clique_nodes(h, state, c, &node);
    pack(s, c, node, HARMONIC_ELEMENT, form, h->volume + (size_t)e * AXI_NODES, shift);
  }
  for (int e = 0; e < mesh->inner_count; e++, c++) {
    harmonic_edge(mesh, e, state->u, state->pressure, n, form);
    clique_nodes(h, state, c, &node);
    pack(s, c, node, HARMONIC_EDGE, form, NULL, 0);
  }
  for (int k = 0; k < state->touch_count; k++, c++) {
    harmonic_touch(&state->touch[k], n, form);
    int nodes = clique_nodes(h, state, c, &node);
    pack(s, c, node, HARMONIC_PARTS * nodes, form, NULL, 0);
  }
  *negative = s->dof_count == 0 ? 0 : ldlt_factor(s->ldlt, (const double *const *)s->values);
  return STATUS_OK;
}

/* The system for n: kept, or made into *own when there are touching points. */
enum status harmonic_system_get(struct harmonic *h, const struct harmonic_state *state, int n,
                                struct harmonic_system *own, struct harmonic_system **out,
                                struct error *error) {
  int kind = kind_of(n);
  *out = state->touch_count > 0 ? own : &h->system[kind];
  if ((*out)->term) {
    return STATUS_OK;
  }
  return system_create(h, state, kind, *out, error);
}
