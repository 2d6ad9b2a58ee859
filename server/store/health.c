#include "server/base/clock.h"
#include "server/store/connection.h"
#include "server/store/sql.h"

bool store_failed(enum status status) {
  return status == STATUS_IO || status == STATUS_NO_SPACE || status == STATUS_DAMAGED ||
         status == STATUS_BUSY || status == STATUS_NO_MEMORY;
}

void store_health_note(struct store *store, enum status status, bool wrote, const char *reason) {
  bool bad = status == STATUS_IO || status == STATUS_NO_SPACE || status == STATUS_DAMAGED;
  pthread_mutex_lock(&store->health_mutex);
  if (bad) {
    error_set(&store->health, status, NULL, "The database cannot be written: %s.", reason);
  } else if (status == STATUS_OK && wrote) {
    store->health = (struct error){.status = STATUS_OK};
  }
  pthread_mutex_unlock(&store->health_mutex);
}

enum status store_health(struct store *store, struct error *error) {
  pthread_mutex_lock(&store->health_mutex);
  enum status status = store->health.status;
  if (status != STATUS_OK && error) {
    *error = store->health;
  }
  pthread_mutex_unlock(&store->health_mutex);
  return status;
}

enum status store_probe(struct store *store, struct error *error) {
  enum status status = store_write_begin(store, error);
  if (status == STATUS_OK) {
    status = sql_run(store->writer, error, "INSERT OR REPLACE INTO write_probe VALUES (1, ?)", "i",
                     clock_unix_ms());
    status = store_write_end(store, status, error);
  }
  return status;
}
