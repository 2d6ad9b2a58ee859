#include "solver/post/deck.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { OGDEN_TERMS_MAX = 3, SERENDIPITY_NODES = 20 };

/* Stands for the compressibility of a volumetric term that the law does not have: it is inverted,
 * so it must not be zero. In 1/MPa. */
static const char absent[] = "1e9";

/* Local nodes of the 27-node element in the order of the 20-node one: corners of the face
 * z = -1, of z = +1, then edge middles below, above and upright. Index 9 i + 3 j + k. */
static const int serendipity[SERENDIPITY_NODES] = {0,  18, 24, 6,  2,  20, 26, 8,  9,  21,
                                                   15, 3,  11, 23, 17, 5,  1,  19, 25, 7};

/* Face number of the deck for (axis, side). */
static int deck_face(const struct mesh_face *face) {
  static const int number[3][2] = {{6, 4}, {3, 5}, {1, 2}};
  return number[face->axis][face->side > 0];
}

static const int *deck_nodes(const struct mesh *mesh, int element) {
  return mesh->element_nodes + (size_t)HEX27_NODES * (size_t)element;
}

/* `used` tells which nodes the 20-node elements have. */
static void write_nodes(FILE *file, const struct mesh *mesh, const unsigned char *used) {
  fputs("*NODE, NSET=NALL\n", file);
  for (int n = 0; n < mesh->node_count; n++) {
    if (used[n]) {
      const double *x = mesh->x + 3 * (size_t)n;
      fprintf(file, "%d, %.10g, %.10g, %.10g\n", n + 1, 1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
    }
  }
}

static void write_elements(FILE *file, const struct mesh *mesh, const char *type) {
  fprintf(file, "*ELEMENT, TYPE=%s, ELSET=EALL\n", type);
  for (int e = 0; e < mesh->element_count; e++) {
    fprintf(file, "%d", e + 1);
    for (int n = 0; n < SERENDIPITY_NODES; n++) {
      fprintf(file, n == 14 ? ",\n%d" : ", %d", deck_nodes(mesh, e)[serendipity[n]] + 1);
    }
    fputs("\n", file);
  }
}

/* A node set of the nodes on the faces of one kind. */
static void write_node_set(FILE *file, const struct mesh *mesh, const char *name,
                           enum face_kind kind, const unsigned char *used, unsigned char *chosen) {
  memset(chosen, 0, (size_t)mesh->node_count);
  for (int f = 0; f < mesh->face_count; f++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(mesh, &mesh->faces[f], nodes);
    for (int m = 0; mesh->faces[f].kind == kind && m < QUAD9_NODES; m++) {
      chosen[nodes[m]] = used[nodes[m]];
    }
  }
  fprintf(file, "*NSET, NSET=%s\n", name);
  for (int n = 0; n < mesh->node_count; n++) {
    if (chosen[n]) {
      fprintf(file, "%d,\n", n + 1);
    }
  }
}

/* The faces of one kind, of a FACE_CAVITY those of one cavity only. */
static void write_surface(FILE *file, const struct mesh *mesh, const char *name,
                          enum face_kind kind, int cavity) {
  fprintf(file, "*SURFACE, NAME=%s, TYPE=ELEMENT\n", name);
  for (int f = 0; f < mesh->face_count; f++) {
    if (mesh->faces[f].kind == kind && mesh->faces[f].cavity == cavity) {
      fprintf(file, "%d, S%d\n", mesh->faces[f].element + 1, deck_face(&mesh->faces[f]));
    }
  }
}

/* Highest number of a cavity; -1 for a body without any. */
static int last_cavity(const struct mesh *mesh) {
  int last = -1;
  for (int f = 0; f < mesh->face_count; f++) {
    if (mesh->faces[f].kind == FACE_CAVITY && mesh->faces[f].cavity > last) {
      last = mesh->faces[f].cavity;
    }
  }
  return last;
}

static const char *const cavity_name[MESH_CAVITIES] = {"CAVITY", "CAVITY2"};

static enum status write_mesh(FILE *file, const struct mesh *mesh, const char *type) {
  unsigned char *used = calloc((size_t)mesh->node_count + 1, 1);
  unsigned char *chosen = calloc((size_t)mesh->node_count + 1, 1);
  enum status status = used && chosen ? STATUS_OK : STATUS_NO_MEMORY;
  if (status == STATUS_OK) {
    for (int n = 0; n < SERENDIPITY_NODES * mesh->element_count; n++) {
      used[deck_nodes(mesh, n / SERENDIPITY_NODES)[serendipity[n % SERENDIPITY_NODES]]] = 1;
    }
    write_nodes(file, mesh, used);
    write_elements(file, mesh, type);
    fprintf(file, "*NSET, NSET=TIP\n%d\n", mesh->centreline[mesh->section_count - 1] + 1);
    write_node_set(file, mesh, "FIXED", FACE_BASE, used, chosen);
    if (mesh->half) {
      write_node_set(file, mesh, "SYMMETRY", FACE_SYMMETRY, used, chosen);
    }
    for (int c = 0; c <= last_cavity(mesh); c++) {
      write_surface(file, mesh, cavity_name[c], FACE_CAVITY, c);
    }
    write_surface(file, mesh, "OUTER", FACE_OUTER, 0);
    fputs("*BOUNDARY\nFIXED, 1, 3\n", file);
    fputs(mesh->half ? "SYMMETRY, 2, 2\n" : "", file);
  }
  free(used);
  free(chosen);
  return status;
}

bool deck_knows(const struct material_spec *material) {
  return material->model != MATERIAL_OGDEN || material->terms <= OGDEN_TERMS_MAX;
}

/* sum 2 mu_i/alpha_i^2 (...) of the deck for our sum c_i/alpha_i (...), at most eight numbers a
 * line: mu_i, alpha_i, then the compressibilities. */
static void write_ogden(FILE *file, const struct material_spec *m, double d1) {
  fprintf(file, "*HYPERELASTIC, OGDEN, N=%d\n", m->terms);
  int column = 0;
  for (int i = 0; i < 2 * m->terms; i++, column++) {
    double alpha = m->alpha[i / 2];
    fprintf(file, "%s%.10g", column > 0 ? ", " : "",
            i % 2 == 0 ? 0.5e-6 * m->c[i / 2] * alpha : alpha);
  }
  for (int i = 0; i < m->terms; i++, column++) {
    const char *between = column == 8 ? ",\n" : ", ";
    if (i == 0) {
      fprintf(file, "%s%.10g", between, d1);
    } else {
      fprintf(file, "%s%s", between, absent);
    }
  }
  fputs("\n", file);
}

static enum status write_material(FILE *file, const struct material_spec *m, struct error *error) {
  double d1 = 2e6 / (m->bulk_ratio * material_shear_modulus(m)); /* 2/kappa in 1/MPa */
  if (!deck_knows(m)) {
    return error_set(error, STATUS_INVALID, "/material",
                     "a deck can be written for Ogden's law with up to %d terms, not with %d",
                     OGDEN_TERMS_MAX, m->terms);
  }
  fputs("*MATERIAL, NAME=ELASTOMER\n", file);
  fprintf(file, "*DENSITY\n%.6g\n", 1e-12 * m->density_kg_m3);
  switch (m->model) {
  case MATERIAL_NEO_HOOKE:
    fprintf(file, "*HYPERELASTIC, NEO HOOKE\n%.10g, %.10g\n", 0.5e-6 * m->c[0], d1);
    break;
  case MATERIAL_MOONEY_RIVLIN:
    fprintf(file, "*HYPERELASTIC, MOONEY-RIVLIN\n%.10g, %.10g, %.10g\n", 1e-6 * m->c[0],
            1e-6 * m->c[1], d1);
    break;
  case MATERIAL_YEOH:
    fprintf(file, "*HYPERELASTIC, YEOH\n%.10g, %.10g, %.10g, %.10g, %s, %s\n", 1e-6 * m->c[0],
            m->terms > 1 ? 1e-6 * m->c[1] : 0, m->terms > 2 ? 1e-6 * m->c[2] : 0, d1, absent,
            absent);
    break;
  case MATERIAL_OGDEN:
    write_ogden(file, m, d1);
    break;
  }
  fputs("*SOLID SECTION, ELSET=EALL, MATERIAL=ELASTOMER\n", file);
  return STATUS_OK;
}

static void write_step(FILE *file, const struct mesh *mesh, const struct load_spec *load) {
  /* CalculiX takes the follower pressure at the geometry where an increment began: only small
   * increments give its value at the end (0.5 % too much bending with increments of 0.2). */
  fputs("*STEP, NLGEOM, INC=1000\n*STATIC\n0.02, 1., 1e-6, 0.02\n", file);
  for (int c = 0; c <= last_cavity(mesh); c++) {
    fprintf(file, "*DSLOAD\n%s, P, %.10g\n", cavity_name[c],
            1e-6 * load->cavity_share[c] * load->pressure_to);
  }
  const double *g = load->gravity;
  double size = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  if (size > 0) {
    fprintf(file, "*DLOAD\nEALL, GRAV, %.10g, %.10g, %.10g, %.10g\n", 1e3 * size, g[0] / size,
            g[1] / size, g[2] / size);
  }
  fputs("*NODE PRINT, NSET=TIP, FREQUENCY=1000\nU\n*NODE FILE, FREQUENCY=1000\nU\n"
        "*EL FILE, FREQUENCY=1000\nS, E\n*END STEP\n",
        file);
}

/* The name of the job on a line of its own: a line break in it would begin a new card. */
static void write_head(FILE *file, const char *name, bool half) {
  fputs("** ", file);
  for (; *name; name++) {
    fputc((unsigned char)*name < ' ' ? ' ' : *name, file);
  }
  fprintf(file, "\n** units: N, mm, MPa, t, s; %s\n** contact is left out\n",
          half ? "half of the body, symmetric about y = 0" : "the whole body");
}

enum status deck_print(const struct mesh *mesh, const struct job_spec *spec,
                       const char *element_type, FILE *file, struct error *error) {
  write_head(file, spec->name, mesh->half);
  if (write_mesh(file, mesh, element_type) != STATUS_OK) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the sets of a deck");
  }
  enum status status = write_material(file, &spec->material, error);
  if (status == STATUS_OK) {
    write_step(file, mesh, &spec->load);
  }
  return status;
}

enum status deck_write(const struct mesh *mesh, const struct job_spec *spec,
                       const char *element_type, const char *path, struct error *error) {
  FILE *file = fopen(path, "w");
  if (!file) {
    return error_set(error, STATUS_IO, NULL, "cannot write %s: %s", path, strerror(errno));
  }
  enum status status = deck_print(mesh, spec, element_type, file, error);
  bool failed = ferror(file);
  failed = fclose(file) != 0 || failed;
  if (failed && status == STATUS_OK) {
    status = error_set(error, STATUS_IO, NULL, "writing %s failed: %s", path, strerror(errno));
  }
  return status;
}
