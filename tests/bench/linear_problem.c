#include "tests/bench/linear_problem.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/path.h"
#include "solver/mesh/pneunet.h"

/* The unknowns of every clique, in the order of its values. */
static enum status list_cliques(struct linear_problem *p) {
  const struct fe_model *m = p->model;
  int elements = p->mesh.element_count, pairs = m->use_contact ? m->contact.pair_count : 0;
  p->clique_count = elements + pairs;
  p->start = calloc((size_t)p->clique_count + 1, sizeof *p->start);
  p->dofs =
      calloc((size_t)elements * ELEMENT_DOFS + (size_t)pairs * CONTACT_DOFS + 1, sizeof *p->dofs);
  if (!p->start || !p->dofs) {
    return STATUS_NO_MEMORY;
  }
  int next = 0;
  for (int e = 0; e < elements; e++) {
    for (int r = 0; r < ELEMENT_DOFS; r++) {
      int node = p->mesh.element_nodes[HEX27_NODES * e + r % HEX27_NODES];
      p->dofs[next++] = m->equation[3 * node + r / HEX27_NODES];
    }
    p->start[e + 1] = next;
  }
  for (int c = 0; c < pairs; c++) {
    int nodes[CONTACT_NODES];
    contact_nodes(&m->contact, c, nodes);
    for (int r = 0; r < CONTACT_DOFS; r++) {
      p->dofs[next++] = m->equation[3 * nodes[r / 3] + r % 3];
    }
    p->start[elements + c + 1] = next;
    p->touching += m->clique_value[elements + c] != NULL;
  }
  return STATUS_OK;
}

static enum status keep_pressure(void *context, const struct path_point *point) {
  *(double *)context = point->pressure;
  return STATUS_OK;
}

/* Brings the state as far up the path as it goes, and evaluates the tangent there. */
static enum status follow(const struct job_spec *spec, double stiffness_factor,
                          struct linear_problem *p, struct error *error) {
  struct equilibrium *solver = NULL;
  enum status status = equilibrium_create(p->model, &solver, error);
  if (status != STATUS_OK) {
    return status;
  }
  solver->options.traction_tolerance = 0.01 * spec->load.pressure_to;
  struct path_options path = {.pressure_to = spec->load.pressure_to,
                              .steps = spec->load.steps,
                              .visit = keep_pressure,
                              .context = &p->pressure};
  p->reached = path_follow(solver, &path, &p->state, error) == STATUS_OK;
  p->factorizations = p->model->statistics.factorizations;
  equilibrium_destroy(solver);
  struct fe_load load = {p->pressure, stiffness_factor * p->pressure, 0};
  return model_evaluate(p->model, &p->state, &load, true);
}

enum status linear_problem_create(const struct job_spec *spec, bool contact,
                                  double stiffness_factor, struct linear_problem *p,
                                  struct error *error) {
  *p = (struct linear_problem){0};
  enum status status = pneunet_mesh(spec, &p->mesh, error);
  if (status == STATUS_OK) {
    status = model_create(&p->mesh, &spec->material, contact, &p->model, error);
  }
  if (status == STATUS_OK) {
    status = state_create(p->model, &p->state);
  }
  if (status == STATUS_OK) {
    status = follow(spec, stiffness_factor, p, error);
  }
  if (status == STATUS_OK) {
    status = list_cliques(p);
  }
  if (status == STATUS_OK) {
    p->b = calloc((size_t)p->model->dof_count, sizeof *p->b);
    status = p->b ? STATUS_OK : STATUS_NO_MEMORY;
  }
  if (status != STATUS_OK) {
    linear_problem_release(p);
    return status;
  }
  model_volume(p->model, &p->state, p->b);
  return STATUS_OK;
}

void linear_problem_release(struct linear_problem *p) {
  if (p->model) {
    state_release(&p->state);
  }
  model_destroy(p->model);
  mesh_release(&p->mesh);
  free(p->start);
  free(p->dofs);
  free(p->b);
  *p = (struct linear_problem){0};
}

double linear_problem_residual(const struct linear_problem *p, const double *x) {
  int n = p->model->dof_count;
  double *y = calloc((size_t)n, sizeof *y), difference = 0, norm = 0;
  if (!y) {
    return NAN;
  }
  model_multiply(p->model, x, y);
  for (int i = 0; i < n; i++) {
    difference += (y[i] - p->b[i]) * (y[i] - p->b[i]);
    norm += p->b[i] * p->b[i];
  }
  free(y);
  return sqrt(difference / norm);
}

/* For every unknown the places in p->dofs where it stands, and the clique of every place. */
struct incidence {
  int *start, *place, *clique;
  size_t *first_value; /* per clique: where its packed values begin in the list of all */
};

static void incidence_release(struct incidence *list) {
  free(list->start);
  free(list->place);
  free(list->clique);
  free(list->first_value);
}

static enum status incidence_create(const struct linear_problem *p, struct incidence *list) {
  size_t order = (size_t)p->model->dof_count, entries = (size_t)p->start[p->clique_count];
  list->start = calloc(order + 2, sizeof *list->start);
  list->place = calloc(entries + 1, sizeof *list->place);
  list->clique = calloc(entries + 1, sizeof *list->clique);
  list->first_value = calloc((size_t)p->clique_count + 1, sizeof *list->first_value);
  if (!list->start || !list->place || !list->clique || !list->first_value) {
    incidence_release(list);
    return STATUS_NO_MEMORY;
  }
  for (int c = 0; c < p->clique_count; c++) {
    size_t size = (size_t)(p->start[c + 1] - p->start[c]);
    list->first_value[c + 1] = list->first_value[c] + size * (size + 1) / 2;
    for (int i = p->start[c]; i < p->start[c + 1]; i++) {
      list->clique[i] = c;
      list->start[p->dofs[i] + 2] += p->dofs[i] >= 0;
    }
  }
  for (size_t d = 0; d < order; d++) {
    list->start[d + 2] += list->start[d + 1];
  }
  for (int i = 0; i < (int)entries; i++) {
    if (p->dofs[i] >= 0) {
      list->place[list->start[p->dofs[i] + 1]++] = i;
    }
  }
  return STATUS_OK;
}

static int compare_rows(const void *a, const void *b) {
  return *(const int *)a - *(const int *)b;
}

/* Rows of one column of the lower triangle, sorted; seen[row] = column + 1 marks them. */
static int column_rows(const struct linear_problem *p, const struct incidence *list, int column,
                       int *seen, int *rows) {
  int count = 0;
  for (int q = list->start[column]; q < list->start[column + 1]; q++) {
    int c = list->clique[list->place[q]];
    for (int i = p->start[c]; i < p->start[c + 1]; i++) {
      int row = p->dofs[i];
      if (row >= column && seen[row] != column + 1) {
        seen[row] = column + 1;
        rows[count++] = row;
      }
    }
  }
  qsort(rows, (size_t)count, sizeof *rows, compare_rows);
  return count;
}

/* Sends the values of all cliques that belong to one column to their places. */
static void place_column(const struct linear_problem *p, const struct incidence *list, int column,
                         const int *index, struct linear_matrix *matrix) {
  for (int q = list->start[column]; q < list->start[column + 1]; q++) {
    int c = list->clique[list->place[q]], first = p->start[c];
    size_t size = (size_t)(p->start[c + 1] - first), own = (size_t)(list->place[q] - first);
    for (size_t i = 0; i < size; i++) {
      int row = p->dofs[first + (int)i];
      if (row >= column) {
        size_t r = own < i ? own : i, k = own < i ? i : own;
        matrix->place[list->first_value[c] + r * (2 * size - r + 1) / 2 + k - r] = index[row];
      }
    }
  }
}

enum status linear_matrix_create(const struct linear_problem *p, struct linear_matrix *matrix) {
  struct incidence list = {0};
  int order = p->model->dof_count, *work = NULL;
  size_t room = 0;
  *matrix = (struct linear_matrix){.order = order};
  enum status status = incidence_create(p, &list);
  if (status != STATUS_OK) {
    return status;
  }
  size_t packed = list.first_value[p->clique_count];
  matrix->start = calloc((size_t)order + 1, sizeof *matrix->start);
  matrix->place = malloc((packed + 1) * sizeof *matrix->place);
  work = calloc(3 * (size_t)order + 1, sizeof *work);
  if (!matrix->start || !matrix->place || !work) {
    status = STATUS_NO_MEMORY;
    goto done;
  }
  memset(matrix->place, -1, (packed + 1) * sizeof *matrix->place);
  int *seen = work, *index = work + order, *rows = work + 2 * order;
  for (int j = 0; j < order; j++) {
    int count = column_rows(p, &list, j, seen, rows), first = matrix->start[j];
    if ((size_t)first + (size_t)count > room) {
      room = 2 * room + (size_t)count + 4096;
      int *larger = realloc(matrix->row, room * sizeof *larger);
      if (!larger) {
        status = STATUS_NO_MEMORY;
        goto done;
      }
      matrix->row = larger;
    }
    for (int i = 0; i < count; i++) {
      index[rows[i]] = first + i;
      matrix->row[first + i] = rows[i];
    }
    matrix->start[j + 1] = first + count;
    place_column(p, &list, j, index, matrix);
  }
  matrix->value = calloc((size_t)matrix->start[order] + 1, sizeof *matrix->value);
  status = matrix->value ? STATUS_OK : STATUS_NO_MEMORY;
done:
  free(work);
  incidence_release(&list);
  if (status != STATUS_OK) {
    linear_matrix_release(matrix);
  }
  return status;
}

void linear_matrix_release(struct linear_matrix *matrix) {
  free(matrix->start);
  free(matrix->row);
  free(matrix->value);
  free(matrix->place);
  *matrix = (struct linear_matrix){0};
}

void linear_matrix_fill(const struct linear_problem *p, struct linear_matrix *matrix) {
  const int *place = matrix->place;
  memset(matrix->value, 0, sizeof *matrix->value * (size_t)matrix->start[matrix->order]);
  for (int c = 0; c < p->clique_count; c++) {
    size_t size = (size_t)(p->start[c + 1] - p->start[c]), packed = size * (size + 1) / 2;
    const double *value = p->model->clique_value[c];
    for (size_t i = 0; value && i < packed; i++) {
      if (place[i] >= 0) {
        matrix->value[place[i]] += value[i];
      }
    }
    place += packed;
  }
}
