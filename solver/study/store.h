/* The files of a study's members. */
#ifndef PNEULAB_STUDY_STORE_H
#define PNEULAB_STUDY_STORE_H

#include <jansson.h>
#include "solver/job/study.h"

/* Names end in: */
enum member_file { MEMBER_JOB, MEMBER_PART, MEMBER_LOG, MEMBER_RESULT, MEMBER_FILES };

struct member_store {
  char *directory;
  bool temporary; /* goes with everything in it */
  int lock;       /* keeps other studies out of a folder that stays, or -1 */
};

/* Opens DIR/members, made when missing, or a temporary folder for NULL. One study at a time has
 * the use of a folder: for a second one it is STATUS_IO. The caller calls
 * member_store_close in either case. STATUS_OK, STATUS_IO, STATUS_NO_MEMORY. */
enum status member_store_open(const char *out_dir, struct member_store *store, struct error *error);

/* Ends the use; a temporary folder goes with the files of the study's members. */
void member_store_close(struct member_store *store, const struct study *study);

/* The path of a member's file; the caller frees it. NULL when memory runs out. */
char *member_store_path(const struct member_store *store, const struct study_member *member,
                        enum member_file file);

/* Writes the member's job. STATUS_OK or STATUS_IO. */
enum status member_store_job(const struct member_store *store, const struct study_member *member,
                             struct error *error);

/* Writes what a process would have printed: a result, or an error. STATUS_OK or STATUS_IO. */
enum status member_store_write(const struct member_store *store, const struct study_member *member,
                               const json_t *document, struct error *error);

/* What the member's process has printed so far becomes its result. STATUS_OK or STATUS_IO. */
enum status member_store_keep(const struct member_store *store, const struct study_member *member,
                              struct error *error);

/* The member's result, a new reference: NULL unless there is one of this very job and this version
 * of the solver that was neither cancelled nor short of memory. */
json_t *member_store_result(const struct member_store *store, const struct study_member *member);

/* The error that a process without result has printed, as "code" and "message", or NULL. A new
 * reference. */
json_t *member_store_error(const struct member_store *store, const struct study_member *member);

/* Removes a file of the member, if it is there. */
void member_store_remove(const struct member_store *store, const struct study_member *member,
                         enum member_file file);

#endif
