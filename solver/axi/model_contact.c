/* Contact in a model: its forces, and its partners as cliques of the tangent. */
#include <stdlib.h>
#include <string.h>
#include "solver/axi/model_internal.h"

/* Places of a slave's and a master's components; the axis as master leaves the slave alone. */
static void set_places(const struct axi_model *m, int slave, int master, int shift,
                       struct axi_clique *c) {
  *c = (struct axi_clique){.locals = TOUCH_DOFS};
  for (int i = 0; i < TOUCH_DOFS; i++) {
    int edge = i < AXI_EDGE_DOFS || master < 0 ? slave : master;
    int node = m->contact->edge[edge].node[i / 2 % AXI_EDGE_NODES];
    c->place[i] = m->place[2 * node + i % 2];
    c->place[i].plus += i >= AXI_EDGE_DOFS && i % 2 == 1 ? shift : 0;
  }
}

static int find_partners(const struct axi_model *m, int slave, int master, int shift) {
  for (int k = m->first_partners[slave]; k >= 0; k = m->partners[k].next) {
    if (m->partners[k].master == master && m->partners[k].shift == shift) {
      return k;
    }
  }
  return -1;
}

static void drop_factors(struct axi_model *m) {
  for (int k = 0; k < 2; k++) {
    ldlt_destroy(m->factor[k]);
    m->factor[k] = NULL;
  }
}

/* Room for twice as many partners. */
static bool grow(struct axi_model *m) {
  int partners = 2 * (m->clique_capacity - m->fixed_count) + 256;
  size_t cliques = (size_t)(m->fixed_count + partners);
  struct axi_clique *clique = realloc(m->clique, sizeof *clique * cliques);
  m->clique = clique ? clique : m->clique;
  const double **value = realloc((void *)m->value, sizeof *value * cliques);
  m->value = value ? value : m->value;
  struct axi_partners *p = realloc(m->partners, sizeof *p * (size_t)partners);
  m->partners = p ? p : m->partners;
  double *room = realloc(m->contact_room, sizeof *room * CONTACT_CLIQUE * (size_t)partners);
  m->contact_room = room ? room : m->contact_room;
  if (!clique || !value || !p || !room) {
    return false;
  }
  for (int k = m->fixed_count; k < m->clique_count; k++) {
    m->clique[k].value = room + CONTACT_CLIQUE * (size_t)(k - m->fixed_count);
  }
  m->clique_capacity = m->fixed_count + partners;
  return true;
}

static bool add_partners(struct axi_model *m, int slave, int master, int shift) {
  if (find_partners(m, slave, master, shift) >= 0) {
    return true;
  }
  if (m->clique_count == m->clique_capacity && !grow(m)) {
    return false;
  }
  int k = m->clique_count - m->fixed_count;
  struct axi_clique *c = &m->clique[m->clique_count];
  m->partners[k] = (struct axi_partners){slave, master, shift, m->first_partners[slave]};
  m->first_partners[slave] = k;
  set_places(m, slave, master, shift, c);
  axi_clique_join(m, c);
  c->value = m->contact_room + CONTACT_CLIQUE * (size_t)k;
  m->value[m->clique_count++] = NULL;
  return true;
}

/* Makes partners of everything that touches and, so that the factors last, of what is near. */
static bool renew_partners(struct axi_model *m) {
  const struct axi_contact *c = m->contact;
  bool done = true;
  drop_factors(m);
  if (m->clique_count - m->fixed_count > 8 * c->edge_count) {
    m->clique_count = m->fixed_count;
    memset(m->first_partners, -1, sizeof *m->first_partners * (size_t)c->edge_count);
  }
  for (int k = 0; done && k < c->touch_count; k++) {
    done = add_partners(m, c->touch[k].slave, c->touch[k].master, c->touch[k].shift);
  }
  for (int k = 0; done && k < c->near_count; k++) {
    const struct axi_near *near = &c->near[k];
    const struct axi_contact_edge *master = &c->edge[near->master];
    const int candidate[3] = {near->master, master->before, master->behind};
    for (int i = 0; done && i < 3; i++) {
      done = candidate[i] < 0 || add_partners(m, near->slave, candidate[i], near->shift);
    }
  }
  return done;
}

static bool all_known(const struct axi_model *m) {
  const struct axi_contact *c = m->contact;
  for (int k = 0; k < c->touch_count; k++) {
    if (find_partners(m, c->touch[k].slave, c->touch[k].master, c->touch[k].shift) < 0) {
      return false;
    }
  }
  return true;
}

static void add_matrices(struct axi_model *m) {
  const struct axi_contact *c = m->contact;
  for (int k = m->fixed_count; k < m->clique_count; k++) {
    m->value[k] = NULL;
  }
  for (int k = 0; k < c->touch_count; k++) {
    const struct axi_touch *t = &c->touch[k];
    int at = m->fixed_count + find_partners(m, t->slave, t->master, t->shift);
    struct axi_clique *clique = &m->clique[at];
    if (!m->value[at]) {
      memset(clique->value, 0, sizeof *clique->value * CONTACT_CLIQUE);
      m->value[at] = clique->value;
    }
    axi_clique_add(clique, t->packed);
  }
}

enum status axi_model_add_contact(struct axi_model *m, const double *x, bool tangent,
                                  struct error *error) {
  struct axi_contact *c = m->contact;
  double h = m->elongation ? x[m->size - 1] : 0;
  enum status status = axi_contact_evaluate(c, m->u, h, tangent, error);
  if (status != STATUS_OK) {
    return status;
  }
  m->contact_energy = c->energy;
  for (int k = 0; k < c->touch_count; k++) {
    struct axi_clique place;
    set_places(m, c->touch[k].slave, c->touch[k].master, c->touch[k].shift, &place);
    axi_clique_add_force(m, &place, c->touch[k].force, m->force);
  }
  if (tangent) {
    if (!all_known(m) && !renew_partners(m)) {
      return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d points in contact",
                       c->touch_count);
    }
    add_matrices(m);
  }
  return STATUS_OK;
}
