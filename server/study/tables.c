#include "server/study/tables.h"

#include <pthread.h>
#include <stdlib.h>

#include "server/store/study.h"
#include "server/study/designs.h"

enum { KEPT = 4 };

/* One table; it lives as long as it is kept or used. */
struct entry {
  struct entry *next;
  struct study_table *table;
  uint64_t stamp, used; /* when, by a counter */
  char *columns;        /* as text, once somebody has asked for it */
  size_t columns_size;
  unsigned uses;
  bool kept;
};

struct tables {
  struct store *store;
  pthread_mutex_t mutex; /* guards everything below */
  struct entry *first;
  uint64_t clock;
};

enum status tables_create(struct store *store, struct tables **tables, struct error *error) {
  struct tables *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for tables of studies.");
  }
  made->store = store;
  pthread_mutex_init(&made->mutex, NULL);
  *tables = made;
  return STATUS_OK;
}

static void entry_destroy(struct entry *entry) {
  study_table_destroy(entry->table);
  free(entry->columns);
  free(entry);
}

void tables_destroy(struct tables *tables) {
  struct entry *next;
  if (!tables) {
    return;
  }
  for (struct entry *entry = tables->first; entry; entry = next) {
    next = entry->next;
    entry_destroy(entry);
  }
  pthread_mutex_destroy(&tables->mutex);
  free(tables);
}

/* What a table of the study is good for: that of a finished one as long as it has these members,
 * that of another as long as nothing is written. */
static enum status stamp_of(struct store *store, int64_t study_id, uint64_t *stamp,
                            struct error *error) {
  struct study_stamp found;
  uint64_t version = store_version(store);
  enum status status = store_study_stamp(store, study_id, &found, error);
  if (status == STATUS_OK) {
    *stamp = found.terminal ? (uint64_t)found.finished_ms * 16384 + (uint64_t)found.members * 2
                            : version * 2 + 1;
  }
  return status;
}

/* Forgets tables that are neither kept nor used, and of those that are kept all but the latest.
 * Under the mutex. */
static void tables_trim(struct tables *tables) {
  for (;;) {
    struct entry *oldest = NULL;
    size_t kept = 0;
    for (struct entry *entry = tables->first; entry; entry = entry->next) {
      kept += entry->kept;
      if (entry->kept && (!oldest || entry->used < oldest->used)) {
        oldest = entry;
      }
    }
    if (kept <= KEPT) {
      break;
    }
    oldest->kept = false;
  }
  for (struct entry **at = &tables->first; *at;) {
    struct entry *entry = *at;
    if (entry->kept || entry->uses > 0) {
      at = &entry->next;
    } else {
      *at = entry->next;
      entry_destroy(entry);
    }
  }
}

static const struct study_table *entry_use(struct tables *tables, struct entry *entry) {
  entry->uses++;
  entry->used = ++tables->clock;
  return entry->table;
}

/* The kept table, if it still holds; one that does not is forgotten. */
static const struct study_table *table_find(struct tables *tables, int64_t study_id,
                                            uint64_t stamp) {
  const struct study_table *table = NULL;
  pthread_mutex_lock(&tables->mutex);
  for (struct entry *entry = tables->first; entry && !table; entry = entry->next) {
    if (entry->table->study_id == study_id && entry->kept && entry->stamp == stamp) {
      table = entry_use(tables, entry);
    } else if (entry->table->study_id == study_id) {
      entry->kept = false;
    }
  }
  tables_trim(tables);
  pthread_mutex_unlock(&tables->mutex);
  return table;
}

enum status tables_use(struct tables *tables, int64_t study_id, const struct study_table **table,
                       uint64_t *stamp, struct error *error) {
  uint64_t now = 0;
  enum status status = stamp_of(tables->store, study_id, &now, error);
  if (stamp) {
    *stamp = now;
  }
  *table = status == STATUS_OK ? table_find(tables, study_id, now) : NULL;
  if (status != STATUS_OK || *table) {
    return status;
  }
  struct entry *entry = calloc(1, sizeof *entry);
  if (!entry) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the table of a study.");
  }
  status = study_table_read(tables->store, study_id, &entry->table, error);
  if (status != STATUS_OK) {
    free(entry);
    return status;
  }
  entry->stamp = now;
  entry->kept = true;
  pthread_mutex_lock(&tables->mutex);
  entry->next = tables->first;
  tables->first = entry;
  *table = entry_use(tables, entry);
  tables_trim(tables);
  pthread_mutex_unlock(&tables->mutex);
  return STATUS_OK;
}

const char *tables_columns(struct tables *tables, const struct study_table *table, size_t *size) {
  struct entry *entry;
  pthread_mutex_lock(&tables->mutex);
  for (entry = tables->first; entry && entry->table != table; entry = entry->next) {
  }
  bool made = entry && entry->columns;
  pthread_mutex_unlock(&tables->mutex);
  if (!entry) {
    return NULL;
  }
  size_t length = 0;
  char *text = made ? NULL : designs_columns(table, &length);
  pthread_mutex_lock(&tables->mutex);
  if (text && !entry->columns) { /* nobody was quicker */
    entry->columns = text;
    entry->columns_size = length;
    text = NULL;
  }
  const char *columns = entry->columns;
  *size = entry->columns_size;
  pthread_mutex_unlock(&tables->mutex);
  free(text);
  return columns;
}

void tables_release(struct tables *tables, const struct study_table *table) {
  pthread_mutex_lock(&tables->mutex);
  for (struct entry *entry = tables->first; entry; entry = entry->next) {
    entry->uses -= entry->table == table;
  }
  tables_trim(tables);
  pthread_mutex_unlock(&tables->mutex);
}
