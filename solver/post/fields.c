#include "solver/post/fields.h"

#include <stdlib.h>
#include "solver/post/shape.h"

enum status fields_create(const struct mesh *mesh, struct fields *fields) {
  size_t nodes = (size_t)mesh->node_count + 1;
  *fields = (struct fields){.stretch = calloc(nodes, sizeof *fields->stretch),
                            .stress = calloc(nodes, sizeof *fields->stress),
                            .contact = calloc(nodes, sizeof *fields->contact)};
  if (!fields->stretch || !fields->stress || !fields->contact) {
    fields_release(fields);
    return STATUS_NO_MEMORY;
  }
  return STATUS_OK;
}

void fields_release(struct fields *fields) {
  free(fields->stretch);
  free(fields->stress);
  free(fields->contact);
  *fields = (struct fields){0};
}

enum status fields_evaluate(const struct fe_model *model, const struct fe_state *state,
                            struct fields *fields) {
  fields->u = state->u;
  if (shape_stretch(model, state->u, fields->stretch) < 0) {
    return STATUS_NO_MEMORY;
  }
  return stress_at_nodes(model, state, fields->stress);
}

/* Columns of the table that a file is written from. */
enum {
  COLUMN_POINT = 0,
  COLUMN_DISPLACEMENT = 3,
  COLUMN_STRETCH = 6,
  COLUMN_STRESS = 7,
  COLUMN_VON_MISES = 13,
  COLUMN_LARGEST = 14,
  COLUMN_PRESSURE = 15,
  COLUMN_CONTACT = 16,
  COLUMNS = 17
};

/* Mirroring about y = 0 turns the sign of y, and of stresses with one index y. */
static const int odd[COLUMNS] = {[COLUMN_POINT + 1] = 1,
                                 [COLUMN_DISPLACEMENT + 1] = 1,
                                 [COLUMN_STRESS + 3] = 1,
                                 [COLUMN_STRESS + 4] = 1};

static void fill_row(const struct mesh *mesh, const struct fields *fields, int node,
                     double row[COLUMNS]) {
  for (int i = 0; i < 3; i++) {
    double u = fields->u[3 * node + i];
    row[COLUMN_POINT + i] = 1e3 * (mesh->x[3 * node + i] + u);
    row[COLUMN_DISPLACEMENT + i] = 1e3 * u;
  }
  const double *stress = fields->stress[node];
  for (int c = 0; c < STRESS_COMPONENTS; c++) {
    row[COLUMN_STRESS + c] = 1e-3 * stress[c];
  }
  row[COLUMN_STRETCH] = fields->stretch[node];
  row[COLUMN_VON_MISES] = 1e-3 * stress_von_mises(stress);
  row[COLUMN_LARGEST] = 1e-3 * stress_largest(stress);
  row[COLUMN_PRESSURE] = 1e-3 * stress_pressure(stress);
  row[COLUMN_CONTACT] = 1e-3 * fields->contact[node];
}

/* Fills the arrays one after another: that of `first` columns starts at points * first. */
static void fill_table(const struct mesh *mesh, const struct fields_view *view,
                       const struct fields *fields, const struct vtu_array *arrays, int count,
                       float *table) {
  for (int p = 0; p < view->point_count; p++) {
    double row[COLUMNS];
    fill_row(mesh, fields, view->node ? view->node[p] : p, row);
    bool mirrored = view->mirrored && view->mirrored[p];
    size_t start = 0;
    for (int a = 0, column = 0; a < count; a++) {
      size_t components = (size_t)arrays[a].components;
      for (size_t c = 0; c < components; c++, column++) {
        double value = mirrored && odd[column] ? -row[column] : row[column];
        table[start + components * (size_t)p + c] = (float)value;
      }
      start += components * (size_t)view->point_count;
    }
  }
}

enum status fields_write(FILE *file, const struct mesh *mesh, const struct fields_view *view,
                         const struct fields *fields) {
  struct vtu_array arrays[] = {{"points", 3, NULL},
                               {"displacement_mm", 3, NULL},
                               {"stretch", 1, NULL},
                               {"cauchy_stress_kPa", STRESS_COMPONENTS, NULL},
                               {"von_mises_kPa", 1, NULL},
                               {"largest_principal_stress_kPa", 1, NULL},
                               {"hydrostatic_pressure_kPa", 1, NULL},
                               {"contact_pressure_kPa", 1, NULL}};
  const int count = sizeof arrays / sizeof *arrays;
  size_t points = (size_t)view->point_count;
  float *table = malloc(sizeof *table * (COLUMNS * points + 1));
  if (!table) {
    return STATUS_NO_MEMORY;
  }
  fill_table(mesh, view, fields, arrays, count, table);
  size_t start = 0;
  for (int a = 0; a < count; a++) {
    arrays[a].value = table + start;
    start += points * (size_t)arrays[a].components;
  }
  struct vtu_grid grid = {
      view->point_count, view->cell_count,
      arrays[0].value,   view->cell_type == VTU_QUAD9 ? QUAD9_NODES : HEX27_NODES,
      view->cell_type,   view->connectivity};
  enum status status = vtu_write(file, &grid, arrays + 1, count - 1);
  free(table);
  return status;
}
