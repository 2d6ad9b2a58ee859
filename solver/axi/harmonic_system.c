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
  int plate = s->elongation = -1;
  if (plates > 0 && (kind == 0 || (kind == 1 && h->plate == HARMONIC_SWAYING))) {
    plate = s->dof_count++;
    s->elongation = kind == 0 ? plate : -1;
    s->node_of[plate] = h->mesh->node_count;
  }
  for (int i = 0; i < count; i++) {
    s->term[i] = component(h, kind, own, plate, i / HARMONIC_PARTS, i % HARMONIC_PARTS);
  }
  free(own);
  return STATUS_OK;
}

/* ---- cliques: elements, edges of the cavity, touching points ---- */

/* What a clique couples. */
struct place {
  int count, node[AXI_NODES];
  int image; /* the last three nodes are meant this many periods higher */
};

static struct place clique_place(const struct harmonic *h, const struct harmonic_state *state,
                                 int clique) {
  const struct axi_mesh *mesh = h->mesh;
  struct place p = {.count = AXI_EDGE_NODES};
  if (clique < mesh->element_count) {
    p.count = AXI_NODES;
    memcpy(p.node, mesh->element[clique].node, sizeof p.node);
    return p;
  }
  clique -= mesh->element_count;
  if (clique < mesh->inner_count) {
    memcpy(p.node, mesh->inner[clique].node, sizeof mesh->inner[clique].node);
    return p;
  }
  clique -= mesh->inner_count;
  if (clique < state->touch_count) {
    p.count = state->touch[clique].count;
    memcpy(p.node, state->touch[clique].node, sizeof state->touch[clique].node);
    return p;
  }
  clique -= state->touch_count;
  int skin = state->skin ? state->skin->count : 0;
  if (clique < skin) {
    p.count = state->skin->turning[clique].count;
    memcpy(p.node, state->skin->turning[clique].node, sizeof state->skin->turning->node);
    return p;
  }
  const struct axi_contact *contact = state->contact;
  const struct axi_touch *touch = &contact->touch[clique - skin];
  memcpy(p.node, contact->edge[touch->slave].node, sizeof contact->edge->node);
  if (touch->master >= 0) {
    p.count = TOUCH_NODES;
    p.image = touch->shift;
    memcpy(p.node + AXI_EDGE_NODES, contact->edge[touch->master].node, sizeof contact->edge->node);
  }
  return p;
}

/* Component i of a place, HARMONIC_PARTS to a node. */
static struct harmonic_term term_of(const struct harmonic_system *s, const struct place *p, int i) {
  int node = i / HARMONIC_PARTS, part = i % HARMONIC_PARTS;
  struct harmonic_term t = s->term[HARMONIC_PARTS * p->node[node] + part];
  if (p->image != 0 && part == 1 && node >= AXI_EDGE_NODES && s->elongation >= 0) {
    t.factor[1] = p->image + (t.dof[1] == s->elongation ? t.factor[1] : 0);
    t.dof[1] = s->elongation;
  }
  return t;
}

/* Distinct unknowns of a clique into dofs; returns their number. */
static int clique_dofs(const struct harmonic_system *s, const struct place *p, int *dofs) {
  int count = 0;
  for (int i = 0; i < HARMONIC_PARTS * p->count; i++) {
    struct harmonic_term t = term_of(s, p, i);
    for (int k = 0; k < HARMONIC_TERMS; k++) {
      int at = 0;
      while (at < count && dofs[at] != t.dof[k]) {
        at++;
      }
      if (t.dof[k] >= 0 && at == count) {
        dofs[count++] = t.dof[k];
      }
    }
  }
  return count;
}

static int clique_count(const struct harmonic *h, const struct harmonic_state *state) {
  return h->mesh->element_count + h->mesh->inner_count + state->touch_count +
         (state->skin ? state->skin->count : 0) +
         (state->contact ? state->contact->touch_count : 0);
}

static enum status gather_cliques(const struct harmonic *h, const struct harmonic_state *state,
                                  struct harmonic_system *s) {
  int dofs[CLIQUE_MAX];
  s->clique_count = clique_count(h, state);
  s->start = malloc(sizeof *s->start * ((size_t)s->clique_count + 1));
  s->values = malloc(sizeof *s->values * ((size_t)s->clique_count + 1));
  if (!s->start || !s->values) {
    return STATUS_NO_MEMORY;
  }
  size_t room = 0;
  s->start[0] = 0;
  for (int c = 0; c < s->clique_count; c++) {
    struct place place = clique_place(h, state, c);
    int count = clique_dofs(s, &place, dofs);
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
    struct place place = clique_place(h, state, c);
    size_t count = (size_t)clique_dofs(s, &place, s->dofs + s->start[c]);
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

static void system_release(struct harmonic_system *s) {
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
    system_release(s);
  }
  return status;
}

/* ---- values and factors ---- */

/* Where the terms of a clique's components are among its unknowns; -1: nowhere. */
static void locate_terms(const struct harmonic_system *s, int clique, const struct place *place,
                         struct harmonic_term *local) {
  const int *dofs = s->dofs + s->start[clique];
  for (int i = 0; i < HARMONIC_PARTS * place->count; i++) {
    local[i] = term_of(s, place, i);
    for (int k = 0; k < HARMONIC_TERMS; k++) {
      int at = s->start[clique + 1] - s->start[clique] - 1, dof = local[i].dof[k];
      while (at >= 0 && (dof < 0 || dofs[at] != dof)) {
        at--;
      }
      local[i].dof[k] = at;
    }
  }
}

/* Packs a form over the components of the place into the clique's unknowns, less shift times the
 * lumped volume (NULL: none) of the nodes. */
static void pack(struct harmonic_system *s, int clique, const struct place *place,
                 const double *form, const double *volume, double shift) {
  double full[CLIQUE_MAX][CLIQUE_MAX] = {{0}}, *value = s->values[clique];
  int count = s->start[clique + 1] - s->start[clique], width = HARMONIC_PARTS * place->count;
  struct harmonic_term local[HARMONIC_ELEMENT];
  locate_terms(s, clique, place, local);
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

/* The form of a clique; false when the base state is folded or turned inside out there. */
static bool clique_form(const struct harmonic *h, const struct harmonic_state *state, int clique,
                        int n, double *form) {
  const struct axi_mesh *mesh = h->mesh;
  if (clique < mesh->element_count) {
    return harmonic_element(mesh, &h->geometry[clique], clique, state->u, n, form);
  }
  clique -= mesh->element_count;
  if (clique < mesh->inner_count) {
    harmonic_edge(mesh, clique, state->u, state->pressure, n, form);
    return true;
  }
  clique -= mesh->inner_count;
  if (clique < state->touch_count) {
    harmonic_touch(&state->touch[clique], n, form);
    return true;
  }
  clique -= state->touch_count;
  int skin = state->skin ? state->skin->count : 0;
  if (clique < skin) {
    return harmonic_skin(mesh, &state->skin->turning[clique], state->u, n, form);
  }
  harmonic_contact(&state->contact->touch[clique - skin], n, form);
  return true;
}

static enum status inverted(const struct place *place, struct error *error) {
  return error_set(error, STATUS_INVERTED, NULL,
                   "the axisymmetric state is turned inside out near node %d", place->node[0]);
}

enum status harmonic_system_factor(const struct harmonic *h, struct harmonic_system *s,
                                   const struct harmonic_state *state, int n, double shift,
                                   int *negative, struct error *error) {
  double form[HARMONIC_ELEMENT * HARMONIC_ELEMENT];
  for (int c = 0; c < s->clique_count; c++) {
    struct place place = clique_place(h, state, c);
    bool element = c < h->mesh->element_count;
    if (!clique_form(h, state, c, n, form)) {
      return inverted(&place, error);
    }
    pack(s, c, &place, form, element ? h->volume + (size_t)c * AXI_NODES : NULL, shift);
  }
  *negative = s->dof_count == 0 ? 0 : ldlt_factor(s->ldlt, (const double *const *)s->values);
  return STATUS_OK;
}

enum status harmonic_system_product(const struct harmonic *h, const struct harmonic_state *state,
                                    int n, const double *v, double *value, struct error *error) {
  double form[HARMONIC_ELEMENT * HARMONIC_ELEMENT], local[HARMONIC_ELEMENT];
  *value = 0;
  for (int c = 0; c < clique_count(h, state); c++) {
    struct place place = clique_place(h, state, c);
    int width = HARMONIC_PARTS * place.count;
    if (!clique_form(h, state, c, n, form)) {
      return inverted(&place, error);
    }
    for (int i = 0; i < width; i++) {
      local[i] = v[HARMONIC_PARTS * place.node[i / HARMONIC_PARTS] + i % HARMONIC_PARTS];
    }
    for (int i = 0; i < width; i++) {
      for (int j = 0; j < width; j++) {
        *value += local[i] * form[width * i + j] * local[j];
      }
    }
  }
  return STATUS_OK;
}

enum status harmonic_system_get(struct harmonic *h, const struct harmonic_state *state, int n,
                                struct harmonic_system own[HARMONIC_KINDS],
                                struct harmonic_system **out, struct error *error) {
  int kind = kind_of(n);
  bool more =
      state->touch_count > 0 || state->skin || (state->contact && state->contact->touch_count > 0);
  *out = more ? &own[kind] : &h->system[kind];
  return (*out)->term ? STATUS_OK : system_create(h, state, kind, *out, error);
}

void harmonic_systems_release(struct harmonic_system system[HARMONIC_KINDS]) {
  for (int k = 0; k < HARMONIC_KINDS; k++) {
    system_release(&system[k]);
  }
}
