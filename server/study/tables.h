/* Tables of studies, kept for the next request: reading one of 10,000 members takes about 100 ms.
 * That of a finished study holds until its members change, that of another until the database
 * does. */
#ifndef PNEULAB_STUDY_TABLES_H
#define PNEULAB_STUDY_TABLES_H

#include "server/study/table.h"

struct tables;

/* The caller owns *tables; the store outlives it. */
enum status tables_create(struct store *store, struct tables **tables, struct error *error);
void tables_destroy(struct tables *tables);

/* The table of a study as it is now, for use until tables_release; *stamp (unless NULL) is another
 * one when the table is. The failures of study_table_read. From any thread. */
enum status tables_use(struct tables *tables, int64_t study_id, const struct study_table **table,
                       uint64_t *stamp, struct error *error);

/* designs_columns of a table in use, kept with it: borrowed until tables_release. NULL without
 * memory. */
const char *tables_columns(struct tables *tables, const struct study_table *table, size_t *size);

void tables_release(struct tables *tables, const struct study_table *table);

#endif
