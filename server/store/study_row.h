/* Inside the store: what studies share with other jobs. */
#ifndef PNEULAB_STORE_STUDY_ROW_H
#define PNEULAB_STORE_STUDY_ROW_H

#include <sqlite3.h>

#include "server/store/store.h"

/* STATUS_CONFLICT with the sentence for a study that has to end first. */
enum status study_live(int64_t id, enum job_state state, struct error *error);

/* Deletes a terminal job with its result. In a write transaction. */
enum status job_rows_delete(sqlite3 *db, int64_t id, struct error *error);

/* Drops the view of a study, if there is one. In a write transaction. */
enum status study_view_drop(sqlite3 *db, int64_t id, struct error *error);

/* Whose job it is: of a member the study and its state, else *study_id is 0; *study: the job is one
 * itself. STATUS_NOT_FOUND. */
enum status study_of(sqlite3 *db, int64_t id, bool *study, int64_t *study_id,
                     enum job_state *study_state, struct error *error);

/* Whether a study has members that have not ended. */
enum status study_has_live(sqlite3 *db, int64_t id, bool *live, struct error *error);

#endif
