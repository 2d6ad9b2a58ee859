/* The members of a study: the jobs that its base and its sampling come to. */
#ifndef PNEULAB_JOB_STUDY_H
#define PNEULAB_JOB_STUDY_H

#include <jansson.h>
#include "solver/job/spec.h"

/* Most members: of jobs that take a process each, and of light ones (see struct study). */
enum { STUDY_MEMBERS_MAX = 1000, STUDY_LIGHT_MAX = 10000, STATIONS_MAX = 50 };

/* Most text that the members of a study may have together, in bytes; of light ones, whose documents
 * are not held at the same time; and most samples of motions that a study may keep. */
enum { STUDY_TEXT_MAX = 16 << 20, STUDY_LIGHT_TEXT_MAX = 64 << 20, STUDY_SAMPLES_MAX = 100000 };

/* One member. Members with equal hashes are the same body under the same load; so are, but for the
 * sign of what lies across the body, those of which one has the other's mirrored hash. */
struct study_member {
  json_t *document; /* the job, defaults filled in; NULL unless documents are kept */
  json_t *values;   /* object: pointer -> value as the study gives it */
  json_t *labels;   /* of the design, or an empty object */
  char name[200];
  char hash[65];
  char mirrored_hash[65]; /* of the job mirrored about y = 0; "" when it has no mirror image */
  double timeout_s;       /* of the member's own job */
  int same_as;            /* first member with the same hash, or -1 */
  int mirror_of;          /* first member that is its mirror image, -1 for none or with same_as */
};

/* How members are ranked. */
struct study_ranking {
  bool asked;
  int station_count;
  double station[STATIONS_MAX];      /* m, arc length of the undeformed bottom centreline */
  double bending, slope, deflection; /* weights, of sum 1 */
  double mean_weight;
  bool by_station; /* extremes are those of the station, not of all stations */
};

struct study {
  struct study_member *member;
  size_t count;
  bool light;        /* members take milliseconds: many are solved in one process */
  bool keep_samples; /* of each member, in the study's result, beside its metrics */
  size_t distinct;   /* members but for repetitions and mirror images */
  struct study_ranking ranking;
};

/* Whether the members of a study will be light, from its document. */
bool study_has_light_members(const json_t *document);

/* Expands a study whose document has passed the schema and has its defaults filled in, and checks
 * every member as the job that it is; `keep` keeps their documents. *study is owned by the caller,
 * who calls study_release in either case. STATUS_OK; STATUS_INVALID or STATUS_GEOMETRY with the
 * pointer to the value of the study that has to change; STATUS_TOO_LARGE; STATUS_NO_MEMORY. */
enum status study_expand(const struct job_reader *reader, const json_t *document, bool keep,
                         struct study *study, struct error *error);
void study_release(struct study *study);

/* Reads the member `index` of a study that study_expand has accepted, as a job of its own; the
 * caller releases *spec. *built (unless NULL): its document with defaults, a new reference. The
 * failures of job_reader_check. */
enum status study_read_member(const struct job_reader *reader, const json_t *document, size_t index,
                              json_t **built, struct job_spec *spec, struct error *error);

/* Writes `value` (NULL or null: takes the key away) into `document` at `pointer` (RFC 6901).
 * Objects on the way are made when they are missing. STATUS_INVALID, with the pointer of `error`
 * left empty, for a pointer that is malformed or leads nowhere; STATUS_NO_MEMORY. */
enum status study_set(json_t *document, const char *pointer, json_t *value, struct error *error);

/* The mirror image of a response job about y = 0, a new reference: lateral tapers and the pressures
 * of left and right row change sides, components across the body their sign. NULL when there is
 * none, because the job asks for derivatives, or memory runs out. */
json_t *job_mirror(const json_t *document);

#endif
