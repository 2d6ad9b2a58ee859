#include "solver/fe/model_internal.h"

#include <stdlib.h>
#include <string.h>
#include "solver/fe/obstacle_internal.h"
#include "solver/base/vec3.h"

static enum status fill_geometry(struct fe_model *m, struct error *error) {
  const struct mesh *mesh = m->mesh;
  for (int e = 0; e < mesh->element_count; e++) {
    double x[HEX27_NODES][3];
    for (int a = 0; a < HEX27_NODES; a++) {
      memcpy(x[a], mesh->x + 3 * mesh->element_nodes[HEX27_NODES * e + a], sizeof x[a]);
    }
    double volume = element_geometry_fill(&m->hex27, x, &m->geometry[e]);
    if (!(volume > 0)) {
      return error_set(error, STATUS_GEOMETRY, "/actuator",
                       "the undeformed body folds over itself near x = %.4g mm", 1e3 * x[13][0]);
    }
    m->reference_volume += volume;
  }
  return STATUS_OK;
}

/* Equation numbers, and the cavity faces of every element. */
static void number_unknowns(struct fe_model *m) {
  const struct mesh *mesh = m->mesh;
  for (int n = 0; n < mesh->node_count; n++) {
    for (int i = 0; i < 3; i++) {
      int held = mesh->fixed[3 * n + i];
      m->equation[3 * n + i] = held ? -1 : m->dof_count;
      if (!held) {
        m->node_of[m->dof_count++] = n;
      }
    }
  }
  /* Counting sort; the counts sit two places up so that the fill leaves the starts in place. */
  for (int f = 0; f < mesh->face_count; f++) {
    m->cavity_start[mesh->faces[f].element + 2] += mesh->faces[f].kind == FACE_CAVITY;
  }
  for (int e = 0; e < mesh->element_count; e++) {
    m->cavity_start[e + 2] += m->cavity_start[e + 1];
  }
  for (int f = 0; f < mesh->face_count; f++) {
    if (mesh->faces[f].kind == FACE_CAVITY) {
      m->cavity_face[m->cavity_start[mesh->faces[f].element + 1]++] = mesh->faces[f];
    }
  }
}

static bool allocate(struct fe_model *m) {
  size_t nodes = (size_t)m->mesh->node_count, elements = (size_t)m->mesh->element_count;
  size_t faces = (size_t)m->mesh->face_count;
  m->geometry = calloc(elements, sizeof *m->geometry);
  m->internal = calloc(elements, sizeof *m->internal);
  m->cavity_start = calloc(elements + 2, sizeof *m->cavity_start);
  m->cavity_face = calloc(faces + 1, sizeof *m->cavity_face);
  m->dead_load = calloc(3 * nodes, sizeof *m->dead_load);
  m->equation = calloc(3 * nodes, sizeof *m->equation);
  m->node_of = calloc(3 * nodes, sizeof *m->node_of);
  m->residual = calloc(3 * nodes, sizeof *m->residual);
  m->element_value = calloc(elements * ELEMENT_PACKED, sizeof *m->element_value);
  m->clique_value = calloc(elements + 1, sizeof *m->clique_value);
  return m->geometry && m->internal && m->cavity_start && m->cavity_face && m->dead_load &&
         m->equation && m->node_of && m->residual && m->element_value && m->clique_value;
}

enum status model_create(const struct mesh *mesh, const struct material_spec *material,
                         bool use_contact, struct fe_model **out, struct error *error) {
  return model_create_with(mesh, material, use_contact, NULL, out, error);
}

enum status model_create_with(const struct mesh *mesh, const struct material_spec *material,
                              bool use_contact, struct fe_analyses *spare, struct fe_model **out,
                              struct error *error) {
  struct fe_model *m = calloc(1, sizeof *m);
  *out = NULL;
  if (!m) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a model");
  }
  m->mesh = mesh;
  m->spare = spare;
  m->material = *material;
  double mu = material_shear_modulus(material);
  m->bulk_modulus = material->bulk_ratio * mu;
  m->use_contact = use_contact;
  for (int c = 0; c < MESH_CAVITIES; c++) {
    m->cavity_share[c] = 1;
  }
  hex27_tables_fill(&m->hex27);
  quad9_tables_fill(&m->quad9);
  enum status status = contact_init(&m->contact, mesh, &m->quad9, error);
  if (status == STATUS_OK && !allocate(m)) {
    status =
        error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d elements", mesh->element_count);
  }
  if (status == STATUS_OK) {
    /* Soft against the walls, so that a step into contact does not rebound; the multipliers
     * remove the penetration that this leaves. */
    m->contact.stiffness = 1.2 * mu / mesh->wall_thickness;
    double gap = mesh->gap_width > 0 ? mesh->gap_width : mesh->wall_thickness;
    m->contact.smoothing = 0.01 * fmin(gap, mesh->wall_thickness);
    m->contact.reach = 2 * mesh->wall_thickness;
    number_unknowns(m);
    status = fill_geometry(m, error);
  }
  if (status == STATUS_OK && use_contact && mesh->half) {
    const struct contact_plane mirror = {{0, 0, 0}, {0, 1, 0}, true};
    status = contact_add_plane(&m->contact, &mirror);
  }
  m->pattern_stale = true;
  if (status == STATUS_OK && !spare && /* which knows later what is needed first */
      (!model_room_for_pairs(m) || model_renew_pattern(m) != STATUS_OK)) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the tangent");
  }
  if (status != STATUS_OK) {
    model_destroy(m);
    return status;
  }
  *out = m;
  return STATUS_OK;
}

void analyses_release(struct fe_analyses *analyses) {
  ldlt_destroy(analyses->bare);
  ldlt_destroy(analyses->touching);
  *analyses = (struct fe_analyses){0};
}

void model_destroy(struct fe_model *m) {
  if (!m) {
    return;
  }
  contact_release(&m->contact);
  obstacles_release(m);
  model_park_analysis(m);
  free(m->geometry);
  free(m->internal);
  free(m->cavity_start);
  free(m->cavity_face);
  free(m->dead_load);
  free(m->equation);
  free(m->node_of);
  free(m->residual);
  free(m->element_value);
  free(m->contact_value);
  free(m->clique_value);
  free(m->pair_touches);
  free(m->pair_clique);
  free(m->pair_foreseen);
  free(m);
}

void model_retire(struct fe_model *m) {
  ldlt_destroy(m->ldlt);
  free(m->element_value);
  free(m->contact_value);
  free(m->internal);
  m->ldlt = NULL;
  m->element_value = m->contact_value = NULL;
  m->internal = NULL;
  m->pattern_stale = true;
}

void model_add_gravity(struct fe_model *m, const double gravity[3]) {
  const struct mesh *mesh = m->mesh;
  for (int e = 0; e < mesh->element_count; e++) {
    for (int q = 0; q < HEX27_POINTS; q++) {
      double n[HEX27_NODES];
      hex27_shape(m->hex27.point[q], n, NULL);
      double mass = m->material.density_kg_m3 * m->geometry[e].weight[q];
      for (int a = 0; a < HEX27_NODES; a++) {
        for (int i = 0; i < 3; i++) {
          m->dead_load[3 * mesh->element_nodes[HEX27_NODES * e + a] + i] +=
              mass * n[a] * gravity[i];
        }
      }
    }
  }
}

enum status model_add_plane(struct fe_model *m, const double point[3], const double normal[3],
                            struct error *error) {
  struct contact_plane plane = {
      {point[0], point[1], point[2]}, {normal[0], normal[1], normal[2]}, false};
  double length = vec3_norm(normal);
  for (int n = 0; n < m->mesh->node_count; n++) {
    const double *x = m->mesh->x + 3 * (size_t)n;
    if (vec3_dot(x, normal) - vec3_dot(point, normal) < -1e-6 * length * m->mesh->wall_thickness) {
      return error_set(error, STATUS_GEOMETRY, NULL,
                       "the undeformed body reaches behind a plane of contact, at x = %.4g mm, "
                       "y = %.4g mm, z = %.4g mm",
                       1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
    }
  }
  enum status status = contact_add_plane(&m->contact, &plane);
  return status == STATUS_OK
             ? STATUS_OK
             : error_set(error, status, NULL, "more than %d planes of contact", CONTACT_PLANES - 1);
}

enum status state_create(const struct fe_model *m, struct fe_state *state) {
  state->u = calloc(3 * (size_t)m->mesh->node_count, sizeof *state->u);
  state->p = calloc(ELEMENT_PRESSURES * (size_t)m->mesh->element_count, sizeof *state->p);
  state->lambda = calloc((size_t)m->contact.point_count + 1, sizeof *state->lambda);
  size_t memories = obstacles_memory_count(m);
  state->memory = memories > 0 ? calloc(memories, sizeof *state->memory) : NULL;
  if (!state->u || !state->p || !state->lambda || (memories > 0 && !state->memory)) {
    state_release(state);
    return STATUS_NO_MEMORY;
  }
  return STATUS_OK;
}

void state_release(struct fe_state *state) {
  free(state->u);
  free(state->p);
  free(state->lambda);
  free(state->memory);
  *state = (struct fe_state){0};
}

void state_clear(const struct fe_model *m, struct fe_state *state) {
  memset(state->u, 0, sizeof *state->u * 3 * (size_t)m->mesh->node_count);
  memset(state->p, 0, sizeof *state->p * ELEMENT_PRESSURES * (size_t)m->mesh->element_count);
  memset(state->lambda, 0, sizeof *state->lambda * (size_t)m->contact.point_count);
  for (size_t i = 0; i < obstacles_memory_count(m); i++) {
    state->memory[i] = (struct obstacle_memory){.pressure = 0};
  }
}

void state_copy(const struct fe_model *m, struct fe_state *to, const struct fe_state *from) {
  memcpy(to->u, from->u, sizeof *to->u * 3 * (size_t)m->mesh->node_count);
  memcpy(to->p, from->p, sizeof *to->p * ELEMENT_PRESSURES * (size_t)m->mesh->element_count);
  memcpy(to->lambda, from->lambda, sizeof *to->lambda * (size_t)m->contact.point_count);
  if (m->obstacle_count > 0) {
    memcpy(to->memory, from->memory, sizeof *to->memory * obstacles_memory_count(m));
  }
}

void model_gather(const struct fe_model *m, const double *u, int element,
                  double out[3][HEX27_STRIDE]) {
  const int *nodes = m->mesh->element_nodes + (size_t)HEX27_NODES * (size_t)element;
  memset(out, 0, 3 * sizeof *out);
  for (int a = 0; a < HEX27_NODES; a++) {
    for (int i = 0; i < 3; i++) {
      out[i][a] = u[3 * nodes[a] + i];
    }
  }
}
