#include "solver/axi/model_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- numbering --------------------------------------------------------------------------- */

static enum axi_hold hold_of(const struct axi_mesh *mesh, int node, int component) {
  return (enum axi_hold)mesh->hold[2 * node + component];
}

/* The node whose component is that of `node`; ahead counts the elongations in between. -1 when the
 * ties lead in a circle or nowhere. */
static int leader(const struct axi_mesh *mesh, int node, int component, int *ahead) {
  *ahead = 0;
  for (int k = 0; k <= mesh->node_count && node >= 0 && node < mesh->node_count; k++) {
    enum axi_hold hold = hold_of(mesh, node, component);
    if (hold != AXI_TIED && hold != AXI_AHEAD) {
      return node;
    }
    *ahead += hold == AXI_AHEAD;
    node = mesh->master[node];
  }
  return -1;
}

struct axi_place *axi_model_place(const struct axi_model *m, int node, int component) {
  int row = m->shell ? node / m->options.row_nodes : 0;
  return &m->place[m->shell ? SHELL_ROW * row + component : 2 * node + component];
}

enum status axi_model_number(struct axi_model *m, int node, int component, struct error *error) {
  const struct axi_mesh *mesh = m->mesh;
  int ahead = 0, first = leader(mesh, node, component, &ahead);
  enum axi_hold hold = first < 0 ? AXI_FREE : hold_of(mesh, first, component);
  ahead += hold == AXI_PLATE;
  if (first < 0 || hold > AXI_PLATE || ahead > 1 || (ahead && component == 0)) {
    return error_set(error, STATUS_INVALID, NULL,
                     "node %d of the mesh is tied to no free or fixed node", node);
  }
  struct axi_place *place = axi_model_place(m, node, component);
  struct axi_place *lead = axi_model_place(m, first, component);
  if (hold == AXI_FREE && lead->base < 0) {
    m->node_of[m->size] = first;
    lead->base = m->size++;
  }
  place->base = lead->base;
  place->plus = ahead;
  m->elongation |= ahead > 0;
  return STATUS_OK;
}

static enum status number(struct axi_model *m, struct error *error) {
  enum status status = STATUS_OK;
  for (int i = 0; i < 2 * m->mesh->node_count; i++) {
    m->place[i].base = -1;
  }
  if (m->shell) {
    status = axi_model_number_rows(m, error);
  }
  for (int i = 0; !m->shell && status == STATUS_OK && i < 2 * m->mesh->node_count; i++) {
    status = axi_model_number(m, i / 2, i % 2, error);
  }
  if (status == STATUS_OK && m->elongation) {
    m->node_of[m->size++] = m->mesh->node_count;
  }
  if (status == STATUS_OK && m->size == (m->elongation ? 1 : 0)) {
    status = error_set(error, STATUS_INVALID, NULL, "no node of the mesh is free to move");
  }
  return status;
}

/* ---- cliques ----------------------------------------------------------------------------- */

/* Place of an unknown in the clique's list, which it joins. */
static signed char join(struct axi_clique *c, int dof) {
  for (int k = 0; k < c->count; k++) {
    if (c->dof[k] == dof) {
      return (signed char)k;
    }
  }
  c->dof[c->count] = dof;
  return (signed char)c->count++;
}

void axi_clique_join(const struct axi_model *m, struct axi_clique *c) {
  int bases = 0;
  c->elongation = -1;
  c->plain = true;
  c->count = 0;
  for (int i = 0; i < c->locals; i++) {
    bases += c->place[i].base >= 0;
    c->at[i] = c->place[i].base < 0 ? -1 : join(c, c->place[i].base);
    c->plain &= c->place[i].plus == 0;
  }
  c->plain &= c->count == bases;
  if (c->plain) {
    c->count = c->locals;
    for (int i = 0; i < c->locals; i++) {
      c->dof[i] = c->place[i].base;
    }
    return;
  }
  for (int i = 0; i < c->locals; i++) {
    if (c->place[i].plus != 0) {
      c->elongation = join(c, m->size - 1);
    }
  }
}

void axi_clique_init(const struct axi_model *m, const int *node, int count, struct axi_clique *c) {
  *c = (struct axi_clique){.locals = 2 * count};
  for (int i = 0; i < c->locals; i++) {
    c->place[i] = *axi_model_place(m, node[i / 2], i % 2);
  }
  axi_clique_join(m, c);
}

static enum status make_cliques(struct axi_model *m, struct error *error) {
  const struct axi_mesh *mesh = m->mesh;
  size_t room = 0;
  for (int k = 0; k < m->clique_count; k++) {
    bool element = k < mesh->element_count;
    int edge = k - mesh->element_count;
    if (edge >= mesh->inner_count) {
      const struct axi_turning *t = &m->skin.turning[edge - mesh->inner_count];
      axi_clique_init(m, t->node, t->count, &m->clique[k]);
    } else if (m->shell) {
      axi_clique_init_rows(
          m, element ? axi_shell_element_row(m->shell, k) : axi_shell_edge_row(m->shell, edge),
          &m->clique[k]);
    } else {
      axi_clique_init(m, element ? mesh->element[k].node : mesh->inner[edge].node,
                      element ? AXI_NODES : AXI_EDGE_NODES, &m->clique[k]);
    }
    room += (size_t)(m->clique[k].count * (m->clique[k].count + 1) / 2);
  }
  m->room = malloc((room + 1) * sizeof *m->room);
  if (!m->room) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d elements", m->clique_count);
  }
  room = 0;
  for (int k = 0; k < m->clique_count; k++) {
    m->value[k] = m->clique[k].value = m->room + room;
    room += (size_t)(m->clique[k].count * (m->clique[k].count + 1) / 2);
  }
  return STATUS_OK;
}

static enum status make_skin(struct axi_model *m, struct error *error) {
  if (m->options.row_nodes > 0) {
    return error_set(error, STATUS_INVALID, NULL, "a shell has no skin of its own");
  }
  return axi_skin_create(m->mesh, m->options.skin, &m->skin, error);
}

static enum status make_contact(struct axi_model *m, struct error *error) {
  enum status status = axi_contact_create(m->mesh, m->options.contact_stiffness,
                                          m->options.contact_offset, &m->contact, error);
  if (status != STATUS_OK) {
    return status;
  }
  size_t bytes = sizeof *m->first_partners * (size_t)(m->contact->edge_count + 1);
  m->first_partners = malloc(bytes);
  if (!m->first_partners) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the contact");
  }
  memset(m->first_partners, -1, bytes);
  return STATUS_OK;
}

/* ---- geometry ---------------------------------------------------------------------------- */

static enum status measure(struct axi_model *m, struct error *error) {
  const struct axi_mesh *mesh = m->mesh;
  double total = 0, low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int e = 0; e < mesh->element_count; e++) {
    double x[AXI_NODES][2];
    const int *node = mesh->element[e].node;
    for (int i = 0; i < AXI_DOFS; i++) {
      double at = x[i / 2][i % 2] = mesh->position[2 * node[i / 2] + i % 2];
      low[i % 2] = fmin(low[i % 2], at);
      high[i % 2] = fmax(high[i % 2], at);
    }
    if (!axi_geometry_init(x, &m->geometry[e])) {
      return error_set(
          error, STATUS_GEOMETRY, NULL,
          "element %d at r = %.4g m, z = %.4g m is turned inside out or beyond the axis", e,
          x[8][0], x[8][1]);
    }
    for (int g = 0; g < AXI_POINTS; g++) {
      const struct axi_point *p = &m->geometry[e].point[g];
      total += p->weight;
      for (int i = 0; i < AXI_DOFS; i++) {
        const struct axi_place *place = axi_model_place(m, node[i / 2], i % 2);
        int dof = place->base >= 0 ? place->base : place->plus > 0 ? m->size - 1 : -1;
        if (dof >= 0) {
          m->weight[dof] += p->weight * p->n[i / 2];
        }
      }
    }
  }
  for (int i = 0; i < m->size; i++) {
    m->weight[i] /= total;
  }
  m->length = fmax(high[0] - low[0], high[1] - low[1]);
  return STATUS_OK;
}

/* ---- create and destroy ------------------------------------------------------------------ */

static bool reserve(struct axi_model *m) {
  const struct axi_mesh *mesh = m->mesh;
  size_t nodes = (size_t)mesh->node_count, dofs = 2 * nodes + 1;
  m->fixed_count = mesh->element_count + mesh->inner_count + m->skin.count;
  m->clique_count = m->clique_capacity = m->fixed_count;
  size_t cliques = (size_t)m->clique_count;
  m->geometry = malloc(((size_t)mesh->element_count + 1) * sizeof *m->geometry);
  m->place = calloc(2 * nodes + 1, sizeof *m->place);
  m->node_of = calloc(dofs, sizeof *m->node_of);
  m->weight = calloc(dofs, sizeof *m->weight);
  m->clique = calloc(cliques + 1, sizeof *m->clique);
  m->value = calloc(cliques + 1, sizeof *m->value);
  m->u = calloc(dofs, sizeof *m->u);
  m->q = calloc(dofs, sizeof *m->q);
  m->force = calloc(dofs, sizeof *m->force);
  m->volume_gradient = calloc(dofs, sizeof *m->volume_gradient);
  m->column = calloc(dofs, sizeof *m->column);
  return m->geometry && m->place && m->node_of && m->weight && m->clique && m->value && m->u &&
         m->q && m->force && m->volume_gradient && m->column;
}

enum status axi_model_create(const struct axi_mesh *mesh, const struct axi_model_options *options,
                             struct axi_model **out, struct error *error) {
  *out = NULL;
  struct axi_model *m = calloc(1, sizeof *m);
  enum status status = STATUS_OK;
  if (m) {
    m->mesh = mesh;
    m->options = options ? *options : (struct axi_model_options){.contact = false};
  }
  if (m && m->options.skin > 0) {
    status = make_skin(m, error);
  }
  if (status == STATUS_OK && (!m || !reserve(m))) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a model of %d nodes",
                       mesh->node_count);
  }
  if (status == STATUS_OK && m->options.row_nodes > 0) {
    status = axi_shell_create(mesh, m->options.row_nodes, &m->shell, error);
  }
  if (status == STATUS_OK) {
    status = number(m, error);
  }
  if (status == STATUS_OK) {
    status = measure(m, error);
  }
  if (status == STATUS_OK) {
    status = make_cliques(m, error);
  }
  if (status == STATUS_OK && m->options.contact) {
    status = make_contact(m, error);
  }
  if (status != STATUS_OK) {
    axi_model_destroy(m);
    return status;
  }
  *out = m;
  return STATUS_OK;
}

void axi_model_destroy(struct axi_model *m) {
  if (!m) {
    return;
  }
  ldlt_destroy(m->factor[0]);
  ldlt_destroy(m->factor[1]);
  axi_shell_destroy(m->shell);
  free(m->geometry);
  free(m->place);
  free(m->node_of);
  free(m->weight);
  free(m->clique);
  free((void *)m->value);
  free(m->room);
  axi_contact_destroy(m->contact);
  axi_skin_release(&m->skin);
  free(m->partners);
  free(m->first_partners);
  free(m->contact_room);
  free(m->u);
  free(m->q);
  free(m->force);
  free(m->volume_gradient);
  free(m->column);
  free(m);
}

/* ---- views ------------------------------------------------------------------------------- */

const struct axi_mesh *axi_model_mesh(const struct axi_model *model) {
  return model->mesh;
}

const struct axi_geometry *axi_model_geometry(const struct axi_model *model, int element) {
  return &model->geometry[element];
}

const struct axi_skin *axi_model_skin(const struct axi_model *model) {
  return model->skin.count > 0 ? &model->skin : NULL;
}

struct axi_contact *axi_model_contact(const struct axi_model *model) {
  return model->contact;
}

int axi_model_size(const struct axi_model *model) {
  return model->size;
}

bool axi_model_has_elongation(const struct axi_model *model) {
  return model->elongation;
}

int axi_model_equation(const struct axi_model *model, int node, int component) {
  bool inside = model->shell && node % model->options.row_nodes != model->options.row_nodes / 2;
  return inside ? -1 : axi_model_place(model, node, component)->base;
}

void axi_model_expand(const struct axi_model *model, const double *x, double *u) {
  double h = model->elongation ? x[model->size - 1] : 0, q[SHELL_ROW];
  int rows = model->shell ? model->mesh->node_count / model->options.row_nodes : 0;
  for (int row = 0; row < rows; row++) {
    axi_model_row(model, x, row, q);
    axi_shell_expand(model->shell, row, q, u);
  }
  for (int i = 0; !model->shell && i < 2 * model->mesh->node_count; i++) {
    const struct axi_place *p = &model->place[i];
    u[i] = (p->base >= 0 ? x[p->base] : 0) + p->plus * h + model->mesh->offset[i];
  }
}

void axi_model_gather(const struct axi_model *model, const double *u, double *x) {
  if (model->shell) {
    axi_model_gather_rows(model, u, x);
    return;
  }
  for (int i = 0; i < 2 * model->mesh->node_count; i++) {
    const struct axi_place *p = &model->place[i];
    if (p->base >= 0 && p->plus == 0) {
      x[p->base] = u[i];
    }
  }
  for (int i = 0; i < 2 * model->mesh->node_count; i++) {
    const struct axi_place *p = &model->place[i];
    if (p->plus > 0) {
      x[model->size - 1] = u[i] - (p->base >= 0 ? x[p->base] : 0);
    }
  }
}

void axi_element_displacements(const struct axi_mesh *mesh, int element, const double *u,
                               double local[AXI_DOFS]) {
  for (int i = 0; i < AXI_DOFS; i++) {
    local[i] = u[2 * mesh->element[element].node[i / 2] + i % 2];
  }
}

struct continuation_options axi_defaults(const struct axi_model *model) {
  struct continuation_options options = continuation_defaults(model->length);
  options.swing = model->contact ? 100 : 1;
  options.step_max = 0.02 * model->length;
  return options;
}

enum status axi_state_create(const struct axi_model *model, struct axi_state *state,
                             struct error *error) {
  *state = (struct axi_state){.stiffness = NAN};
  state->x = calloc((size_t)model->size, sizeof *state->x);
  state->u = calloc(2 * (size_t)model->mesh->node_count, sizeof *state->u);
  if (!state->x || !state->u) {
    axi_state_destroy(state);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d unknowns", model->size);
  }
  return STATUS_OK;
}

void axi_state_destroy(struct axi_state *state) {
  free(state->x);
  free(state->u);
  *state = (struct axi_state){.x = NULL};
}

void axi_state_copy(const struct axi_model *model, const struct axi_state *from,
                    struct axi_state *to) {
  struct axi_state old = *to;
  *to = *from;
  to->x = memcpy(old.x, from->x, sizeof *old.x * (size_t)model->size);
  to->u = memcpy(old.u, from->u, sizeof *old.u * 2 * (size_t)model->mesh->node_count);
}
