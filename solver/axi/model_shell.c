/* Unknowns of a shell: those of its rows. */
#include <math.h>
#include "solver/axi/model_internal.h"

/* Turning is an unknown unless it would move the first node of the row where that is held; it is
 * tied like that node. *master receives the row it is tied to, -1 when it is not. */
static enum status number_turn(struct axi_model *m, int row, int *master, struct error *error) {
  const struct axi_mesh *mesh = m->mesh;
  int nodes = m->options.row_nodes, first = row * nodes;
  *master = -1;
  for (int c = 0; c < 2; c++) {
    enum axi_hold hold = (enum axi_hold)mesh->hold[2 * first + c];
    if (hold != AXI_FREE && hold != mesh->hold[2 * (first + nodes / 2) + c]) {
      return error_set(error, STATUS_INVALID, NULL,
                       "row %d of the shell is held beside its middle line", row);
    }
    if (hold != AXI_FREE && fabs(axi_shell_lever(m->shell, first, c)) > 1e-6) {
      *master = hold == AXI_TIED || hold == AXI_AHEAD ? mesh->master[first] / nodes : -1;
      return STATUS_OK;
    }
  }
  m->place[SHELL_ROW * row + 2].base = m->size;
  m->node_of[m->size++] = first + nodes / 2;
  return STATUS_OK;
}

enum status axi_model_number_rows(struct axi_model *m, struct error *error) {
  int nodes = m->options.row_nodes, rows = m->mesh->node_count / nodes, master;
  enum status status = STATUS_OK;
  if (m->options.contact) {
    return error_set(error, STATUS_INVALID, NULL, "a shell does not touch itself");
  }
  for (int row = 0; row < rows && status == STATUS_OK; row++) {
    for (int c = 0; c < 2 && status == STATUS_OK; c++) {
      status = axi_model_number(m, row * nodes + nodes / 2, c, error);
    }
    if (status == STATUS_OK) {
      status = number_turn(m, row, &master, error);
    }
    if (status == STATUS_OK && master > row) {
      status = error_set(error, STATUS_INVALID, NULL, "row %d is tied to one behind it", row);
    }
    if (status == STATUS_OK && master >= 0) {
      m->place[SHELL_ROW * row + 2].base = m->place[SHELL_ROW * master + 2].base;
    }
  }
  return status;
}

void axi_clique_init_rows(const struct axi_model *m, int row, struct axi_clique *c) {
  *c = (struct axi_clique){.locals = SHELL_DOFS};
  for (int i = 0; i < SHELL_DOFS; i++) {
    c->place[i] = m->place[SHELL_ROW * row + i];
  }
  axi_clique_join(m, c);
}

void axi_model_row(const struct axi_model *m, const double *x, int row, double q[SHELL_ROW]) {
  for (int i = 0; i < SHELL_ROW; i++) {
    const struct axi_place *p = &m->place[SHELL_ROW * row + i];
    q[i] = (p->base >= 0 ? x[p->base] : 0) + (p->plus ? x[m->size - 1] : 0);
  }
}

void axi_model_gather_rows(const struct axi_model *m, const double *u, double *x) {
  int rows = m->mesh->node_count / m->options.row_nodes;
  double q[SHELL_ROW];
  for (int pass = 0; pass < 2; pass++) { /* h last: it needs the others */
    for (int row = 0; row < rows; row++) {
      axi_shell_gather(m->shell, row, u, q);
      for (int i = 0; i < SHELL_ROW; i++) {
        const struct axi_place *p = &m->place[SHELL_ROW * row + i];
        if (pass == 0 && p->base >= 0 && !p->plus) {
          x[p->base] = q[i];
        } else if (pass == 1 && p->plus) {
          x[m->size - 1] = q[i] - (p->base >= 0 ? x[p->base] : 0);
        }
      }
    }
  }
}
