#include "solver/post/deck.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Local nodes of the 27-node element in the order of the 20-node one: corners of the face
 * z = -1, of z = +1, then edge middles below, above and upright. Index 9 i + 3 j + k. */
static const int serendipity[20] = {0,  18, 24, 6,  2,  20, 26, 8,  9,  21,
                                    15, 3,  11, 23, 17, 5,  1,  19, 25, 7};

/* Face number of the deck for (axis, side). */
static int deck_face(const struct mesh_face *face) {
  static const int number[3][2] = {{6, 4}, {3, 5}, {1, 2}};
  return number[face->axis][face->side > 0];
}

static void write_nodes(FILE *file, const struct mesh *mesh) {
  unsigned char *used = calloc((size_t)mesh->node_count + 1, 1);
  for (int e = 0; used && e < mesh->element_count; e++) {
    for (int n = 0; n < 20; n++) {
      used[mesh->element_nodes[HEX27_NODES * e + serendipity[n]]] = 1;
    }
  }
  fputs("*NODE, NSET=NALL\n", file);
  for (int n = 0; n < mesh->node_count; n++) {
    if (!used || used[n]) {
      const double *x = mesh->x + 3 * (size_t)n;
      fprintf(file, "%d, %.10g, %.10g, %.10g\n", n + 1, 1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
    }
  }
  fprintf(file, "*NSET, NSET=TIP\n%d\n", mesh->centreline[mesh->section_count - 1] + 1);
  fputs("*BOUNDARY\n", file);
  for (int n = 0; n < mesh->node_count; n++) {
    for (int i = 0; i < 3; i++) {
      if (mesh->fixed[3 * n + i] && (!used || used[n])) {
        fprintf(file, "%d, %d, %d\n", n + 1, i + 1, i + 1);
      }
    }
  }
  free(used);
}

static void write_elements(FILE *file, const struct mesh *mesh, const char *type) {
  fprintf(file, "*ELEMENT, TYPE=%s, ELSET=EALL\n", type);
  for (int e = 0; e < mesh->element_count; e++) {
    fprintf(file, "%d", e + 1);
    for (int n = 0; n < 20; n++) {
      fprintf(file, n == 14 ? ",\n%d" : ", %d",
              mesh->element_nodes[HEX27_NODES * e + serendipity[n]] + 1);
    }
    fputs("\n", file);
  }
}

static enum status write_material(FILE *file, const struct material_spec *m, struct error *error) {
  double d1 = 2e6 / (m->bulk_ratio * material_shear_modulus(m)); /* 2/kappa in 1/MPa */
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
    /* The higher volumetric terms are made negligible, not zero: they are inverted. */
    fprintf(file, "*HYPERELASTIC, YEOH\n%.10g, %.10g, %.10g, %.10g, 1e9, 1e9\n", 1e-6 * m->c[0],
            m->terms > 1 ? 1e-6 * m->c[1] : 0, m->terms > 2 ? 1e-6 * m->c[2] : 0, d1);
    break;
  case MATERIAL_OGDEN:
    return error_set(error, STATUS_INVALID, "/material",
                     "a deck can be written for neo-Hooke, Mooney-Rivlin and Yeoh, not for Ogden");
  }
  fputs("*SOLID SECTION, ELSET=EALL, MATERIAL=ELASTOMER\n", file);
  return STATUS_OK;
}

static void write_step(FILE *file, const struct mesh *mesh, const struct load_spec *load) {
  /* CalculiX takes the follower pressure at the geometry where an increment began: only small
   * increments give its value at the end (0.5 % too much bending with increments of 0.2). */
  fputs("*STEP, NLGEOM, INC=1000\n*STATIC\n0.02, 1., 1e-6, 0.02\n*DLOAD\n", file);
  for (int f = 0; f < mesh->face_count; f++) {
    if (mesh->faces[f].kind == FACE_CAVITY) {
      fprintf(file, "%d, P%d, %.10g\n", mesh->faces[f].element + 1, deck_face(&mesh->faces[f]),
              1e-6 * load->pressure_to);
    }
  }
  const double *g = load->gravity;
  double size = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  if (size > 0) {
    fprintf(file, "EALL, GRAV, %.10g, %.10g, %.10g, %.10g\n", 1e3 * size, g[0] / size, g[1] / size,
            g[2] / size);
  }
  fputs("*NODE PRINT, NSET=TIP, FREQUENCY=1000\nU\n*NODE FILE, FREQUENCY=1000\nU\n*END STEP\n",
        file);
}

enum status deck_write(const struct mesh *mesh, const struct job_spec *spec,
                       const char *element_type, const char *path, struct error *error) {
  FILE *file = fopen(path, "w");
  if (!file) {
    return error_set(error, STATUS_IO, NULL, "cannot write %s: %s", path, strerror(errno));
  }
  fprintf(file, "** %s\n** units: N, mm, MPa, t, s; %s\n",
          spec->name[0] ? spec->name : "pneulab job",
          mesh->half ? "half of the body, symmetric about y = 0" : "the whole body");
  write_nodes(file, mesh);
  write_elements(file, mesh, element_type);
  enum status status = write_material(file, &spec->material, error);
  write_step(file, mesh, &spec->load);
  bool failed = ferror(file);
  failed = fclose(file) != 0 || failed;
  if (failed && status == STATUS_OK) {
    status = error_set(error, STATUS_IO, NULL, "writing %s failed: %s", path, strerror(errno));
  }
  return status;
}
