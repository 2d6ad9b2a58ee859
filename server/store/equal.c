#include "server/store/connection.h"
#include "server/store/sql.h"

enum status store_equal_job(struct store *store, const char *spec_hash, int64_t *id,
                            struct error *error) {
  *id = 0;
  return store_each(store, error, sql_take_integer, id,
                    "SELECT id FROM job WHERE spec_hash = ? "
                    "ORDER BY state = 'succeeded' DESC, id DESC LIMIT 1",
                    "t", spec_hash);
}
