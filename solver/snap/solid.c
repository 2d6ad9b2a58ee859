/* A bellows of nine-node elements through silicone and PET, or of a shell on the same rows. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/axi/harmonic.h"
#include "solver/fe/hyperelastic.h"
#include "solver/snap/body.h"
#include "solver/snap/folded.h"

struct solid {
  const struct snap_spec *spec;
  struct bellows bellows;
  struct axi_model *model;
  struct harmonic *harmonic; /* made when first asked for */
};

static struct continuation_options solid_options(const void *self) {
  const struct solid *solid = self;
  return axi_defaults(solid->model);
}

static enum status solid_follow(void *self, const struct axi_ramp *ramp,
                                const struct continuation_options *options, int direction,
                                const double *along, axi_visit *visit, void *visit_context,
                                struct axi_state *state, struct error *error) {
  struct solid *solid = self;
  return axi_follow(solid->model, ramp, options, direction, along, visit, visit_context, state,
                    error);
}

static enum status solid_equilibrium(void *self, const struct axi_load *load, bool held,
                                     const struct continuation_options *options,
                                     struct axi_state *state, struct error *error) {
  struct solid *solid = self;
  return axi_equilibrium(solid->model, load, held, options, state, NULL, error);
}

/* From one pair of an endless row, on the same mesh for a longer body, else on a coarser one. */
static enum status fold_like_pair(struct solid *solid, const struct folded_limits *limits,
                                  struct axi_state *state, struct error *error) {
  struct snap_spec one = *solid->spec;
  struct snap_body body = {0};
  struct axi_state folded = {0};
  bool alone = one.pair_count == 1 && one.ends == SNAP_PERIODIC;
  one.pair_count = 1;
  one.ends = SNAP_PERIODIC;
  one.accuracy = alone ? one.accuracy - 1 : one.accuracy;
  one.given.angle_factor[0] = one.given.slant_factor[0] = one.given.pet_factor[0] = 1.0;
  enum status status = snap_derive(&one, error);
  if (status == STATUS_OK) {
    status = solid_body_create(&one, &body, error);
  }
  if (status == STATUS_OK) {
    status = snap_body_state(&body, &folded, error);
  }
  if (status == STATUS_OK) {
    status = body.fold(body.self, limits, &folded, error);
  }
  if (status == STATUS_OK) {
    const struct solid *pair = body.self;
    status = folded_from_pair(solid->spec, &solid->bellows, solid->model, &pair->bellows, &folded,
                              limits, state, error);
  }
  axi_state_destroy(&folded);
  snap_body_release(&body);
  return status;
}

static enum status solid_fold(void *self, const struct folded_limits *limits,
                              struct axi_state *state, struct error *error) {
  struct solid *solid = self;
  const struct snap_spec *spec = solid->spec;
  bool alone = spec->pair_count == 1 && spec->ends == SNAP_PERIODIC;
  if (!alone && spec->model == SNAP_SOLID) {
    return fold_like_pair(solid, limits, state, error);
  }
  enum status status = folded_state(spec, &solid->bellows, solid->model, limits, state, error);
  bool final = status == STATUS_OK || status_is_final(status);
  return final || spec->model == SNAP_SHELL || spec->accuracy == ACCURACY_FAST
             ? status
             : fold_like_pair(solid, limits, state, error);
}

static int solid_inverted(const void *self, const double *u) {
  const struct solid *solid = self;
  return bellows_inverted(&solid->bellows, solid->spec->pair_count, u);
}

/* ---- strain ------------------------------------------------------------------------------- */

/* Largest logarithm of a principal stretch, by its size, at a Gauss point. */
static double point_strain(const struct axi_point *point, const double u[AXI_DOFS]) {
  double f[9], c[9] = {0}, value[3], vector[9], strain = 0.0;
  axi_deformation(point, u, f);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      for (int k = 0; k < 3; k++) {
        c[3 * i + j] += f[3 * k + i] * f[3 * k + j];
      }
    }
  }
  symmetric3_eigen(c, value, vector);
  for (int i = 0; i < 3; i++) {
    strain = fmax(strain, fabs(0.5 * log(value[i])));
  }
  return strain;
}

static double solid_pet_strain(const void *self, const double *u) {
  const struct solid *solid = self;
  const struct axi_mesh *mesh = &solid->bellows.mesh;
  double strain = 0.0;
  for (int e = 0; e < mesh->element_count; e++) {
    if (mesh->element[e].region == BELLOWS_PET) {
      const struct axi_geometry *geometry = axi_model_geometry(solid->model, e);
      double local[AXI_DOFS];
      axi_element_displacements(mesh, e, u, local);
      for (int q = 0; q < AXI_POINTS; q++) {
        strain = fmax(strain, point_strain(&geometry->point[q], local));
      }
    }
  }
  return strain;
}

/* ---- harmonics ---------------------------------------------------------------------------- */

/* A row of pairs is free to shift sideways, a deformation of one wave without stiffness. Springs as
 * weak as this, along one circle, decide the sign of its pivot. */
static const double weak = 1e-4;

static struct harmonic_touch soft_ring(const struct solid *solid) {
  const struct snap_spec *spec = solid->spec;
  return (struct harmonic_touch){
      .count = 1,
      .node = {bellows_node(&solid->bellows, 0, solid->bellows.core_from)},
      .weight = {{1.0, 0.0}},
      .stiffness = weak * material_shear_modulus(&spec->silicone) * spec->crest_radius};
}

static enum status solid_harmonics(void *self, const struct axi_state *state, int first, int last,
                                   int *count, struct error *error) {
  struct solid *solid = self;
  enum status status = STATUS_OK;
  if (!solid->harmonic) {
    status = harmonic_create(&solid->bellows.mesh, HARMONIC_GUIDED, &solid->harmonic, error);
  }
  struct harmonic_touch ring = soft_ring(solid);
  struct harmonic_state base = {.u = state->u,
                                .pressure = state->pressure,
                                .elongation = state->elongation,
                                .contact = axi_model_contact(solid->model),
                                .skin = axi_model_skin(solid->model),
                                .touch = &ring,
                                .touch_count = solid->spec->ends == SNAP_PERIODIC};
  return status == STATUS_OK ? harmonic_negative(solid->harmonic, &base, first, last, count, error)
                             : status;
}

/* ---- outlines ----------------------------------------------------------------------------- */

static void add_point(const struct bellows *b, const double *u, int row, int column,
                      json_t *outline) {
  int node = bellows_node(b, row, column);
  const double *x = b->mesh.position + 2 * (size_t)node;
  json_array_append_new(
      outline, json_pack("[f, f]", 1e3 * (x[0] + u[2 * node]), 1e3 * (x[1] + u[2 * node + 1])));
}

/* Around the block of nodes between two rows and two columns. */
static json_t *block_outline(const struct bellows *b, const double *u, int low, int high, int left,
                             int right) {
  json_t *outline = json_array();
  for (int j = left; j < right; j++) {
    add_point(b, u, low, j, outline);
  }
  for (int i = low; i < high; i++) {
    add_point(b, u, i, right, outline);
  }
  for (int j = right; j > left; j--) {
    add_point(b, u, high, j, outline);
  }
  for (int i = high; i > low; i--) {
    add_point(b, u, i, left, outline);
  }
  return outline;
}

static json_t *solid_outlines(const void *self, const double *u) {
  const struct solid *solid = self;
  const struct bellows *b = &solid->bellows;
  json_t *regions = json_array();
  json_array_append_new(
      regions, json_pack("{s:s, s:o}", "region", "silicone", "outline_mm",
                         block_outline(b, u, 0, b->row_count - 1, 0, b->column_count - 1)));
  for (int s = 0; s < b->sheet_count; s++) {
    const struct bellows_sheet *sheet = &b->sheet[s];
    json_array_append_new(
        regions, json_pack("{s:s, s:o}", "region", "pet", "outline_mm",
                           block_outline(b, u, sheet->from, sheet->to, b->core_from, b->core_to)));
  }
  return regions;
}

/* Thickness of the skin that keeps creases of the silicone wider than the elements, relative to the
 * wall. A numerical parameter: the two add 0.7 % to the bending stiffness of a wall of silicone;
 * docs/JOBS.md has what they change. */
static const double skin = 0.15;

/* Elements of a shell relative to those of a solid. */
static const double longer = 1.5;

/* ---- the body ----------------------------------------------------------------------------- */

static void solid_destroy(void *self) {
  struct solid *solid = self;
  harmonic_destroy(solid->harmonic);
  axi_model_destroy(solid->model);
  bellows_release(&solid->bellows);
  free(solid);
}

enum status solid_body_create(const struct snap_spec *spec, struct snap_body *body,
                              struct error *error) {
  struct solid *solid = calloc(1, sizeof *solid);
  *body = (struct snap_body){.self = solid,
                             .options = solid_options,
                             .follow = solid_follow,
                             .equilibrium = solid_equilibrium,
                             .fold = solid_fold,
                             .inverted = solid_inverted,
                             .pet_strain = solid_pet_strain,
                             .harmonics = solid_harmonics,
                             .outlines = solid_outlines,
                             .destroy = solid_destroy};
  if (!solid) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the bellows");
  }
  solid->spec = spec;
  bool shell = spec->model == SNAP_SHELL;
  struct bellows_fineness fineness = bellows_fineness(spec->accuracy);
  if (shell) {
    fineness = (struct bellows_fineness){1, 1, longer * fineness.length};
    body->harmonics = NULL; /* rows move in the meridian plane alone */
  }
  fineness.length *= spec->element_length;
  enum status status = bellows_create(spec, &fineness, &solid->bellows, error);
  struct axi_model_options options = {.contact = spec->contact && !shell,
                                      .skin = shell ? 0.0 : skin * spec->wall,
                                      .row_nodes = shell ? solid->bellows.column_count : 0};
  if (status == STATUS_OK) {
    status = axi_model_create(&solid->bellows.mesh, &options, &solid->model, error);
  }
  if (status == STATUS_OK) {
    body->size = axi_model_size(solid->model);
    body->values = 2 * solid->bellows.mesh.node_count;
    body->length = solid->bellows.line.length;
    body->skin = options.skin;
  }
  return status;
}
