/* The checked job: plain data in SI units, every default filled in. */
#ifndef PNEULAB_JOB_SPEC_H
#define PNEULAB_JOB_SPEC_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include "solver/base/error.h"

enum job_kind {
  JOB_RESPONSE,
  JOB_VERIFY,
  JOB_STUDY,
  JOB_FIT_MATERIAL,
  JOB_MATERIAL_CURVE,
  JOB_HLPV,
  JOB_IDENTIFY,
  JOB_SNAP,
  JOB_BISTABLE,
  JOB_GRASP
};

/* ---- material --------------------------------------------------------------------------- */

enum material_model { MATERIAL_NEO_HOOKE, MATERIAL_YEOH, MATERIAL_MOONEY_RIVLIN, MATERIAL_OGDEN };

enum { MATERIAL_TERMS_MAX = 6 };

/* Nearly incompressible hyperelastic solid, W = W_iso(isochoric F) + kappa/2 (J - 1)^2.
 *   neo-Hooke:      W_iso = mu/2 (I1 - 3),                     c[0] = mu
 *   Yeoh:           W_iso = sum_i c[i] (I1 - 3)^(i+1),         terms <= 3
 *   Mooney-Rivlin:  W_iso = c[0] (I1 - 3) + c[1] (I2 - 3)
 *   Ogden:          W_iso = sum_i c[i]/alpha[i] (l1^alpha[i] + l2^alpha[i] + l3^alpha[i] - 3)
 * with I1, I2, l of the isochoric part. kappa = bulk_ratio * initial shear modulus. */
struct material_spec {
  enum material_model model;
  int terms;
  double c[MATERIAL_TERMS_MAX];     /* Pa */
  double alpha[MATERIAL_TERMS_MAX]; /* Ogden exponents */
  double density_kg_m3;
  double bulk_ratio;
  char name[64];
  char source[200];
  double fit_stretch_max; /* largest uniaxial stretch of the data behind the fit, 0 if unknown */
};

/* ---- actuator --------------------------------------------------------------------------- */

enum chamber_config {
  CHAMBER_A, /* no gap: one wall between cavities */
  CHAMBER_B, /* gap down to the bottom layer, chamber attached to it */
  CHAMBER_C  /* detached from the bottom layer but for a stem around the channel */
};

/* How the width of a gap changes from gap_root at its root (z = 0) to chamber_gap g at its top
 * (z = h) in the base section. The cavities are rectangular whatever the gap: what it loses, the
 * walls gain.
 *   rectangular:     g
 *   U:               gap_root + (g - gap_root) sqrt(1 - (1 - z/d)^2) below d = gap_round, then g:
 *                    a flat floor between two quarters of ellipses, of circles for d = (g -
 *                    gap_root) / 2
 *   V, trapezoidal:  gap_root + (g - gap_root) z/h; they differ in the default of gap_root */
enum gap_shape { GAP_RECTANGULAR, GAP_U, GAP_V, GAP_TRAPEZOIDAL };

struct chamber_run {
  enum chamber_config config;
  int count;
};

enum { CHAMBER_RUNS_MAX = 32, CHAMBERS_MAX = 64 };

enum { SUCKERS_MAX = 16 };

/* A cup below the bottom face: a ring of silicone around a round opening. Lengths in m. */
struct sucker_spec {
  double position; /* of its middle along x; across, it is in the middle of the body */
  double diameter; /* of the opening; the ring is around it */
  double depth;    /* by which the ring protrudes */
  double wall;     /* thickness of the ring */
};

/* The dimensions as the job gives them, in m and rad; NAN where it is silent. */
struct pneunet_given {
  double length, chamber_length, width, height, height_base, height_tip;
  double chamber_gap, gap_root, gap_round, side_wall, gap_wall, top_wall, bottom_layer;
  double slit, slit_floor, stem;
  double channel_width, channel_height, channel_cover;
  double taper_top, taper_bottom, taper_left, taper_right;
};

/* What they come to. All lengths in m, angles in rad. x runs from the fixed base, y across (left is
 * +y), z up. */
struct pneunet_spec {
  double length;                  /* derived when the job gives chamber_length */
  double cavity_length;           /* axial; length = sum of walls, cavities and gaps */
  double width;                   /* at the base */
  double height_base, height_tip; /* before the tapers; both tapers are 0 when they differ */
  struct chamber_run runs[CHAMBER_RUNS_MAX];
  int run_count;
  int chamber_count;
  double chamber_gap; /* width of the gaps at the top */
  enum gap_shape gap_shape;
  double gap_root;  /* width of the gaps at the root; chamber_gap when rectangular */
  double gap_round; /* height of the rounded bottom of a U */
  double side_wall; /* thickness of the walls at y = +-width/2 */
  double gap_wall;  /* axial walls, facing gaps and at both ends */
  double top_wall;
  double bottom_layer;
  double slit;       /* height of the slit under a chamber of configuration C */
  double slit_floor; /* thickness of the floor of a chamber of configuration C */
  double stem;       /* half width of the stem of configuration C */
  bool has_channel;
  double channel_width, channel_height, channel_cover;
  double taper_top, taper_bottom, taper_left, taper_right;
  struct sucker_spec sucker[SUCKERS_MAX];
  int sucker_count;
  double suction_pressure; /* by which the suckers are evacuated, Pa */
  bool scaled_walls; /* tapers thin the walls with the section; else walls keep their thickness */
};

/* Two rows of chambers, mirrored about y = 0, whose walls cross the body at an angle. Lengths in m.
 * x, y, z as above; a wall that starts at x = xi in the middle is at x = xi + tan(angle) |y|. Sizes
 * of chambers, walls and gaps are normal to the walls, so along x they are 1/cos(angle) as large.
 */
struct oblique_spec {
  double length, width, height;
  double angle;       /* of the walls to the cross-section, rad, 0 to OBLIQUE_ANGLE_MAX */
  int chamber_count;  /* in each row */
  double cavity;      /* extent of a cavity normal to its walls */
  double chamber_gap; /* distance of neighbouring chambers */
  double gap_wall;    /* walls that face gaps */
  double centre_wall; /* between the rows */
  double side_wall;   /* at y = +-width/2 */
  double top_wall, bottom_layer;
  double end;       /* solid at the base along y = 0 and at the tip along the side faces */
  bool spine;       /* whether the centre wall crosses the gaps */
  bool has_channel; /* one under each row */
  double channel_width, channel_height, channel_cover;
};

enum actuator_family { FAMILY_PNEUNET, FAMILY_OBLIQUE };

/* ---- load, accuracy, job ---------------------------------------------------------------- */

struct load_spec {
  double pressure_to;     /* Pa, in the cavity of the highest pressure */
  double cavity_share[2]; /* pressure in each cavity relative to that; 0 is the row at +y */
  int steps;              /* recorded at k/steps of pressure_to, k = 0 .. steps */
  double gravity[3];      /* m/s2 */
};

enum accuracy {
  ACCURACY_FAST,
  ACCURACY_STANDARD,
  ACCURACY_FINE,
  ACCURACY_DRAFT /* coarser than fast; of bodies in three dimensions */
};

/* Elements through each feature; 0 leaves the choice to `accuracy`. */
struct mesh_spec {
  int gap_wall, cavity, gap, half_width, side_wall, bottom, height, top;
};

/* One number of a job that derivatives can be taken to. */
struct job_parameter {
  char pointer[40]; /* JSON pointer into the job: "/actuator/gap_wall", "/material/C/0" */
  const char *unit; /* in which results give it: "mm", "deg", "MPa", "kg/m3", "1" */
  double unit_si;   /* one of that unit in SI */
  size_t offset;    /* of the number, a double in SI, in struct job_spec */
};

enum { PARAMETERS_MAX = 40 };

/* What the result is differentiated by. */
struct sensitivity_spec {
  int count; /* 0: no derivatives */
  struct job_parameter parameter[PARAMETERS_MAX];
  bool midline; /* of the points of the midline, too */
};

enum { PLANES_MAX = 7 };

/* Rigid plane that the outer surface cannot pass; the body is on the side of the normal. */
struct plane_spec {
  double point[3];  /* m */
  double normal[3]; /* of any length */
};

struct metric_spec {
  double fit_from, fit_to; /* Pa: range of the straight-line fit (sensitivity, R2) */
  double cai_from, cai_to; /* Pa: range of the curvature adaptability index */
};

/* A case of solver/verify/cases.c. */
struct verify_spec {
  char name[64];
  int refinement; /* number of meshes, each finer than the one before */
};

/* ---- tables ------------------------------------------------------------------------------- */

/* A column of the job's table, in the unit that the job names. */
struct column_spec {
  char name[200];   /* in the table's header */
  char pointer[60]; /* of the name in the job */
  double si;        /* one of its unit in SI */
};

enum abscissa { ABSCISSA_STRAIN, ABSCISSA_STRETCH, ABSCISSA_EXTENSION };

enum { FIT_COEFFICIENTS_MAX = 6 };

/* A hyperelastic law and the stress-strain curve that it is fitted to. Coefficients are numbered
 * C1 .. C3 (Yeoh), mu (neo-Hooke), C10, C01 (Mooney-Rivlin), mu1 .. mun, alpha1 .. alphan (Ogden);
 * moduli in Pa. */
struct fit_spec {
  enum material_model model;
  int terms, count; /* of the law, and coefficients */
  enum abscissa abscissa;
  struct column_spec strain, stress;
  double gauge; /* length that the extension refers to, m; with ABSCISSA_EXTENSION */
  bool true_strain, true_stress;
  double from, to; /* engineering strains between which the curve is fitted; may be infinite */
  double lower[FIT_COEFFICIENTS_MAX], upper[FIT_COEFFICIENTS_MAX]; /* infinite: free */
  double density_kg_m3, bulk_ratio;
};

/* A measured response, to be compared with the computed one. */
struct measured_spec {
  struct column_spec pressure, angle;
  char metric[40]; /* key of the samples that the angle is compared with; "" without a curve */
};

/* The stretches of a material curve. */
struct material_curve_spec {
  double from, to;
  int points;
};

/* A model with guards and its input: solver/job/hlpv.h. */
struct hlpv_spec;

/* What an identification asks for: solver/job/identify.h. */
struct identify_spec;

/* A bistable bellows: solver/job/snap.h. */
struct snap_spec;

/* An object and the course of its grasp: solver/job/grasp.h. */
struct grasp_spec;

/* Only the members of its kind are filled: of a grasp job those of a response job that it has, and
 * grasp; of a verify job name, verify, timeout and hash; of a
 * study name, timeout, hash and document; of a fit name, fit, timeout, hash and document, and so of
 * an identification with identify; of a material curve name, material, curve and hash; of an hlpv
 * job name, hlpv, timeout and hash; of a snap job name, snap, timeout and hash. */
struct job_spec {
  enum job_kind kind;
  char name[200];
  enum actuator_family family;
  struct pneunet_given given; /* of FAMILY_PNEUNET: what pneunet is derived from */
  struct pneunet_spec pneunet;
  struct oblique_spec oblique; /* of FAMILY_OBLIQUE */
  struct material_spec material;
  struct load_spec load;
  struct mesh_spec mesh;
  struct metric_spec metrics;
  struct sensitivity_spec sensitivity;
  struct measured_spec measured;
  struct verify_spec verify;
  struct fit_spec fit;
  struct material_curve_spec curve;
  struct hlpv_spec *hlpv;         /* of an hlpv job, else NULL; owned and borrowed as document */
  struct identify_spec *identify; /* likewise of an identify job */
  struct snap_spec *snap;         /* of a snap job, else NULL; likewise */
  struct bistable_spec *bistable; /* of a bistable job, else NULL; likewise. Also of a snap
                                   * job with dynamics */
  struct grasp_spec *grasp;       /* of a grasp job, else NULL; likewise */
  bool contact;
  struct plane_spec plane[PLANES_MAX];
  int plane_count;
  bool whole_model; /* asked for even where half of it would do */
  bool half_model;  /* symmetric about y = 0 in geometry and load, and not whole_model */
  enum accuracy accuracy;
  bool error_estimate; /* solve the end of the load path on a finer mesh, too */
  bool few_files;      /* no VTU files and no deck */
  double timeout_s;    /* 0: none */
  double memory_bytes; /* limit of each process, 0: none of the job's own; of every kind */
  int priority;        /* -100 .. 100; of every kind */
  bool reuse;          /* the result of an equal job will do; of every kind */
  char hash[65];       /* SHA-256 of the canonical job text: sorted keys, defaults filled in, no
                        * name, labels and comments, nothing about the queue (the three members
                        * before); 64 hexadecimal digits */
  json_t *document; /* of a job whose data have no bound (tables, members of a study) the document
                     * with its defaults filled in, otherwise NULL; owned by the spec as read,
                     * borrowed by its copies */
};

/* What every reading of a job needs: unit database and schema. One reader may be used by several
 * threads at once. */
struct job_reader;

/* Creates a reader (some 10 ms) in *reader, owned by the caller. STATUS_IO when the unit database
 * cannot be read, STATUS_NO_MEMORY, STATUS_INTERNAL. */
enum status job_reader_create(struct job_reader **reader, struct error *error);
void job_reader_destroy(struct job_reader *reader);

/* Releases what a spec owns and clears it; for the spec that was read, not for its copies. One that
 * was not read, or not successfully, owns nothing. */
void job_spec_release(struct job_spec *spec);

/* job_spec_read with a reader that is kept for the next job. The caller releases *spec. */
enum status job_reader_read(const struct job_reader *reader, const char *text, size_t size,
                            struct job_spec *spec, struct error *error);

/* job_reader_read of a document that is no text yet: fills in its defaults in place. A study needs
 * no release of its members: they are checked and dropped (study_expand gives them). */
enum status job_reader_check(const struct job_reader *reader, json_t *document,
                             struct job_spec *spec, struct error *error);

/* Reads and checks a job document.
 * text: JSON of `size` bytes. On success fills *spec and returns STATUS_OK; otherwise fills
 * *error (pointer, line and column) and returns STATUS_SYNTAX, INVALID, GEOMETRY or TOO_LARGE;
 * or the failures of job_reader_create. On success the caller releases *spec. */
enum status job_spec_read(const char *text, size_t size, struct job_spec *spec,
                          struct error *error);

/* Name of a coefficient of the law that is fitted: "C1", "mu", "alpha2". Static storage. */
const char *fit_coefficient_name(const struct fit_spec *fit, int index);
/* Whether it is an exponent, a pure number, and no modulus. */
bool fit_coefficient_is_exponent(const struct fit_spec *fit, int index);

/* Initial shear modulus in Pa: neo-Hooke mu; Yeoh 2 c1; Mooney-Rivlin 2 (c1 + c2);
 * Ogden sum c_i alpha_i / 2. */
double material_shear_modulus(const struct material_spec *material);

#endif
