/* A study as a table of text (RFC 4180): lines end in CR LF, the first one has the names. */
#ifndef PNEULAB_STUDY_EXPORT_H
#define PNEULAB_STUDY_EXPORT_H

#include "server/study/criteria.h"

/* Columns member, job, state, reason, name, then the parameters by their pointers with the unit in
 * brackets, "/actuator/side_wall [mm]", then the metrics. A row a member; nothing stands for a
 * value that there is not. *text is malloc'd. STATUS_NO_MEMORY. */
enum status export_csv(const struct study_table *table, char **text, size_t *size,
                       struct error *error);

/* As trials_dataframe() of Optuna gives it, without the index: number, value (or values_0,
 * values_1,
 * ... of several objectives), datetime_start, datetime_complete, duration, params_POINTER,
 * user_attrs_METRIC, user_attrs_job, user_attrs_name, user_attrs_reason, state (COMPLETE, FAIL,
 * RUNNING, WAITING). Times are UTC. *text is malloc'd. STATUS_NO_MEMORY, and failures of the
 * database. */
enum status export_optuna(struct store *store, const struct study_table *table,
                          const struct criterion *objectives, size_t count, char **text,
                          size_t *size, struct error *error);

#endif
