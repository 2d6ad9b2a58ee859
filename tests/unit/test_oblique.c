/* Meshes of two oblique rows: volumes, walls, mirror images, sections. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/fe/model.h"
#include "solver/base/vec3.h"
#include "solver/mesh/actuator.h"
#include "solver/mesh/oblique.h"
#include "tests/physics/oblique_case.h"
#include "tests/unit/suite.h"

static const struct {
  double angle_deg;
  bool half, channel, spine;
} variants[] = {
    {0, false, false, false},  {0, true, true, false},   {15, false, true, false},
    {45, false, false, false}, {45, true, true, true},   {45, false, true, true},
    {75, false, true, false},  {75, true, false, false}, {80, false, false, true},
};
enum { VARIANTS = sizeof variants / sizeof *variants };

static void fill_spec(int variant, struct job_spec *spec) {
  oblique_prototype(spec, variants[variant].angle_deg, 3);
  spec->half_model = variants[variant].half;
  spec->oblique.has_channel = variants[variant].channel;
  spec->oblique.spine = variants[variant].spine;
}

static void build(int variant, struct job_spec *spec, struct mesh *mesh, struct fe_model **model,
                  struct fe_state *state) {
  struct error error = {0};
  fill_spec(variant, spec);
  enum status status = actuator_mesh(spec, mesh, &error);
  if (status == STATUS_OK) {
    status = model_create(mesh, &spec->material, false, model, &error);
  }
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  ck_assert_int_eq(state_create(*model, state), STATUS_OK);
}

static void release(struct mesh *mesh, struct fe_model *model, struct fe_state *state) {
  state_release(state);
  model_destroy(model);
  mesh_release(mesh);
}

/* Shearing keeps volumes: those of the unsheared rows with their walls 1/cos as long. */
START_TEST(volumes_are_those_of_the_geometry) {
  struct job_spec spec;
  struct mesh mesh;
  struct fe_model *model;
  struct fe_state state;
  build(_i, &spec, &mesh, &model, &state);
  const struct oblique_spec *p = &spec.oblique;
  int n = p->chamber_count, rows = spec.half_model ? 1 : 2;
  double along = 1 / cos(p->angle), row = 0.5 * (p->width - p->centre_wall) - p->side_wall;
  double above = p->height - p->bottom_layer;
  double cavity = n * row * p->cavity * along * (above - p->top_wall);
  if (p->has_channel) {
    double stack = (n * (p->cavity + 2 * p->gap_wall) + (n - 1) * p->chamber_gap) * along;
    cavity +=
        p->channel_width * (stack * p->channel_height + n * p->cavity * along * p->channel_cover);
  }
  double across = 0.5 * p->width - (p->spine ? 0.5 * p->centre_wall : 0);
  double gaps = (n - 1) * p->chamber_gap * along * across * above;
  double solid = 0.5 * p->length * p->width * p->height - cavity - gaps;
  ck_assert_double_eq_tol(model->reference_volume / (rows * solid), 1, 1e-12);
  for (int c = 0; c < 2; c++) {
    double wanted = c < rows ? cavity : 0;
    ck_assert_double_eq_tol(model_cavity_volume(model, &state, c), wanted, 1e-12 * cavity);
  }
  release(&mesh, model, &state);
}
END_TEST

/* Faces that look at each other across a gap lie on parallel planes, chamber_gap apart. */
START_TEST(gaps_are_as_wide_as_given) {
  struct job_spec spec;
  struct mesh mesh;
  fill_spec(_i, &spec);
  ck_assert_int_eq(actuator_mesh(&spec, &mesh, NULL), STATUS_OK);
  ck_assert_int_gt(mesh.facing_count, 0);
  ck_assert_double_eq_tol(mesh.gap_width, spec.oblique.chamber_gap, 1e-15);
  for (int k = 0; k < mesh.facing_count; k++) {
    int slave[QUAD9_NODES], master[QUAD9_NODES];
    mesh_face_nodes(&mesh, &mesh.facing[k].slave, slave);
    mesh_face_nodes(&mesh, &mesh.facing[k].master, master);
    const double *a = mesh.x + 3 * slave[0], *b = mesh.x + 3 * slave[2];
    const double *c = mesh.x + 3 * slave[6], *d = mesh.x + 3 * master[4];
    double first[3], second[3], across[3], normal[3];
    for (int i = 0; i < 3; i++) {
      first[i] = b[i] - a[i];
      second[i] = c[i] - a[i];
      across[i] = d[i] - a[i];
    }
    vec3_cross(first, second, normal);
    double distance = fabs(vec3_dot(normal, across)) / vec3_norm(normal);
    ck_assert_double_eq_tol(distance, spec.oblique.chamber_gap, 1e-12);
  }
  mesh_release(&mesh);
}
END_TEST

/* Every node of a whole model has its mirror image, and every cavity face one in the other row. */
START_TEST(rows_mirror_each_other) {
  struct job_spec spec;
  struct mesh mesh;
  int faces[2] = {0};
  fill_spec(_i, &spec);
  spec.half_model = false;
  ck_assert_int_eq(actuator_mesh(&spec, &mesh, NULL), STATUS_OK);
  for (int n = 0; n < mesh.node_count; n += 7) {
    const double *x = mesh.x + 3 * n;
    int twin = grid_find_node(&mesh, (double[3]){x[0], -x[1], x[2]}, mesh.node_section[n]);
    for (int i = 0; i < 3; i++) {
      ck_assert_double_eq_tol(mesh.x[3 * twin + i], i == 1 ? -x[1] : x[i], 1e-12);
    }
  }
  for (int f = 0; f < mesh.face_count; f++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(&mesh, &mesh.faces[f], nodes);
    if (mesh.faces[f].kind == FACE_CAVITY) {
      ck_assert_int_eq(mesh.faces[f].cavity, mesh.x[3 * nodes[4] + 1] < 0);
      faces[mesh.faces[f].cavity]++;
    }
  }
  ck_assert_int_eq(faces[0], faces[1]);
  mesh_release(&mesh);
}
END_TEST

START_TEST(ends_are_plane_and_sections_advance) {
  struct job_spec spec;
  struct mesh mesh;
  fill_spec(_i, &spec);
  const struct oblique_spec *p = &spec.oblique;
  ck_assert_int_eq(actuator_mesh(&spec, &mesh, NULL), STATUS_OK);
  int last = mesh.section_count - 1;
  for (int n = 0; n < mesh.node_count; n++) {
    const double *x = mesh.x + 3 * n, *middle = mesh.x + 3 * mesh.centreline[mesh.node_section[n]];
    int section = mesh.node_section[n];
    double lead = tan(p->angle) * fabs(x[1]);
    ck_assert_double_ge(x[0] - middle[0], -1e-12);
    ck_assert_double_le(x[0] - middle[0], lead + 1e-12);
    ck_assert(section != 0 || x[0] == 0);
    ck_assert_double_eq_tol(section == last ? x[0] : p->length, p->length, 1e-12);
    ck_assert_int_eq(mesh.node_core[n], x[2] < p->bottom_layer + 1e-9);
  }
  for (int s = 1; s <= last; s++) {
    ck_assert_double_gt(mesh.x[3 * mesh.centreline[s]], mesh.x[3 * mesh.centreline[s - 1]]);
    ck_assert_double_eq_tol(mesh.x[3 * mesh.centreline[s] + 1], 0, 1e-15);
    ck_assert_double_eq_tol(mesh.x[3 * mesh.centreline[s] + 2], 0, 1e-15);
  }
  ck_assert_int_eq(mesh.station_count, p->chamber_count + 1);
  ck_assert_int_eq(mesh.station[0], 0);
  ck_assert_int_eq(mesh.station[p->chamber_count], last);
  mesh_release(&mesh);
}
END_TEST

/* The finer mesh splits the cells of the job's own: its lines are among the finer ones. */
START_TEST(finer_mesh_is_nested) {
  struct job_spec spec;
  struct mesh mesh, finer;
  fill_spec(_i, &spec);
  ck_assert_int_eq(actuator_mesh(&spec, &mesh, NULL), STATUS_OK);
  ck_assert_int_eq(actuator_mesh_finer(&spec, &finer, NULL), STATUS_OK);
  ck_assert_int_gt(finer.element_count, mesh.element_count);
  for (int d = 0; d < 3; d++) {
    for (int i = 0, k = 0; i < mesh.line_count[d]; i++) {
      while (k < finer.line_count[d] && finer.line[d][k] < mesh.line[d][i] - 1e-12) {
        k++;
      }
      ck_assert_int_lt(k, finer.line_count[d]);
      ck_assert_double_eq_tol(finer.line[d][k], mesh.line[d][i], 1e-12);
    }
  }
  mesh_release(&mesh);
  mesh_release(&finer);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("oblique");
  TCase *tcase = tcase_create("oblique");
  tcase_set_timeout(tcase, 60);
  tcase_add_loop_test(tcase, volumes_are_those_of_the_geometry, 0, VARIANTS);
  tcase_add_loop_test(tcase, gaps_are_as_wide_as_given, 0, VARIANTS);
  tcase_add_loop_test(tcase, rows_mirror_each_other, 0, VARIANTS);
  tcase_add_loop_test(tcase, ends_are_plane_and_sections_advance, 0, VARIANTS);
  tcase_add_loop_test(tcase, finer_mesh_is_nested, 0, VARIANTS);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
