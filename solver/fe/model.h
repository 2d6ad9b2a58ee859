/* A body ready to be solved: mesh, material, loads and the assembled system. */
#ifndef PNEULAB_FE_MODEL_H
#define PNEULAB_FE_MODEL_H

#include "solver/fe/contact.h"
#include "solver/fe/element.h"
#include "solver/fe/ldlt.h"

struct inertia;
struct obstacle;        /* solver/fe/obstacle.h */
struct obstacle_memory; /* solver/fe/obstacle.h */

enum { MODEL_OBSTACLES = 8 };

/* Unknowns of one equilibrium state. */
struct fe_state {
  double *u;      /* node_count x 3, m */
  double *p;      /* element_count x 4, Pa */
  double *lambda; /* contact multipliers, Pa */
  /* Of rigid objects: obstacle_count x 9 x contact.face_count; NULL without one. */
  struct obstacle_memory *memory;
};

struct fe_load {
  double pressure;           /* on the cavity faces, Pa, times cavity_share of the model */
  double stiffness_pressure; /* pressure used in the load's tangent, Pa */
  double dead;               /* factor of the dead load */
};

/* Analyses of tangents that are not in use: of bodies of one mesh topology without any contact of
 * the surface with itself, and with the pairs that touched last; each may be NULL. */
struct fe_analyses {
  struct ldlt *bare, *touching;
};

/* Where the time went, CPU s. */
struct fe_statistics {
  int assemblies, residuals, factorizations, solves, newton_iterations;
  double assembly_s, residual_s, factor_s, solve_s, contact_s;
  int analyses;
};

struct fe_model {
  const struct mesh *mesh;
  struct material_spec material;
  double bulk_modulus; /* Pa */
  struct hex27_tables hex27;
  struct quad9_tables quad9;
  struct element_geometry *geometry; /* per element */
  struct element_internal *internal; /* per element */
  double reference_volume;           /* of the solid, m3 */
  int *cavity_start;                 /* element_count + 1, into cavity_face */
  struct mesh_face *cavity_face;
  double cavity_share[MESH_CAVITIES]; /* pressure in each cavity relative to that of the load: 1
                                       * unless the caller sets it before any state is made */
  double *dead_load;                  /* node_count x 3, N at factor 1; the caller may add to it */
  int dof_count;
  int *equation;                /* node_count x 3, -1 where held */
  int *node_of;                 /* dof_count */
  double *residual;             /* dof_count, N */
  double *element_value;        /* packed tangents */
  double *contact_value;        /* packed tangents of the listed pairs */
  unsigned char *pair_touches;  /* of every listed pair: in the last tangent */
  unsigned char *pair_foreseen; /* pairs that every analysis with some takes in as well, or NULL */
  int *pair_clique;             /* of every listed pair: its clique behind the elements, or -1 */
  int pair_room, pattern_pairs; /* pairs that there is room for, and pairs with a clique */
  const double **clique_value;
  bool use_contact;   /* of the surface with itself */
  bool pattern_stale; /* the pairs of the contact are not those of the analysis */
  struct contact contact;
  int obstacle_count;
  struct obstacle *obstacle[MODEL_OBSTACLES]; /* rigid objects: solver/fe/obstacle.h */
  struct ldlt *ldlt;
  struct fe_analyses *spare;     /* to be used where they fit, and added to; NULL; borrowed */
  struct ldlt_statistics factor; /* of the analysis that took most */
  struct fe_statistics statistics;
  /* Adds to residual and tangent while a step in time is solved, else NULL; borrowed. */
  struct inertia *inertia;
};

/* Prepares a model of `mesh`, which must outlive it. use_contact makes the outer surface touch
 * itself and, in a half model, its mirror image.
 * Fails with STATUS_GEOMETRY for an element that is turned inside out, or NO_MEMORY. The caller
 * owns *out (model_destroy). */
enum status model_create(const struct mesh *mesh, const struct material_spec *material,
                         bool use_contact, struct fe_model **out, struct error *error);
void model_destroy(struct fe_model *model);

/* As model_create, with analyses of other models, which must outlive this one, or NULL: tangents
 * are assembled with them where they fit, and new ones are put there when they are no longer in
 * use, the last at model_destroy. */
enum status model_create_with(const struct mesh *mesh, const struct material_spec *material,
                              bool use_contact, struct fe_analyses *spare, struct fe_model **out,
                              struct error *error);
void analyses_release(struct fe_analyses *analyses);

/* Which of the pairs across gaps have been part of tangents: facing[mesh->facing_count]. */
void model_tell_pattern(const struct fe_model *model, unsigned char *facing);

/* Has every analysis with some pairs take in these, too: those of a neighbouring body, whose
 * analysis then fits. STATUS_NO_MEMORY. */
enum status model_foresee_pattern(struct fe_model *model, const unsigned char *facing);

/* Has the next tangent choose its pairs anew where there are spare analyses: for a state that is
 * far from the last one, and may do without contact. */
void model_renew_pairs(struct fe_model *model);

/* Gives up what only solving needs (factor and tangents): the model can then no
 * longer be evaluated, but volumes, gaps, mesh and statistics are still there. */
void model_retire(struct fe_model *model);

/* Adds the weight of the body under gravity g (m/s2) to the dead load. */
void model_add_gravity(struct fe_model *model, const double gravity[3]);

/* Adds a rigid plane through `point` (m) whose normal points to the side of the body, before any
 * state or solver is made. STATUS_GEOMETRY when the undeformed body lies partly behind it,
 * STATUS_TOO_LARGE beyond CONTACT_PLANES planes, STATUS_NO_MEMORY. */
enum status model_add_plane(struct fe_model *model, const double point[3], const double normal[3],
                            struct error *error);

enum status state_create(const struct fe_model *model, struct fe_state *state);
void state_release(struct fe_state *state);
void state_clear(const struct fe_model *model, struct fe_state *state);
void state_copy(const struct fe_model *model, struct fe_state *to, const struct fe_state *from);

/* Residual at the state into model->residual, and with `tangent` the cliques of the tangent; then
 * the partners of the contact are found anew. The multipliers in use are those of
 * model->contact. STATUS_INVERTED when an element has turned inside out: the residual is then not
 * valid. STATUS_NO_MEMORY. */
enum status model_evaluate(struct fe_model *model, const struct fe_state *state,
                           const struct fe_load *load, bool tangent);

/* Finds the partners of the contact at the state; the next tangent is analysed anew when other
 * faces may touch. STATUS_NO_MEMORY. */
enum status model_search_contact(struct fe_model *model, const struct fe_state *state);

/* Gives the contact the multipliers of the state, and rigid objects its memory of them. */
void model_use_multipliers(struct fe_model *model, const struct fe_state *state);

/* Renews the gaps of the known pairs and of rigid objects at the state, whether or not the model
 * uses contact. */
void model_update_gaps(struct fe_model *model, const struct fe_state *state);

/* Factorises the last tangent; returns the number of negative pivots. */
int model_factor(struct fe_model *model);
void model_solve(struct fe_model *model, const double *b, double *x);

/* y = K x with the last evaluated tangent. */
void model_multiply(const struct fe_model *model, const double *x, double *y);

/* Adds to the element pressures the linear change that belongs to the displacement step du
 * (dof_count); share as in element_recover. */
void model_recover(const struct fe_model *model, struct fe_state *state, const double *du,
                   double share);

/* The volume that the load's pressure works on: what the cavity faces enclose, each cavity counted
 * with its cavity_share, m3 (of the modelled half for a half model). With gradient not NULL:
 * d volume / d u, dof_count. */
double model_volume(const struct fe_model *model, const struct fe_state *state, double *gradient);

/* The volume of one cavity, m3 (of the modelled half for a half model). */
double model_cavity_volume(const struct fe_model *model, const struct fe_state *state, int cavity);

/* Displacements of an element's nodes, padded. */
void model_gather(const struct fe_model *model, const double *u, int element,
                  double out[3][HEX27_STRIDE]);

#endif
