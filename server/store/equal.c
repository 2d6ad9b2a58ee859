#include "server/store/connection.h"
#include "server/store/sql.h"

enum status store_equal_job(struct store *store, const char *spec_hash, int64_t *id,
                            struct error *error) {
  sqlite3 *db = store_read_begin(store, error);
  sqlite3_stmt *statement;
  int row = 0;
  *id = 0;
  if (!db) {
    return error ? error->status : STATUS_IO;
  }
  enum status status = sql_prepare(db, &statement, error,
                                   "SELECT id FROM job WHERE spec_hash = ? "
                                   "ORDER BY state = 'succeeded' DESC, id DESC LIMIT 1",
                                   "t", spec_hash);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && row) {
    *id = sqlite3_column_int64(statement, 0);
  }
  sql_done(statement);
  store_read_end(store, db);
  return status;
}
