#include "solver/axi/contact_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void axi_edge_shape(double xi, double n[AXI_EDGE_NODES], double d[AXI_EDGE_NODES]) {
  n[0] = 0.5 * xi * (xi - 1);
  n[1] = 0.5 * xi * (xi + 1);
  n[2] = 1 - xi * xi;
  d[0] = xi - 0.5;
  d[1] = xi + 0.5;
  d[2] = -2 * xi;
}

/* ---- measures ---------------------------------------------------------------------------- */

/* Weights of the Gauss points and the length. */
static void measure(const struct axi_mesh *mesh, struct axi_contact_edge *e) {
  e->length = 0;
  for (int g = 0; g < AXI_EDGE_POINTS; g++) {
    double n[AXI_EDGE_NODES], d[AXI_EDGE_NODES], r = 0, t[2] = {0};
    axi_edge_shape(contact_point[g], n, d);
    for (int a = 0; a < AXI_EDGE_NODES; a++) {
      const double *x = &mesh->position[2 * e->node[a]];
      r += n[a] * x[0];
      t[0] += d[a] * x[0];
      t[1] += d[a] * x[1];
    }
    double ds = contact_weight[g] * hypot(t[0], t[1]);
    e->length += ds;
    e->weight[g] = 2 * M_PI * r * ds;
  }
}

/* Area of an element's meridian by its corners. */
static double meridian_area(const struct axi_mesh *mesh, const struct axi_element *e) {
  double sum = 0;
  for (int a = 0; a < 4; a++) {
    const double *p = &mesh->position[2 * e->node[a]];
    const double *q = &mesh->position[2 * e->node[(a + 1) % 4]];
    sum += 0.5 * (p[0] * q[1] - p[1] * q[0]);
  }
  return fabs(sum);
}

/* The element at every edge: owner[middle node] is the one element of a surface's middle node. */
static enum status stiffen(struct axi_contact *c, double stiffness, struct error *error) {
  const struct axi_mesh *mesh = c->mesh;
  int *owner = malloc(sizeof *owner * (size_t)(mesh->node_count + 1));
  if (!owner) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d nodes", mesh->node_count);
  }
  enum status status = STATUS_OK;
  double softest = INFINITY;
  memset(owner, -1, sizeof *owner * (size_t)mesh->node_count);
  for (int e = 0; e < mesh->element_count; e++) {
    for (int a = 0; a < AXI_NODES; a++) {
      owner[mesh->element[e].node[a]] = e;
    }
  }
  for (int k = 0; status == STATUS_OK && k < c->edge_count; k++) {
    int e = owner[c->edge[k].node[2]];
    if (e < 0) {
      status = error_set(error, STATUS_INVALID, NULL, "edge %d of the mesh has no element", k);
      break;
    }
    double depth = fmin(0.2 * c->wall, meridian_area(mesh, &mesh->element[e]) / c->edge[k].length);
    softest =
        fmin(softest, 60 * material_shear_modulus(&mesh->region[mesh->element[e].region]) / depth);
  }
  for (int k = 0; k < c->edge_count; k++) {
    c->edge[k].stiffness = stiffness > 0 ? stiffness : softest;
  }
  free(owner);
  return status;
}

static void set_lengths(struct axi_contact *c, double offset) {
  double area = 0, length = 0;
  for (int e = 0; e < c->mesh->element_count; e++) {
    area += meridian_area(c->mesh, &c->mesh->element[e]);
  }
  for (int k = 0; k < c->edge_count; k++) {
    length += c->edge[k].length;
  }
  c->wall = length > 0 ? 2 * area / length : 0;
  c->offset = offset > 0 ? offset : c->wall / 200;
  c->reach = 0.6 * c->wall;
}

/* ---- chains ------------------------------------------------------------------------------ */

/* Follows the edges of one surface from edge `first` on: numbers and measures the chain. */
static void follow(struct axi_contact *c, int first, const int *by_start, bool inner) {
  struct axi_contact_chain *chain = &c->chain[c->chain_count];
  const struct axi_mesh *mesh = c->mesh;
  int last = first;
  *chain = (struct axi_contact_chain){.inner = inner};
  for (int k = first; k >= 0 && c->edge[k].chain < 0; k = by_start[c->edge[k].node[1]]) {
    c->edge[k].chain = c->chain_count;
    c->edge[k].arc = chain->length;
    chain->length += c->edge[k].length;
    last = k;
  }
  int start = c->edge[first].node[0], end = c->edge[last].node[1];
  if (mesh->hold[2 * end + 1] == AXI_AHEAD && mesh->master[end] == start) {
    chain->turn = 1;
  } else if (mesh->hold[2 * start + 1] == AXI_AHEAD && mesh->master[start] == end) {
    chain->turn = -1;
  }
  c->chain_count++;
}

static enum status link_surface(struct axi_contact *c, int from, int to, bool inner,
                                struct error *error) {
  int nodes = c->mesh->node_count;
  int *by_start = malloc(sizeof *by_start * 2 * (size_t)(nodes + 1));
  if (!by_start) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d nodes", nodes);
  }
  int *by_end = by_start + nodes;
  memset(by_start, -1, sizeof *by_start * 2 * (size_t)nodes);
  for (int k = from; k < to; k++) {
    by_start[c->edge[k].node[0]] = k;
    by_end[c->edge[k].node[1]] = k;
  }
  for (int k = from; k < to; k++) {
    c->edge[k].before = by_end[c->edge[k].node[0]];
    c->edge[k].behind = by_start[c->edge[k].node[1]];
  }
  for (int k = from; k < to; k++) {
    if (by_end[c->edge[k].node[0]] < 0) {
      follow(c, k, by_start, inner);
    }
  }
  for (int k = from; k < to; k++) { /* closed ones */
    if (c->edge[k].chain < 0) {
      follow(c, k, by_start, inner);
    }
  }
  free(by_start);
  return STATUS_OK;
}

static void find_period(struct axi_contact *c) {
  for (int i = 0; i < c->mesh->node_count && !c->periodic; i++) {
    if (c->mesh->hold[2 * i + 1] == AXI_AHEAD && c->mesh->master[i] >= 0) {
      c->periodic = true;
      c->period = c->mesh->position[2 * i + 1] - c->mesh->position[2 * c->mesh->master[i] + 1];
    }
  }
}

enum status axi_contact_create(const struct axi_mesh *mesh, double stiffness, double offset,
                               struct axi_contact **out, struct error *error) {
  int count = mesh->inner_count + mesh->outer_count;
  size_t edges = (size_t)count + 1;
  enum status status = STATUS_OK;
  struct axi_contact *c = calloc(1, sizeof *c);
  *out = NULL;
  if (c) {
    c->mesh = mesh;
    c->edge_count = count;
    c->edge = calloc(edges, sizeof *c->edge);
    c->chain = calloc(edges, sizeof *c->chain);
    c->position = calloc(2 * (size_t)mesh->node_count + 1, sizeof *c->position);
    c->near = calloc(AXI_EDGE_POINTS * edges, sizeof *c->near);
    c->box = calloc(3 * edges, sizeof *c->box);
  }
  if (!c || !c->edge || !c->chain || !c->position || !c->near || !c->box) {
    status =
        error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the contact of %d edges", count);
    goto done;
  }
  for (int k = 0; k < count; k++) {
    const struct axi_edge *e =
        k < mesh->inner_count ? &mesh->inner[k] : &mesh->outer[k - mesh->inner_count];
    memcpy(c->edge[k].node, e->node, sizeof e->node);
    c->edge[k].chain = -1;
    measure(mesh, &c->edge[k]);
  }
  set_lengths(c, offset);
  find_period(c);
  status = stiffen(c, stiffness, error);
  if (status == STATUS_OK) {
    status = link_surface(c, 0, mesh->inner_count, true, error);
  }
  if (status == STATUS_OK) {
    status = link_surface(c, mesh->inner_count, count, false, error);
  }
done:
  if (status != STATUS_OK) {
    axi_contact_destroy(c);
    return status;
  }
  *out = c;
  return STATUS_OK;
}

void axi_contact_destroy(struct axi_contact *c) {
  if (!c) {
    return;
  }
  free(c->edge);
  free(c->chain);
  free(c->touch);
  free(c->position);
  free(c->near);
  free(c->box);
  free(c);
}
