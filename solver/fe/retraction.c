#include "solver/fe/retraction.h"

#include <stdlib.h>
#include <string.h>
#include "solver/fe/hyperelastic.h"
#include "solver/base/vec3.h"

/* Rigid motion of one section under an increment. */
struct section {
  double centre[3];   /* of the core nodes, before the step */
  double velocity[3]; /* mean increment of the core nodes */
  double spin[3];     /* rotation vector */
  double moved[3];    /* centre after the step */
};

struct retraction {
  const struct mesh *mesh;
  struct section *section;
  double *weight;      /* per node: 0 outside the core */
  double *core_weight; /* sum over the core nodes of a section */
  double *inertia;     /* 9 per section */
  double *moment;      /* 3 per section */
};

/* Nodes of the plane of symmetry stand for themselves, the others for their mirror images too. */
static double core_weight(const struct mesh *mesh, int n) {
  bool on_plane = mesh->half && mesh->x[3 * n + 1] == 0;
  return !mesh->node_core[n] ? 0 : on_plane ? 0.5 : 1;
}

struct retraction *retraction_create(const struct mesh *mesh) {
  struct retraction *r = calloc(1, sizeof *r);
  if (!r) {
    return NULL;
  }
  size_t sections = (size_t)mesh->section_count + 1;
  r->mesh = mesh;
  r->section = calloc(sections, sizeof *r->section);
  r->weight = calloc((size_t)mesh->node_count + 1, sizeof *r->weight);
  r->core_weight = calloc(sections, sizeof *r->core_weight);
  r->inertia = calloc(9 * sections, sizeof *r->inertia);
  r->moment = calloc(3 * sections, sizeof *r->moment);
  if (!r->section || !r->weight || !r->core_weight || !r->inertia || !r->moment) {
    retraction_destroy(r);
    return NULL;
  }
  for (int n = 0; mesh->section_count > 0 && n < mesh->node_count; n++) {
    r->weight[n] = core_weight(mesh, n);
    r->core_weight[mesh->node_section[n]] += r->weight[n];
  }
  return r;
}

void retraction_destroy(struct retraction *r) {
  if (!r) {
    return;
  }
  free(r->section);
  free(r->weight);
  free(r->core_weight);
  free(r->inertia);
  free(r->moment);
  free(r);
}

static void current_position(const struct mesh *mesh, const double *u, int n, double x[3]) {
  for (int i = 0; i < 3; i++) {
    x[i] = mesh->x[3 * n + i] + u[3 * n + i];
  }
}

/* Centres and mean increments of the core nodes. In a half model the missing half is the mirror
 * image, so nothing points across. */
static void find_centres(struct retraction *r, const double *u, const double *increment) {
  const struct mesh *mesh = r->mesh;
  memset(r->section, 0, sizeof *r->section * (size_t)mesh->section_count);
  for (int n = 0; n < mesh->node_count; n++) {
    if (!mesh->node_core[n]) {
      continue;
    }
    struct section *s = &r->section[mesh->node_section[n]];
    double x[3], share = r->weight[n] / r->core_weight[mesh->node_section[n]];
    current_position(mesh, u, n, x);
    for (int i = 0; i < 3; i++) {
      if (i != 1 || !mesh->half) {
        s->centre[i] += share * x[i];
        s->velocity[i] += share * increment[3 * n + i];
      }
    }
  }
}

/* Solves the symmetric 3 x 3 system a w = b by Cramer's rule. */
static void solve3(const double a[9], const double b[3], double w[3]) {
  double c0[3], c1[3], c2[3];
  vec3_cross(a + 3, a + 6, c0);
  vec3_cross(a + 6, a, c1);
  vec3_cross(a, a + 3, c2);
  double determinant = vec3_dot(a, c0);
  for (int i = 0; i < 3; i++) {
    w[i] = determinant != 0 ? (b[0] * c0[i] + b[1] * c1[i] + b[2] * c2[i]) / determinant : 0;
  }
}

/* Least-squares spin of every section: sum (|r|^2 I - r r^T) w = sum r x d. */
static void find_spins(struct retraction *r, const double *u, const double *increment) {
  const struct mesh *mesh = r->mesh;
  memset(r->inertia, 0, sizeof *r->inertia * 9 * (size_t)mesh->section_count);
  memset(r->moment, 0, sizeof *r->moment * 3 * (size_t)mesh->section_count);
  for (int n = 0; n < mesh->node_count; n++) {
    if (!mesh->node_core[n]) {
      continue;
    }
    int k = mesh->node_section[n];
    const struct section *s = &r->section[k];
    double x[3], arm[3], d[3], turn[3];
    current_position(mesh, u, n, x);
    for (int i = 0; i < 3; i++) {
      arm[i] = x[i] - s->centre[i];
      d[i] = increment[3 * n + i] - s->velocity[i];
    }
    if (mesh->half) { /* only the plane x-z counts */
      arm[1] = d[1] = 0;
    }
    vec3_cross(arm, d, turn);
    double square = vec3_dot(arm, arm), weight = r->weight[n];
    for (int i = 0; i < 3; i++) {
      r->moment[3 * k + i] += weight * turn[i];
      for (int j = 0; j < 3; j++) {
        r->inertia[9 * k + 3 * i + j] += weight * ((i == j ? square : 0) - arm[i] * arm[j]);
      }
    }
  }
  for (int k = 0; k < mesh->section_count; k++) {
    double *spin = r->section[k].spin;
    if (mesh->half) {
      spin[0] = spin[2] = 0;
      double inertia = r->inertia[9 * k + 4];
      spin[1] = inertia > 0 ? r->moment[3 * k + 1] / inertia : 0;
    } else {
      solve3(r->inertia + 9 * k, r->moment + 3 * k, spin);
    }
  }
}

/* Chains the section centres with finite rotations from the base outwards. */
static void move_centres(struct retraction *r) {
  struct section *s = r->section;
  for (int i = 0; i < 3; i++) {
    s[0].moved[i] = s[0].centre[i] + s[0].velocity[i];
  }
  for (int k = 0; k + 1 < r->mesh->section_count; k++) {
    double spin[3], chord[3], stretch[3], turned[3], rotation[9];
    for (int i = 0; i < 3; i++) {
      spin[i] = 0.5 * (s[k].spin[i] + s[k + 1].spin[i]);
      chord[i] = s[k + 1].centre[i] - s[k].centre[i];
    }
    vec3_cross(spin, chord, turned);
    for (int i = 0; i < 3; i++) {
      stretch[i] = chord[i] + s[k + 1].velocity[i] - s[k].velocity[i] - turned[i];
    }
    rotation_matrix(spin, rotation);
    mat3_apply(rotation, stretch, turned);
    for (int i = 0; i < 3; i++) {
      s[k + 1].moved[i] = s[k].moved[i] + turned[i];
    }
  }
}

void retraction_apply(struct retraction *r, double *u, const double *increment) {
  const struct mesh *mesh = r->mesh;
  if (mesh->section_count == 0) {
    for (int i = 0; i < 3 * mesh->node_count; i++) {
      u[i] += increment[i];
    }
    return;
  }
  find_centres(r, u, increment);
  find_spins(r, u, increment);
  move_centres(r);
  int last = -1;
  double rotation[9] = {0};
  for (int n = 0; n < mesh->node_count; n++) {
    const struct section *s = &r->section[mesh->node_section[n]];
    if (mesh->node_section[n] != last) {
      last = mesh->node_section[n];
      rotation_matrix(s->spin, rotation);
    }
    double x[3], arm[3], turn[3], local[3];
    current_position(mesh, u, n, x);
    for (int i = 0; i < 3; i++) {
      arm[i] = x[i] - s->centre[i];
    }
    vec3_cross(s->spin, arm, turn);
    for (int i = 0; i < 3; i++) {
      local[i] = arm[i] + increment[3 * n + i] - s->velocity[i] - turn[i];
    }
    mat3_apply(rotation, local, turn);
    for (int i = 0; i < 3; i++) {
      u[3 * n + i] = s->moved[i] + turn[i] - mesh->x[3 * n + i];
    }
  }
}

/* Rotation of the polar decomposition of m (row-major), by eigenvectors of m^T m. */
static void polar_rotation(const double m[9], double r[9]) {
  double c[9], l2[3], v[9], inverse_root[9] = {0};
  for (int i = 0; i < 9; i++) {
    c[i] = 0;
    for (int k = 0; k < 3; k++) {
      c[i] += m[3 * k + i / 3] * m[3 * k + i % 3];
    }
  }
  symmetric3_eigen(c, l2, v);
  for (int i = 0; i < 9; i++) {
    for (int a = 0; a < 3; a++) {
      inverse_root[i] += v[i / 3 * 3 + a] * v[i % 3 * 3 + a] / sqrt(fmax(l2[a], 1e-300));
    }
  }
  for (int i = 0; i < 9; i++) {
    r[i] = 0;
    for (int k = 0; k < 3; k++) {
      r[i] += m[i / 3 * 3 + k] * inverse_root[3 * k + i % 3];
    }
  }
}

/* A section is flat: its moment matrix has rank two. The third axis is completed by the cross
 * products of the two others, in both configurations. */
void retraction_frame(const struct retraction *r, const double *u, int section, double rotation[9],
                      double c[3]) {
  const struct mesh *mesh = r->mesh;
  double centre[3] = {0}, reference[3] = {0};
  double whole = r->core_weight[section];
  for (int n = 0; n < mesh->node_count; n++) {
    for (int i = 0; mesh->node_core[n] && mesh->node_section[n] == section && i < 3; i++) {
      reference[i] += r->weight[n] * mesh->x[3 * n + i] / whole;
      centre[i] += r->weight[n] * (mesh->x[3 * n + i] + u[3 * n + i]) / whole;
    }
  }
  double across[2][3] = {{0}}, moved[2][3] = {{0}}; /* first moments along y and z */
  for (int n = 0; n < mesh->node_count; n++) {
    if (!mesh->node_core[n] || mesh->node_section[n] != section) {
      continue;
    }
    for (int k = 0; k < 2; k++) {
      double weight = r->weight[n] * (mesh->x[3 * n + 1 + k] - reference[1 + k]);
      for (int i = 0; i < 3; i++) {
        across[k][i] += weight * (mesh->x[3 * n + i] - reference[i]);
        moved[k][i] += weight * (mesh->x[3 * n + i] + u[3 * n + i] - centre[i]);
      }
    }
  }
  if (mesh->half) { /* the mirrored half leaves only y along y, and x, z along z */
    memcpy(across[0], (double[3]){0, 1, 0}, sizeof across[0]);
    memcpy(moved[0], (double[3]){0, 1, 0}, sizeof moved[0]);
    across[1][1] = moved[1][1] = 0;
  }
  double normal[3], moved_normal[3], m[9];
  double *from[3] = {across[0], across[1], normal}, *to[3] = {moved[0], moved[1], moved_normal};
  vec3_cross(across[0], across[1], normal);
  vec3_cross(moved[0], moved[1], moved_normal);
  for (int i = 0; i < 9; i++) { /* sum of unit moved (x) unit reference axes */
    m[i] = 0;
    for (int k = 0; k < 3; k++) {
      m[i] += to[k][i / 3] * from[k][i % 3] / (vec3_norm(to[k]) * vec3_norm(from[k]));
    }
  }
  polar_rotation(m, rotation);
  memcpy(c, centre, sizeof centre);
  if (mesh->half) {
    c[1] = 0;
  }
}
