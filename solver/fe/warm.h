/* Warm starts: the converged states of one load path as first guesses for a neighbouring design.
 *
 * Both bodies have the same topology (elements, sections, contact points) but other dimensions or
 * materials. A state is carried over section by section: the section's rigid rotation and the
 * change of the distance to the next section, then what the section's points have moved within
 * it. The path is then walked from the highest load downwards, because falling loads open
 * contacts; a walk that fails anywhere is repeated from the undeformed state. */
#ifndef PNEULAB_FE_WARM_H
#define PNEULAB_FE_WARM_H

#include <stdint.h>
#include "solver/fe/path.h"
#include "solver/job/design.h"

/* Recorded states of a path, with the undeformed body they belong to. */
struct path_record {
  int node_count, element_count, section_count, point_count;
  uint64_t topology;            /* of the mesh: bodies with another one are no neighbours */
  double *x;                    /* node_count x 3, undeformed, m */
  double place[DESIGN_NUMBERS]; /* the design as a point */
  bool mixed; /* no path that was followed, but one expected from several: of the body itself */
  int facing_count;      /* pairs of faces across gaps */
  unsigned char *facing; /* of each: whether it was part of the body's last tangents */
  int count, capacity;
  double *pressure; /* Pa, rising */
  struct fe_state *state;
};

/* An empty record of a model's body. The caller owns *out. STATUS_OK or STATUS_NO_MEMORY. */
enum status path_record_create(const struct fe_model *model, struct path_record **out);
void path_record_destroy(struct path_record *record);

/* Appends a copy of a state. STATUS_OK or STATUS_NO_MEMORY. */
enum status path_record_add(struct path_record *record, double pressure,
                            const struct fe_state *state);

/* Notes which pairs of the contact the model's tangents have: the next body's are to have them,
 * too. */
void path_record_note_pairs(struct path_record *record, const struct fe_model *model);

/* Writes the record in the machine's own number format, under a temporary name first; reads one
 * back. STATUS_IO with the reason, for a file of another version or machine, or a damaged one;
 * STATUS_NO_MEMORY. The caller owns *out. */
enum status path_record_write(const struct path_record *record, const char *path,
                              struct error *error);
enum status path_record_read(const char *path, struct path_record **out, struct error *error);

/* Whether the record's body has the topology of the model's. */
bool path_record_fits(const struct path_record *record, const struct fe_model *model);

/* First guess for the model's body from state `index` of a record that fits. `state` is one of
 * the model. STATUS_OK or STATUS_NO_MEMORY. */
enum status path_record_carry(const struct path_record *record, int index,
                              const struct fe_model *model, struct fe_state *state);

/* As path_follow, from the states of a record. *warm tells whether that has worked; if not, the
 * path was followed from the undeformed state. */
enum status path_follow_warm(struct equilibrium *solver, const struct path_options *options,
                             const struct path_record *record, struct fe_state *state, bool *warm,
                             struct error *error);

#endif
