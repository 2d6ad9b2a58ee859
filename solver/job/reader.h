/* Inside of the job reader: typed access to members of a document that the schema has accepted. */
#ifndef PNEULAB_JOB_READER_H
#define PNEULAB_JOB_READER_H

#include <jansson.h>
#include "solver/base/units.h"
#include "solver/job/json.h"
#include "solver/job/spec.h"

/* Smallest extent of a cavity in any direction, in m: thinner ones are taken for mistakes. */
#define CAVITY_MINIMUM 1e-4

struct reader {
  const struct units *units;
  struct error *error;
};

/* The unit database of a job reader. */
const struct units *job_reader_units(const struct job_reader *reader);

/* The quantity `text` in SI, `unit` as in the schema. */
double reader_quantity(const struct reader *reader, const json_t *text, const char *unit);

/* The quantity under `key` in SI, or `otherwise` when it is absent. */
double reader_member(const struct reader *reader, const json_t *object, const char *key,
                     const char *unit, double otherwise);

/* The whole number under `key`, or `otherwise` when it is absent. */
int reader_count(const json_t *object, const char *key, int otherwise);

/* Copies a string value into a field, cut at whole characters; NULL counts as "". */
void reader_copy(char *field, size_t size, const char *text);

/* Each fills its part of the spec from the actuator or material value. STATUS_OK, or
 * STATUS_INVALID or STATUS_GEOMETRY with the pointer to the member that has to change. */
enum status reader_pneunet(const struct reader *reader, const json_t *actuator,
                           struct pneunet_given *given, struct pneunet_spec *spec);
enum status reader_oblique(const struct reader *reader, const json_t *actuator,
                           struct oblique_spec *spec);
enum status reader_material(const struct reader *reader, const json_t *material,
                            struct material_spec *spec);

/* The load of a body of `family`. STATUS_OK, or STATUS_INVALID for pressures that it does not
 * have. */
enum status reader_load(const struct reader *reader, const json_t *load,
                        enum actuator_family family, struct load_spec *spec);

/* Fills *spec from the member `key` of the object `columns`, at `pointer` in the job: the name of a
 * column and its unit, which has the dimension of `unit`. `example` is a list of such units, for
 * errors. STATUS_OK, or STATUS_INVALID for another unit. */
enum status reader_column(const struct reader *reader, const json_t *columns, const char *pointer,
                          const char *key, const char *unit, const char *example,
                          struct column_spec *spec);

/* Fills spec->measured from the document, and checks the data; the load has been read. STATUS_OK,
 * or STATUS_INVALID, TOO_LARGE or NO_MEMORY. */
enum status reader_measured(const struct reader *reader, const json_t *document,
                            struct job_spec *spec);

/* Each fills its part of the spec from the document of its kind, and checks the data. STATUS_OK,
 * or STATUS_INVALID, TOO_LARGE or NO_MEMORY. */
enum status reader_fit(const struct reader *reader, const json_t *document, struct job_spec *spec);
enum status reader_material_curve(const struct reader *reader, const json_t *document,
                                  struct job_spec *spec);

/* Fills spec->sensitivity from the value of the key (NULL: no derivatives); the rest of the spec
 * has been read. STATUS_OK, or STATUS_INVALID for a pointer that names no parameter. */
enum status reader_sensitivity(const struct reader *reader, const json_t *value,
                               struct job_spec *spec);

/* Whether half of the body is to be solved: body and loads are symmetric about y = 0, and the job
 * does not ask for the whole. */
bool reader_half_model(const struct job_spec *spec);

/* Whether a body of these dimensions can exist. STATUS_OK, or STATUS_GEOMETRY with the pointer
 * to the dimension that has to change, the reason and the limit. */
enum status pneunet_check(const struct pneunet_spec *spec, struct error *error);

/* As pneunet_check, for a body with oblique chambers. chambers_given: the job says how many;
 * otherwise as many as fit are counted into spec->chamber_count. Derives spec->end, which must hold
 * the least one. */
enum status oblique_fit(bool chambers_given, struct oblique_spec *spec, struct error *error);

/* Largest angle to the cross-section, rad. */
#define OBLIQUE_ANGLE_MAX (80.0 / 180.0 * 3.14159265358979323846)

/* The part of pneunet_check that is about the suckers. */
enum status pneunet_check_suckers(const struct pneunet_spec *spec, struct error *error);

/* Fills name, timeout and hlpv of the job, which its release frees, also after a failure.
 * STATUS_OK, STATUS_INVALID or TOO_LARGE with the pointer to the member that has to change,
 * STATUS_NO_MEMORY. */
enum status reader_hlpv(const struct reader *reader, const json_t *document, struct job_spec *job);

struct hlpv_input;

/* Fills *input from the set-point profile in `value`, at `pointer` in the job. The caller releases
 * it, also after a failure. STATUS_OK, INVALID, TOO_LARGE or NO_MEMORY. */
enum status reader_set_point(const struct reader *reader, const json_t *value, const char *pointer,
                             struct hlpv_input *input);

/* The same for an elongation, which is in no table. */
enum status reader_reference(const struct reader *reader, const json_t *value, const char *pointer,
                             struct hlpv_input *input);

/* Whether a motion of `end` seconds, sampled at `rate` in Hz from 0 on, has at most `most` samples;
 * else STATUS_INVALID at /sample_rate with a rate that keeps to it. */
enum status reader_check_samples(const struct reader *reader, double end, double rate, int most);

struct hlpv_spec;

/* Fills spec->control from the value of the key, and spec->input with what stands for it at the
 * start; the model has been read, and spec is released as reader_hlpv says. STATUS_OK, INVALID or
 * NO_MEMORY. */
enum status reader_hlpv_control(const struct reader *reader, const json_t *value,
                                struct hlpv_spec *spec);

/* Fills name, timeout and snap of the job, as reader_hlpv does. Also STATUS_GEOMETRY. */
enum status reader_snap(const struct reader *reader, const json_t *document, struct job_spec *job);

/* Fills grasp of the job, as reader_hlpv does, after everything else has been read as in a response
 * job. Also STATUS_GEOMETRY. */
enum status reader_grasp(const struct reader *reader, const json_t *document, struct job_spec *job);

struct grasp_pull;

/* Fills *pull from the value of its key (NULL: there is none). STATUS_OK or INVALID. */
enum status reader_grasp_pull(const struct reader *reader, const json_t *value,
                              struct grasp_pull *pull);

/* Whether object and course of the grasp, which has been read, suit each other: what a free object
 * needs, and what it excludes. STATUS_OK or INVALID. */
enum status reader_grasp_check(const struct reader *reader, const json_t *document,
                               const struct job_spec *job);

/* Three lengths, m. */
void reader_vector(const struct reader *reader, const json_t *value, double out[3]);

/* A direction, made 1 long. STATUS_OK, or STATUS_INVALID at `pointer` for one without length;
 * `what` is its name in the error. */
enum status reader_direction(const struct reader *reader, const json_t *value, const char *pointer,
                             const char *what, double out[3]);

/* As reader_hlpv, for name, timeout and identify; checks the data. */
enum status reader_identify(const struct reader *reader, const json_t *document,
                            struct job_spec *job);

/* Fills name, timeout and bistable (and, of a job with one, snap) of the job, as reader_hlpv does.
 */
enum status reader_bistable(const struct reader *reader, const json_t *document,
                            struct job_spec *job);

/* Fills the bistable part of a snap job that asks for "dynamics" (`value`, not NULL); its snap part
 * has been read. STATUS_OK, INVALID or NO_MEMORY. */
enum status reader_snap_dynamics(const struct reader *reader, const json_t *value,
                                 struct job_spec *job);

struct supply_spec;

/* Fills *supply from a value at `pointer`. STATUS_OK or INVALID. */
enum status reader_pneumatics(const struct reader *reader, const json_t *value, const char *pointer,
                              struct supply_spec *supply);

struct hlpv_mode;

/* Fills the stiffness of a mode, and with a slope its rest, from the states of rest in `value`, at
 * `pointer` in the job, which is as before afterwards. spec: with gamma and rest length. per: unit
 * of the set-point in Pa. The factor "times" does not count for the rest. STATUS_OK or INVALID. */
enum status reader_hlpv_stiffness(const struct reader *reader, const json_t *value,
                                  const struct hlpv_spec *spec, struct json_pointer *pointer,
                                  double per, struct hlpv_mode *mode);

/* SHA-256 of the canonical text of the document (sorted keys, no spaces, whole reals as integers)
 * without name, labels, comments and what is about the queue (memory, priority, reuse), as 64
 * hexadecimal digits. STATUS_OK or STATUS_NO_MEMORY. */
enum status job_hash(const json_t *document, char hash[65], struct error *error);

#endif
