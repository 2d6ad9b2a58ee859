#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>
#include "solver/fe/ldlt_front.h"
#include "solver/fe/ldlt_internal.h"

/* Working data of one analysis: the graph of nodes that carry unknowns. */
struct analysis {
  const struct ldlt_pattern *pattern;
  cholmod_common common;
  cholmod_factor *symbolic;
  int active_count;
  int *active;    /* node -> active index or -1 */
  int *dof_start; /* active_count + 1, into dof_list: unknowns of each active node */
  int *dof_list;
  int *column;   /* active_count + 1: first column of each node in elimination order */
  int *front_of; /* column -> front */
};

static enum status collect_nodes(struct analysis *a) {
  const struct ldlt_pattern *p = a->pattern;
  a->active = malloc(sizeof *a->active * (size_t)p->node_count);
  a->dof_start = calloc((size_t)p->node_count + 2, sizeof *a->dof_start);
  a->dof_list = malloc(sizeof *a->dof_list * (size_t)p->dof_count);
  if (!a->active || !a->dof_start || !a->dof_list) {
    return STATUS_NO_MEMORY;
  }
  for (int n = 0; n < p->node_count; n++) {
    a->active[n] = -1;
  }
  for (int d = 0; d < p->dof_count; d++) {
    int n = p->node_of[d];
    if (a->active[n] < 0) {
      a->active[n] = a->active_count++;
    }
    a->dof_start[a->active[n] + 2]++;
  }
  for (int n = 0; n < a->active_count; n++) {
    a->dof_start[n + 2] += a->dof_start[n + 1];
  }
  for (int d = 0; d < p->dof_count; d++) {
    a->dof_list[a->dof_start[a->active[p->node_of[d]] + 1]++] = d;
  }
  return STATUS_OK;
}

/* Distinct active nodes of a clique; `seen` marks them with the clique's number + 1. */
static int clique_nodes(const struct analysis *a, int clique, int *seen, int *nodes) {
  const struct ldlt_pattern *p = a->pattern;
  int count = 0;
  for (int i = p->start[clique]; i < p->start[clique + 1]; i++) {
    if (p->dofs[i] < 0) {
      continue;
    }
    int n = a->active[p->node_of[p->dofs[i]]];
    if (seen[n] != clique + 1) {
      seen[n] = clique + 1;
      nodes[count++] = n;
    }
  }
  return count;
}

/* Graph of nodes as a symmetric pattern, upper triangle. NULL when memory runs out. */
static cholmod_sparse *node_graph(struct analysis *a) {
  const struct ldlt_pattern *p = a->pattern;
  int *seen = calloc((size_t)a->active_count + 1, sizeof *seen);
  int *nodes = malloc(sizeof *nodes * ((size_t)a->active_count + 1));
  cholmod_sparse *graph = NULL;
  cholmod_triplet *list = NULL;
  if (!seen || !nodes) {
    goto done;
  }
  size_t pairs = (size_t)a->active_count;
  for (int c = 0; c < p->clique_count; c++) {
    size_t m = (size_t)clique_nodes(a, c, seen, nodes);
    pairs += m * (m + 1) / 2;
  }
  memset(seen, 0, sizeof *seen * ((size_t)a->active_count + 1));
  list = cholmod_allocate_triplet((size_t)a->active_count, (size_t)a->active_count, pairs, 1,
                                  CHOLMOD_PATTERN, &a->common);
  if (!list) {
    goto done;
  }
  int *row = list->i, *column = list->j;
  size_t filled = 0;
  for (int n = 0; n < a->active_count; n++, filled++) {
    row[filled] = column[filled] = n;
  }
  for (int c = 0; c < p->clique_count; c++) {
    int m = clique_nodes(a, c, seen, nodes);
    for (int i = 0; i < m; i++) {
      for (int j = 0; j <= i; j++, filled++) {
        row[filled] = nodes[i] < nodes[j] ? nodes[i] : nodes[j];
        column[filled] = nodes[i] < nodes[j] ? nodes[j] : nodes[i];
      }
    }
  }
  list->nnz = filled;
  graph = cholmod_triplet_to_sparse(list, 0, &a->common);
done:
  cholmod_free_triplet(&list, &a->common);
  free(seen);
  free(nodes);
  return graph;
}

/* Orders and analyses by one method. A node carries three unknowns, so the limits for merging
 * small supernodes are smaller than CHOLMOD's own, which count columns. */
static cholmod_factor *analyse_graph(cholmod_sparse *graph, int ordering, cholmod_common *c) {
  c->nmethods = 1;
  c->method[0].ordering = ordering;
  c->supernodal = CHOLMOD_SUPERNODAL;
  c->postorder = 1;
  c->nrelax[0] = 4;
  c->nrelax[1] = 10;
  c->nrelax[2] = 24;
  return cholmod_analyze(graph, c);
}

/* Minimum degree wins on thin-walled bodies, nested dissection on larger and touching ones. It
 * takes several times as long, as long as some factorisations of a small body, so that it is tried
 * only where a node costs much. The order with the fewer operations is kept. */
static enum status order_nodes(struct analysis *a) {
  static const double much = 1.5e4; /* operations on the graph of nodes */
  cholmod_common *c = &a->common;
  c->print = 0;
  cholmod_sparse *graph = node_graph(a);
  if (graph) {
    a->symbolic = analyse_graph(graph, CHOLMOD_AMD, c);
  }
  double operations = c->fl;
  if (a->symbolic && operations > much * a->active_count) {
    cholmod_factor *other = analyse_graph(graph, CHOLMOD_METIS, c);
    if (other && c->fl < operations) {
      cholmod_factor *swap = a->symbolic;
      a->symbolic = other;
      other = swap;
    }
    cholmod_free_factor(&other, c);
  }
  cholmod_free_sparse(&graph, c);
  return a->symbolic ? STATUS_OK : STATUS_NO_MEMORY;
}

static int node_weight(const struct analysis *a, int ordered) {
  const int *perm = a->symbolic->Perm;
  int n = perm[ordered];
  return a->dof_start[n + 1] - a->dof_start[n];
}

/* Columns in elimination order and the position of every unknown. */
static enum status expand_columns(struct analysis *a, struct ldlt *f) {
  const int *perm = a->symbolic->Perm;
  a->column = malloc(sizeof *a->column * ((size_t)a->active_count + 1));
  a->front_of = malloc(sizeof *a->front_of * ((size_t)f->dof_count + 1));
  f->position = malloc(sizeof *f->position * ((size_t)f->dof_count + 1));
  if (!a->column || !a->front_of || !f->position) {
    return STATUS_NO_MEMORY;
  }
  int next = 0;
  for (int n = 0; n < a->active_count; n++) {
    a->column[n] = next;
    for (int i = a->dof_start[perm[n]]; i < a->dof_start[perm[n] + 1]; i++) {
      f->position[a->dof_list[i]] = next++;
    }
  }
  a->column[a->active_count] = next;
  return STATUS_OK;
}

/* Fronts and their rows from the supernodes of the node graph. */
static enum status expand_fronts(struct analysis *a, struct ldlt *f) {
  const int *super = a->symbolic->super, *start = a->symbolic->pi, *list = a->symbolic->s;
  f->front_count = (int)a->symbolic->nsuper;
  f->front = calloc((size_t)f->front_count + 1, sizeof *f->front);
  size_t total = 0;
  for (int k = 0; k < f->front_count; k++) {
    for (int i = start[k]; i < start[k + 1]; i++) {
      total += (size_t)node_weight(a, list[i]);
    }
  }
  f->row = malloc(sizeof *f->row * (total + 1));
  f->parent_row = malloc(sizeof *f->parent_row * (total + 1));
  if (!f->front || !f->row || !f->parent_row) {
    return STATUS_NO_MEMORY;
  }
  size_t next_row = 0, next_value = 0;
  for (int k = 0; k < f->front_count; k++) {
    struct front *front = &f->front[k];
    front->first = a->column[super[k]];
    front->columns = a->column[super[k + 1]] - front->first;
    front->row = next_row;
    front->value = next_value;
    for (int i = start[k]; i < start[k + 1]; i++) {
      for (int w = 0; w < node_weight(a, list[i]); w++) {
        f->row[next_row++] = a->column[list[i]] + w;
      }
    }
    front->rows = (int)(next_row - front->row);
    next_value += (size_t)front->rows * (size_t)front->columns;
    for (int c = 0; c < front->columns; c++) {
      a->front_of[front->first + c] = k;
      double height = front->rows - c;
      f->statistics.flops += height * height;
    }
    if (front->rows > f->statistics.largest_front) {
      f->statistics.largest_front = front->rows;
    }
  }
  f->statistics.factor_entries = next_value;
  return STATUS_OK;
}

/* Parents, and the places of a front's lower rows in its parent. False if the tree is not in
 * postorder. */
static bool link_fronts(const struct analysis *a, struct ldlt *f) {
  int waiting = 0;
  for (int k = 0; k < f->front_count; k++) {
    struct front *front = &f->front[k];
    const int *row = f->row + front->row;
    front->parent = front->rows > front->columns ? a->front_of[row[front->columns]] : -1;
    while (waiting > 0 && f->front[f->pending[waiting - 1]].parent == k) {
      const struct front *child = &f->front[f->pending[--waiting]];
      int at = 0;
      for (int i = child->columns; i < child->rows; i++) {
        while (at < front->rows && row[at] != f->row[child->row + (size_t)i]) {
          at++;
        }
        if (at == front->rows) {
          return false;
        }
        f->parent_row[child->row + (size_t)i] = at;
      }
    }
    if (front->parent >= 0) {
      f->pending[waiting++] = k;
    }
  }
  return waiting == 0;
}

/* Places of the update matrices on the two stacks, in postorder. */
static void lay_stacks(struct ldlt *f, size_t size[2]) {
  size_t top[2] = {0, 0};
  int waiting = 0;
  for (int k = f->front_count - 1; k >= 0; k--) {
    int parent = f->front[k].parent;
    f->front[k].level = parent < 0 ? 0 : 1 - f->front[parent].level;
  }
  size[0] = size[1] = 0;
  for (int k = 0; k < f->front_count; k++) {
    struct front *front = &f->front[k];
    int level = front->level;
    while (waiting > 0 && f->front[f->pending[waiting - 1]].parent == k) {
      top[1 - level] = f->front[f->pending[--waiting]].stack;
    }
    front->stack = top[level];
    if (front->parent >= 0) {
      size_t below = (size_t)(front->rows - front->columns);
      top[level] += below * below;
      size[level] = top[level] > size[level] ? top[level] : size[level];
      f->pending[waiting++] = k;
    }
  }
}

/* Gives every clique to the front that eliminates its first unknown. */
static enum status place_cliques(const struct analysis *a, struct ldlt *f) {
  const struct ldlt_pattern *p = a->pattern;
  size_t entries = (size_t)p->start[p->clique_count];
  int *home = malloc(sizeof *home * ((size_t)p->clique_count + 1));
  int *place = malloc(sizeof *place * ((size_t)f->dof_count + 1));
  enum status status = STATUS_OK;
  f->clique = malloc(sizeof *f->clique * ((size_t)p->clique_count + 1));
  f->clique_start = malloc(sizeof *f->clique_start * ((size_t)p->clique_count + 1));
  f->clique_row = malloc(sizeof *f->clique_row * (entries + 1));
  if (!home || !place || !f->clique || !f->clique_start || !f->clique_row) {
    status = STATUS_NO_MEMORY;
    goto done;
  }
  memcpy(f->clique_start, p->start, sizeof *p->start * ((size_t)p->clique_count + 1));
  for (int c = 0; c < p->clique_count; c++) {
    int first = f->dof_count;
    for (int i = p->start[c]; i < p->start[c + 1]; i++) {
      if (p->dofs[i] >= 0 && f->position[p->dofs[i]] < first) {
        first = f->position[p->dofs[i]];
      }
    }
    home[c] = first < f->dof_count ? a->front_of[first] : -1;
    if (home[c] >= 0) {
      f->front[home[c]].clique_count++;
    }
  }
  int next = 0;
  for (int k = 0; k < f->front_count; k++) {
    f->front[k].clique_first = next;
    next += f->front[k].clique_count;
    f->front[k].clique_count = 0;
  }
  for (int c = 0; c < p->clique_count; c++) {
    if (home[c] >= 0) {
      struct front *front = &f->front[home[c]];
      f->clique[front->clique_first + front->clique_count++] = c;
    }
  }
  for (int k = 0; k < f->front_count; k++) {
    const struct front *front = &f->front[k];
    for (int i = 0; i < front->rows; i++) {
      place[f->row[front->row + (size_t)i]] = i;
    }
    for (int q = 0; q < front->clique_count; q++) {
      int c = f->clique[front->clique_first + q];
      for (int i = p->start[c]; i < p->start[c + 1]; i++) {
        f->clique_row[i] = p->dofs[i] < 0 ? -1 : place[f->position[p->dofs[i]]];
      }
    }
  }
done:
  free(home);
  free(place);
  return status;
}

static enum status allocate_values(struct ldlt *f) {
  size_t stack[2], work = 0, entries = f->statistics.factor_entries;
  size_t largest = (size_t)f->statistics.largest_front;
  lay_stacks(f, stack);
  for (int k = 0; k < f->front_count; k++) {
    size_t needed = ldlt_front_work(f->front[k].rows, f->front[k].columns);
    work = needed > work ? needed : work;
  }
  f->value = malloc(sizeof *f->value * (entries + 1));
  f->sign = malloc(sizeof *f->sign * ((size_t)f->dof_count + 1));
  f->work = malloc(sizeof *f->work * (work + 1));
  f->column = malloc(sizeof *f->column * (largest + 1));
  f->run = malloc(sizeof *f->run * (largest + 1));
  f->stack[0] = malloc(sizeof **f->stack * (stack[0] + 1));
  f->stack[1] = malloc(sizeof **f->stack * (stack[1] + 1));
  f->vector = malloc(sizeof *f->vector * (2 * (size_t)f->dof_count + 1));
  f->statistics.memory_bytes =
      sizeof(double) * (entries + work + stack[0] + stack[1] + 3 * (size_t)f->dof_count) +
      sizeof(int) * (size_t)f->clique_start[f->clique_count];
  bool complete = f->value && f->sign && f->work && f->column && f->run && f->stack[0] &&
                  f->stack[1] && f->vector;
  return complete ? STATUS_OK : STATUS_NO_MEMORY;
}

static enum status build(struct analysis *a, struct ldlt *f) {
  enum status status = collect_nodes(a);
  if (status == STATUS_OK) {
    status = order_nodes(a);
  }
  if (status == STATUS_OK) {
    status = expand_columns(a, f);
  }
  if (status == STATUS_OK) {
    status = expand_fronts(a, f);
  }
  if (status != STATUS_OK) {
    return status;
  }
  f->pending = malloc(sizeof *f->pending * ((size_t)f->front_count + 1));
  if (!f->pending) {
    return STATUS_NO_MEMORY;
  }
  if (!link_fronts(a, f)) {
    return STATUS_INTERNAL;
  }
  status = place_cliques(a, f);
  return status == STATUS_OK ? allocate_values(f) : status;
}

/* What decides the analysis, in one array; `count` numbers. */
static int *list_pattern(const struct ldlt_pattern *p, size_t *count) {
  size_t nodes = (size_t)p->dof_count, starts = (size_t)p->clique_count + 1;
  size_t dofs = (size_t)p->start[p->clique_count];
  int *list = malloc(sizeof *list * (nodes + starts + dofs));
  *count = nodes + starts + dofs;
  if (list) {
    memcpy(list, p->node_of, sizeof *list * nodes);
    memcpy(list + nodes, p->start, sizeof *list * starts);
    memcpy(list + nodes + starts, p->dofs, sizeof *list * dofs);
  }
  return list;
}

bool ldlt_fits(const struct ldlt *f, const struct ldlt_pattern *p) {
  size_t nodes = (size_t)p->dof_count, starts = (size_t)p->clique_count + 1;
  return f->dof_count == p->dof_count && f->clique_count == p->clique_count &&
         f->pattern_count == nodes + starts + (size_t)p->start[p->clique_count] &&
         memcmp(f->pattern, p->node_of, sizeof *f->pattern * nodes) == 0 &&
         memcmp(f->pattern + nodes, p->start, sizeof *f->pattern * starts) == 0 &&
         memcmp(f->pattern + nodes + starts, p->dofs,
                sizeof *f->pattern * (f->pattern_count - nodes - starts)) == 0;
}

enum status ldlt_create(const struct ldlt_pattern *pattern, struct ldlt **out,
                        struct error *error) {
  struct analysis a = {.pattern = pattern};
  struct ldlt *f = calloc(1, sizeof *f);
  *out = NULL;
  if (!f) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a factorisation");
  }
  f->dof_count = pattern->dof_count;
  f->clique_count = pattern->clique_count;
  cholmod_start(&a.common);
  f->pattern = list_pattern(pattern, &f->pattern_count);
  enum status status = f->pattern ? build(&a, f) : STATUS_NO_MEMORY;
  if (status != STATUS_OK) {
    error_set(error, status, NULL, "the analysis of %d unknowns failed: %s", f->dof_count,
              status_sentence(status));
    ldlt_destroy(f);
    f = NULL;
  }
  cholmod_free_factor(&a.symbolic, &a.common);
  cholmod_finish(&a.common);
  free(a.active);
  free(a.dof_start);
  free(a.dof_list);
  free(a.column);
  free(a.front_of);
  *out = f;
  return status;
}

void ldlt_destroy(struct ldlt *f) {
  if (!f) {
    return;
  }
  free(f->pattern);
  free(f->position);
  free(f->front);
  free(f->row);
  free(f->parent_row);
  free(f->clique);
  free(f->clique_start);
  free(f->clique_row);
  free(f->value);
  free(f->sign);
  free(f->work);
  free(f->column);
  free(f->run);
  free(f->stack[0]);
  free(f->stack[1]);
  free(f->vector);
  free(f->pending);
  free(f);
}

int ldlt_clique_count(const struct ldlt *f) {
  return f->clique_count;
}

struct ldlt_statistics ldlt_statistics(const struct ldlt *f) {
  return f->statistics;
}
