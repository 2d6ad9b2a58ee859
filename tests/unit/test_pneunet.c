/* Meshes of pneu-nets: watertight, of the right volume and topology, with their sections. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/mesh/pneunet.h"
#include "tests/physics/pneunet_case.h"
#include "tests/unit/mesh_volume.h"
#include "tests/unit/suite.h"

/* ---- variants ---- */

struct body {
  struct chamber_run runs[3];
  int run_count;
  bool has_channel, half, tapered, scaled;
};

static const struct body variants[] = {
    {{{CHAMBER_A, 3}}, 1, false, false, false, false},
    {{{CHAMBER_B, 3}}, 1, false, false, false, false},
    {{{CHAMBER_C, 3}}, 1, false, false, false, false},
    {{{CHAMBER_A, 3}}, 1, true, false, false, false},
    {{{CHAMBER_B, 3}}, 1, true, false, true, true},
    {{{CHAMBER_C, 3}}, 1, true, false, true, false},
    {{{CHAMBER_A, 2}, {CHAMBER_B, 2}, {CHAMBER_C, 2}}, 3, true, false, false, false},
    {{{CHAMBER_B, 2}, {CHAMBER_C, 1}, {CHAMBER_A, 2}}, 3, false, false, true, false},
    {{{CHAMBER_B, 3}}, 1, false, true, true, false},
    {{{CHAMBER_C, 3}}, 1, true, true, true, true},
    {{{CHAMBER_C, 3}}, 1, true, true, false, false},
};
enum { VARIANTS = sizeof variants / sizeof *variants };

static int joints(const struct pneunet_spec *p) {
  int count = 0;
  for (int r = 0; r < p->run_count; r++) {
    count += p->runs[r].config == CHAMBER_A ? p->runs[r].count - 1 : 0;
  }
  return count;
}

static int count_of(const struct pneunet_spec *p, enum chamber_config config) {
  int count = 0;
  for (int r = 0; r < p->run_count; r++) {
    count += p->runs[r].config == config ? p->runs[r].count : 0;
  }
  return count;
}

static void fill_spec(const struct body *v, struct job_spec *spec) {
  case_prototype(spec, 1);
  struct pneunet_spec *p = &spec->pneunet;
  memcpy(p->runs, v->runs, sizeof v->runs);
  p->run_count = v->run_count;
  p->chamber_count = 0;
  for (int r = 0; r < v->run_count; r++) {
    p->chamber_count += v->runs[r].count;
  }
  int n = p->chamber_count, shared = joints(p);
  p->length = n * (2 * p->gap_wall + p->cavity_length) - shared * p->gap_wall +
              (n - 1 - shared) * p->chamber_gap;
  p->has_channel = v->has_channel;
  p->taper_left = p->taper_right = p->taper_top = p->taper_bottom = 0;
  if (v->tapered) {
    p->taper_left = 0.03;
    p->taper_right = v->half ? 0.03 : 0.02;
    p->taper_top = 0.02;
    p->taper_bottom = 0.01;
  }
  p->scaled_walls = v->scaled;
  spec->half_model = v->half;
}

/* ---- faces of all elements ---- */

struct face_key {
  int corner[4]; /* ascending */
  int middle;
  int element, axis, side;
};

static int compare_int(const void *a, const void *b) {
  return *(const int *)a - *(const int *)b;
}

static int compare_face(const void *a, const void *b) {
  const struct face_key *x = a, *y = b;
  for (int i = 0; i < 4; i++) {
    if (x->corner[i] != y->corner[i]) {
      return x->corner[i] - y->corner[i];
    }
  }
  return 0;
}

static struct face_key key_of(const struct mesh *mesh, int element, int axis, int side) {
  struct mesh_face face = {element, (signed char)axis, (signed char)side, 0, 0};
  struct face_key key = {.element = element, .axis = axis, .side = side};
  int nodes[QUAD9_NODES];
  mesh_face_nodes(mesh, &face, nodes);
  for (int i = 0; i < 4; i++) {
    key.corner[i] = nodes[(i / 2) * 6 + (i % 2) * 2];
  }
  key.middle = nodes[4];
  qsort(key.corner, 4, sizeof *key.corner, compare_int);
  return key;
}

START_TEST(every_face_is_inner_or_listed) {
  struct job_spec spec;
  struct mesh mesh;
  fill_spec(&variants[_i], &spec);
  ck_assert_int_eq(pneunet_mesh(&spec, &mesh, NULL), STATUS_OK);
  size_t count = 6 * (size_t)mesh.element_count;
  struct face_key *all = calloc(count, sizeof *all);
  struct face_key *listed = calloc((size_t)mesh.face_count, sizeof *listed);
  ck_assert(all && listed);
  for (size_t f = 0; f < count; f++) {
    all[f] = key_of(&mesh, (int)(f / 6), (int)(f % 3), f % 6 < 3 ? -1 : 1);
  }
  for (int f = 0; f < mesh.face_count; f++) {
    listed[f] = key_of(&mesh, mesh.faces[f].element, mesh.faces[f].axis, mesh.faces[f].side);
  }
  qsort(all, count, sizeof *all, compare_face);
  qsort(listed, (size_t)mesh.face_count, sizeof *listed, compare_face);
  int next = 0;
  for (size_t f = 0; f < count;) {
    size_t same = 1;
    while (f + same < count && compare_face(&all[f], &all[f + same]) == 0) {
      same++;
    }
    ck_assert_uint_le(same, 2);
    if (same == 2) { /* the same nine nodes, on opposite sides of two elements */
      ck_assert_int_eq(all[f].middle, all[f + 1].middle);
      ck_assert_int_ne(all[f].element, all[f + 1].element);
      ck_assert_int_eq(all[f].axis, all[f + 1].axis);
      ck_assert_int_eq(all[f].side, -all[f + 1].side);
    } else {
      ck_assert_int_lt(next, mesh.face_count);
      ck_assert_int_eq(compare_face(&all[f], &listed[next++]), 0);
    }
    f += same;
  }
  ck_assert_int_eq(next, mesh.face_count);
  free(all);
  free(listed);
  mesh_release(&mesh);
}
END_TEST

/* ---- topology ---- */

struct edge {
  int from, to, direction, cavity;
};

static int compare_edge(const void *a, const void *b) {
  const struct edge *x = a, *y = b;
  return x->from != y->from ? x->from - y->from : x->to - y->to;
}

/* Edges of the boundary faces, each once per face, directed along the outward normal. */
static int collect_edges(const struct mesh *mesh, struct edge *edges) {
  static const int around[4] = {0, 6, 8, 2};
  int count = 0;
  for (int f = 0; f < mesh->face_count; f++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(mesh, &mesh->faces[f], nodes);
    for (int k = 0; k < 4; k++) {
      int a = nodes[around[k]], b = nodes[around[(k + 1) % 4]];
      int direction = (a < b ? 1 : -1) * mesh->faces[f].side;
      edges[count++] = (struct edge){a < b ? a : b, a < b ? b : a, direction,
                                     mesh->faces[f].kind == FACE_CAVITY};
    }
  }
  qsort(edges, (size_t)count, sizeof *edges, compare_edge);
  return count;
}

/* Every edge of the boundary belongs to two faces that pass it in opposite directions, and
 * V - E + F is that of spheres: the outer surface and one a separate cavity. A half model is
 * one ball. Cavity faces meet others only at the plane of symmetry. */
START_TEST(boundary_is_closed) {
  struct job_spec spec;
  struct mesh mesh;
  fill_spec(&variants[_i], &spec);
  ck_assert_int_eq(pneunet_mesh(&spec, &mesh, NULL), STATUS_OK);
  struct edge *edges = calloc(4 * (size_t)mesh.face_count, sizeof *edges);
  char *used = calloc((size_t)mesh.node_count, 1);
  ck_assert(edges && used);
  int count = collect_edges(&mesh, edges), vertices = 0;
  for (int e = 0; e < count; e += 2) {
    ck_assert_int_eq(compare_edge(&edges[e], &edges[e + 1]), 0);
    ck_assert_int_eq(edges[e].direction, -edges[e + 1].direction);
    ck_assert(e + 2 >= count || compare_edge(&edges[e], &edges[e + 2]) != 0);
    bool on_plane = mesh.x[3 * edges[e].from + 1] == 0 && mesh.x[3 * edges[e].to + 1] == 0;
    ck_assert(edges[e].cavity == edges[e + 1].cavity || (mesh.half && on_plane));
    used[edges[e].from] = used[edges[e].to] = 1;
  }
  for (int n = 0; n < mesh.node_count; n++) {
    vertices += used[n];
  }
  int cavities = spec.pneunet.has_channel ? 1 : spec.pneunet.chamber_count;
  ck_assert_int_eq(vertices - count / 2 + mesh.face_count, mesh.half ? 2 : 2 * (1 + cavities));
  free(edges);
  free(used);
  mesh_release(&mesh);
}
END_TEST

/* ---- volumes ---- */

/* Void of the cavities and the channel, without tapers, from the definition of the geometry. */
static double void_by_hand(const struct pneunet_spec *p) {
  int n = p->chamber_count, c = count_of(p, CHAMBER_C);
  double inner = p->width - 2 * p->side_wall;
  double height = p->height_base - p->top_wall - p->bottom_layer, lift = p->slit + p->slit_floor;
  double volume = p->cavity_length * inner * (n * height - c * lift);
  if (p->has_channel) {
    volume += p->channel_width * p->channel_height * (p->length - 2 * p->gap_wall);
    volume += p->channel_width * p->cavity_length * (n * p->channel_cover + c * lift);
  }
  return volume;
}

/* Gaps between chambers and slits under them. */
static double gaps_by_hand(const struct pneunet_spec *p) {
  int gaps = p->chamber_count - 1 - joints(p), c = count_of(p, CHAMBER_C);
  double chamber = p->cavity_length + 2 * p->gap_wall;
  return gaps * p->chamber_gap * p->width * (p->height_base - p->bottom_layer) +
         c * chamber * p->slit * (p->width - 2 * p->stem);
}

START_TEST(volumes_are_those_of_the_geometry) {
  struct job_spec spec;
  struct mesh mesh;
  fill_spec(&variants[_i], &spec);
  struct pneunet_spec *p = &spec.pneunet;
  p->taper_left = p->taper_right = p->taper_top = p->taper_bottom = 0;
  ck_assert_int_eq(pneunet_mesh(&spec, &mesh, NULL), STATUS_OK);
  double share = mesh.half ? 0.5 : 1, box = p->length * p->width * p->height_base;
  double inside = share * void_by_hand(p);
  double solid = share * (box - gaps_by_hand(p)) - inside;
  ck_assert_double_eq_tol(mesh_cavity_volume(&mesh) / inside, 1, 1e-12);
  ck_assert_double_eq_tol(mesh_solid_volume(&mesh) / solid, 1, 1e-12);
  mesh_release(&mesh);
}
END_TEST

/* The reference body: sideways tapers scale the width linearly along x. */
START_TEST(volumes_of_the_reference_body) {
  struct job_spec spec;
  struct mesh mesh;
  case_prototype(&spec, 12);
  ck_assert_int_eq(pneunet_mesh(&spec, &mesh, NULL), STATUS_OK);
  double slope = 2 * tan(2 * M_PI / 180) / 30, cavity = 0, gap = 0;
  for (int c = 0; c < 12; c++) {
    cavity += 4 * 26 * 12.5 * (1 - slope * (10 * c + 4));
    gap += c < 11 ? 2 * 30 * 14 * (1 - slope * (10 * c + 9)) : 0;
  }
  double box = 118 * 30 * 20 * (1 - slope * 59);
  ck_assert_double_eq_tol(2e9 * mesh_cavity_volume(&mesh) / cavity, 1, 1e-12);
  ck_assert_double_eq_tol(2e9 * mesh_solid_volume(&mesh) / (box - gap - cavity), 1, 1e-12);
  mesh_release(&mesh);
}
END_TEST

/* Simpson's rule, exact for the areas below, which are quadratic along the body. */
static double simpson(double from, double length,
                      double (*area)(const struct pneunet_spec *, double),
                      const struct pneunet_spec *p) {
  return length / 6 * (area(p, from) + 4 * area(p, from + 0.5 * length) + area(p, from + length));
}

static double section_area(const struct pneunet_spec *p, double x) {
  double width = p->width - x * (tan(p->taper_left) + tan(p->taper_right));
  return width * pneunet_height(p, x);
}

static double cavity_area(const struct pneunet_spec *p, double x) {
  double width = p->width - x * (tan(p->taper_left) + tan(p->taper_right)) - 2 * p->side_wall;
  return width * (pneunet_height(p, x) - p->bottom_layer - p->top_wall);
}

static double gap_area(const struct pneunet_spec *p, double x) {
  double width = p->width - x * (tan(p->taper_left) + tan(p->taper_right));
  return width * (pneunet_height(p, x) - p->bottom_layer);
}

/* Walls that keep their thickness in a body that is tapered on all sides, each by another angle. */
START_TEST(volumes_of_a_tapered_body_with_constant_walls) {
  struct job_spec spec;
  struct mesh mesh;
  case_prototype(&spec, 6);
  struct pneunet_spec *p = &spec.pneunet;
  p->scaled_walls = false;
  p->has_channel = false;
  p->taper_left = 0.03;
  p->taper_right = 0.05;
  p->taper_top = 0.04;
  p->taper_bottom = 0.02;
  spec.half_model = false;
  ck_assert_int_eq(pneunet_mesh(&spec, &mesh, NULL), STATUS_OK);
  double cavity = 0, gap = 0;
  for (int c = 0; c < 6; c++) {
    cavity += simpson(0.010 * c + 0.002, 0.004, cavity_area, p);
    gap += c < 5 ? simpson(0.010 * c + 0.008, 0.002, gap_area, p) : 0;
  }
  double solid = simpson(0, p->length, section_area, p) - gap - cavity;
  ck_assert_double_eq_tol(mesh_cavity_volume(&mesh) / cavity, 1, 1e-9);
  ck_assert_double_eq_tol(mesh_solid_volume(&mesh) / solid, 1, 1e-9);
  mesh_release(&mesh);
}
END_TEST

/* ---- sections, stations, facing pairs ---- */

START_TEST(sections_follow_the_body) {
  struct job_spec spec;
  struct mesh mesh;
  fill_spec(&variants[_i], &spec);
  const struct pneunet_spec *p = &spec.pneunet;
  ck_assert_int_eq(pneunet_mesh(&spec, &mesh, NULL), STATUS_OK);
  for (int n = 0; n < mesh.node_count; n++) {
    int section = mesh.node_section[n];
    ck_assert_double_eq_tol(mesh.x[3 * n], mesh.x[3 * mesh.centreline[section]], 1e-15);
    double z = mesh.x[3 * n + 2] - mesh.x[3 * n] * tan(p->taper_bottom);
    z *= p->scaled_walls ? p->height_base / pneunet_height(p, mesh.x[3 * n]) : 1;
    ck_assert_int_eq(mesh.node_core[n], z < p->bottom_layer + 1e-9);
  }
  for (int s = 0; s < mesh.section_count; s++) {
    const double *x = mesh.x + 3 * mesh.centreline[s];
    ck_assert_int_eq(mesh.node_section[mesh.centreline[s]], s);
    ck_assert_double_eq_tol(x[1], 0, 1e-15);
    ck_assert_double_eq_tol(x[2], x[0] * tan(p->taper_bottom), 1e-12);
    ck_assert(s == 0 || x[0] > mesh.x[3 * mesh.centreline[s - 1]]);
  }
  ck_assert_int_eq(mesh.station_count, p->chamber_count + 1);
  ck_assert_int_eq(mesh.station[0], 0);
  ck_assert_int_eq(mesh.station[p->chamber_count], mesh.section_count - 1);
  double tip = mesh.x[3 * mesh.centreline[mesh.section_count - 1]];
  ck_assert_double_eq_tol(tip, p->length, 1e-15);
  mesh_release(&mesh);
}
END_TEST

START_TEST(facing_pairs_look_at_each_other) {
  struct job_spec spec;
  struct mesh mesh;
  fill_spec(&variants[_i], &spec);
  const struct pneunet_spec *p = &spec.pneunet;
  ck_assert_int_eq(pneunet_mesh(&spec, &mesh, NULL), STATUS_OK);
  bool open = count_of(p, CHAMBER_A) < p->chamber_count;
  ck_assert_int_eq(mesh.facing_count > 0, open);
  bool detached = count_of(p, CHAMBER_C) > 0;
  double narrowest = detached ? p->slit : p->chamber_gap;
  /* Through the slit under one detached chamber its neighbours see each other. */
  double widest = p->chamber_gap;
  widest += detached ? p->chamber_gap + p->cavity_length + 2 * p->gap_wall : 0;
  ck_assert_double_eq_tol(mesh.gap_width, open ? narrowest : 0, 1e-15);
  for (int f = 0; f < mesh.facing_count; f++) {
    const struct mesh_facing *facing = &mesh.facing[f];
    int slave[QUAD9_NODES], master[QUAD9_NODES], axis = facing->slave.axis;
    ck_assert_int_eq(facing->master.axis, axis);
    ck_assert_int_eq(facing->slave.side, 1);
    ck_assert_int_eq(facing->master.side, -1);
    mesh_face_nodes(&mesh, &facing->slave, slave);
    mesh_face_nodes(&mesh, &facing->master, master);
    for (int m = 0; m < QUAD9_NODES; m++) {
      double width = mesh.x[3 * master[m] + axis] - mesh.x[3 * slave[m] + axis];
      ck_assert_double_gt(width, 0.8 * mesh.gap_width);
      ck_assert_double_lt(width, 1.001 * widest);
    }
  }
  mesh_release(&mesh);
}
END_TEST

START_TEST(every_tier_chooses_at_least_one) {
  struct job_spec spec;
  case_prototype(&spec, 2);
  int elements[3];
  for (int tier = ACCURACY_FAST; tier <= ACCURACY_FINE; tier++) {
    struct mesh mesh;
    spec.accuracy = (enum accuracy)tier;
    spec.mesh = (struct mesh_spec){0};
    struct pneunet_cells n = pneunet_resolution(&spec);
    const struct grid_division *all[] = {&n.gap_wall, &n.cavity,     &n.gap,       &n.channel,
                                         &n.stem,     &n.half_width, &n.side_wall, &n.bottom,
                                         &n.below,    &n.duct,       &n.cover,     &n.slit,
                                         &n.floor,    &n.height,     &n.top};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
      ck_assert_int_gt(all[k]->cells, 0);
    }
    ck_assert_int_eq(pneunet_mesh(&spec, &mesh, NULL), STATUS_OK);
    elements[tier] = mesh.element_count;
    mesh_release(&mesh);
  }
  ck_assert(elements[0] <= elements[1] && elements[1] < elements[2]);
  spec.mesh.bottom = 5;
  ck_assert_int_eq(pneunet_resolution(&spec).bottom.cells, 5);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("pneunet");
  TCase *pneunet = tcase_create("pneunet");
  tcase_set_timeout(pneunet, 60);
  tcase_add_loop_test(pneunet, every_face_is_inner_or_listed, 0, VARIANTS);
  tcase_add_loop_test(pneunet, boundary_is_closed, 0, VARIANTS);
  tcase_add_loop_test(pneunet, volumes_are_those_of_the_geometry, 0, VARIANTS);
  tcase_add_test(pneunet, volumes_of_the_reference_body);
  tcase_add_test(pneunet, volumes_of_a_tapered_body_with_constant_walls);
  tcase_add_loop_test(pneunet, sections_follow_the_body, 0, VARIANTS);
  tcase_add_loop_test(pneunet, facing_pairs_look_at_each_other, 0, VARIANTS);
  tcase_add_test(pneunet, every_tier_chooses_at_least_one);
  suite_add_tcase(suite, pneunet);
  return suite_run(suite);
}
