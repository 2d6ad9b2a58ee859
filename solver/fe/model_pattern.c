/* Which pairs of the contact are part of the analysed tangent.
 *
 * Pairs that might touch are many: all faces across all gaps. To have them in the pattern, as if
 * they touched, costs more than twice the operations of a factorisation. So only those are taken in
 * that touch, are about to, or have touched in a neighbouring body. */
#include <stdlib.h>
#include <string.h>
#include "solver/fe/model_internal.h"

/* Faces across a gap are about to touch when less than this part of the gap is left. */
static const double near_share = 0.35;

/* Cliques: all elements, then the pairs of the pattern. */
static void list_cliques(const struct fe_model *m, int *start, int *dofs) {
  const struct mesh *mesh = m->mesh;
  int next = 0, clique = 0;
  start[0] = 0;
  for (int e = 0; e < mesh->element_count; e++) {
    for (int i = 0; i < 3; i++) {
      for (int a = 0; a < HEX27_NODES; a++) {
        dofs[next++] = m->equation[3 * mesh->element_nodes[HEX27_NODES * e + a] + i];
      }
    }
    start[++clique] = next;
  }
  for (int p = 0; m->use_contact && p < m->contact.pair_count; p++) {
    int nodes[CONTACT_NODES];
    if (m->pair_clique[p] < 0) {
      continue;
    }
    contact_nodes(&m->contact, p, nodes);
    for (int r = 0; r < CONTACT_DOFS; r++) {
      dofs[next++] = m->equation[3 * nodes[r / 3] + r % 3];
    }
    start[++clique] = next;
  }
}

bool model_room_for_pairs(struct fe_model *m) {
  int pairs = m->contact.pair_count;
  if (pairs <= m->pair_room && m->contact_value) {
    return true;
  }
  size_t room = (size_t)pairs + 1, elements = (size_t)m->mesh->element_count;
  double *value = realloc(m->contact_value, sizeof *value * room * CONTACT_PACKED);
  m->contact_value = value ? value : m->contact_value;
  const double **clique = realloc(m->clique_value, sizeof *clique * (elements + room));
  m->clique_value = clique ? clique : m->clique_value;
  unsigned char *touches = realloc(m->pair_touches, room);
  m->pair_touches = touches ? touches : m->pair_touches;
  int *place = realloc(m->pair_clique, sizeof *place * room);
  m->pair_clique = place ? place : m->pair_clique;
  if (!value || !clique || !touches || !place) {
    return false;
  }
  for (int p = m->pair_room; p < pairs; p++) {
    touches[p] = 0;
    place[p] = -1;
  }
  m->pair_room = pairs;
  return true;
}

/* Whether some point of a pair across a gap is about to touch. */
static bool about_to_touch(const struct fe_model *m, int pair) {
  const struct contact *c = &m->contact;
  const struct contact_point *point = &c->point[QUAD9_POINTS * c->pair[pair].slave];
  for (int q = 0; q < QUAD9_POINTS; q++) {
    if (point[q].pair == pair &&
        (point[q].lambda > 0 ||
         (point[q].valid && point[q].gap < near_share * m->mesh->gap_width))) {
      return true;
    }
  }
  return false;
}

/* Gives the pairs of the pattern their places behind the elements. Pairs that are not across a gap
 * are listed only when they are near. Those that were foreseen come with the first that is needed,
 * and those that are needed are foreseen from then on: patterns that grow pair by pair would each
 * take an analysis. */
static void choose_pairs(struct fe_model *m) {
  int facing = m->mesh->facing_count, pairs = m->use_contact ? m->contact.pair_count : 0;
  bool any = false;
  for (int p = 0; p < pairs; p++) {
    bool needed = p >= facing || m->pair_touches[p] || about_to_touch(m, p);
    any = any || needed;
    m->pair_clique[p] = needed ? 0 : -1;
  }
  m->pattern_pairs = 0;
  for (int p = 0; p < pairs; p++) {
    bool foreseen = any && m->pair_foreseen && p < facing && m->pair_foreseen[p];
    bool in = m->pair_clique[p] >= 0 || foreseen;
    m->pair_clique[p] = in ? m->pattern_pairs++ : -1;
    if (in && m->pair_foreseen && p < facing) {
      m->pair_foreseen[p] = 1;
    }
  }
}

/* Puts the analysis of this pattern in use, if a spare one is. */
static bool take_spare(struct fe_model *m, struct ldlt **spare,
                       const struct ldlt_pattern *pattern) {
  if (!*spare || !ldlt_fits(*spare, pattern)) {
    return false;
  }
  m->ldlt = *spare;
  *spare = NULL;
  return true;
}

void model_park_analysis(struct fe_model *m) {
  struct fe_analyses *spare = m->spare;
  if (spare && m->ldlt) {
    bool bare = ldlt_clique_count(m->ldlt) == m->mesh->element_count;
    struct ldlt **place = bare ? &spare->bare : &spare->touching;
    ldlt_destroy(*place);
    *place = m->ldlt;
  } else {
    ldlt_destroy(m->ldlt);
  }
  m->ldlt = NULL;
}

/* Orders and analyses the tangent for the chosen pairs. */
static enum status analyse(struct fe_model *m) {
  const struct mesh *mesh = m->mesh;
  int cliques = mesh->element_count + m->pattern_pairs;
  size_t entries =
      (size_t)mesh->element_count * ELEMENT_DOFS + (size_t)m->pattern_pairs * CONTACT_DOFS;
  int *start = malloc(sizeof *start * ((size_t)cliques + 1));
  int *dofs = malloc(sizeof *dofs * (entries + 1));
  enum status status = STATUS_NO_MEMORY;
  if (start && dofs) {
    list_cliques(m, start, dofs);
    struct ldlt_pattern pattern = {m->dof_count, mesh->node_count, m->node_of, cliques, start,
                                   dofs};
    model_park_analysis(m);
    if (m->spare && (take_spare(m, &m->spare->bare, &pattern) ||
                     take_spare(m, &m->spare->touching, &pattern))) {
      status = STATUS_OK;
    } else {
      if (m->spare && m->pattern_pairs > 0) { /* it would only take memory */
        ldlt_destroy(m->spare->touching);
        m->spare->touching = NULL;
      }
      status = ldlt_create(&pattern, &m->ldlt, NULL);
      m->statistics.analyses++;
    }
  }
  m->pattern_stale = status != STATUS_OK;
  if (status == STATUS_OK && ldlt_statistics(m->ldlt).flops > m->factor.flops) {
    m->factor = ldlt_statistics(m->ldlt);
  }
  free(start);
  free(dofs);
  return status;
}

enum status model_renew_pattern(struct fe_model *m) {
  bool fits = !m->pattern_stale;
  for (int p = 0; m->use_contact && p < m->contact.pair_count; p++) {
    fits = fits && (!m->pair_touches[p] || m->pair_clique[p] >= 0);
  }
  if (!fits) {
    choose_pairs(m);
    enum status status = analyse(m);
    if (status != STATUS_OK) {
      return status;
    }
  }
  const double **value = m->clique_value + m->mesh->element_count;
  for (int p = 0; m->use_contact && p < m->contact.pair_count; p++) {
    if (m->pair_clique[p] >= 0) {
      value[m->pair_clique[p]] =
          m->pair_touches[p] ? m->contact_value + (size_t)p * CONTACT_PACKED : NULL;
    }
  }
  return STATUS_OK;
}

void model_tell_pattern(const struct fe_model *m, unsigned char *facing) {
  for (int p = 0; p < m->mesh->facing_count; p++) {
    bool now = m->pair_clique && p < m->pair_room && m->pair_clique[p] >= 0;
    facing[p] = now || (m->pair_foreseen && m->pair_foreseen[p]);
  }
}

void model_renew_pairs(struct fe_model *m) {
  m->pattern_stale = m->pattern_stale || m->spare;
}

enum status model_foresee_pattern(struct fe_model *m, const unsigned char *facing) {
  size_t count = (size_t)m->mesh->facing_count;
  unsigned char *copy = malloc(count + 1);
  if (!copy) {
    return STATUS_NO_MEMORY;
  }
  memcpy(copy, facing, count);
  free(m->pair_foreseen);
  m->pair_foreseen = copy;
  m->pattern_stale = true;
  return STATUS_OK;
}
