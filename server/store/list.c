#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/store/branch.h"
#include "server/store/connection.h"
#include "server/store/sql.h"

/* ---- cursors ----------------------------------------------------------------------------- */
/* "ID", "ID-MILLISECONDS" in the order of ends, "ID-STATE", "ID-NAME" with the name in
 * hexadecimal digits. */

static char *cursor_write(const struct list_query *query, const struct place *place) {
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  if (!out) {
    return NULL;
  }
  fprintf(out, "%lld", (long long)place->id);
  if (query->sort == LIST_BY_FINISHED) {
    fprintf(out, "-%lld", (long long)place->number);
  } else if (query->sort == LIST_BY_STATE) {
    fprintf(out, "-%s", place->text);
  } else if (query->sort == LIST_BY_NAME) {
    fputc('-', out);
    for (const char *at = place->text; *at; at++) {
      fprintf(out, "%02x", (unsigned)(unsigned char)*at);
    }
  }
  if (fclose(out) != 0) {
    free(text);
    text = NULL;
  }
  return text;
}

/* A whole number without sign at the start of the text; false when it is none. */
static bool number_read(const char **text, int64_t *value) {
  char *end;
  if (**text < '0' || **text > '9') {
    return false;
  }
  errno = 0;
  *value = strtoll(*text, &end, 10);
  *text = end;
  return errno == 0;
}

/* The name in hexadecimal digits as malloc'd text; NULL when it is malformed, or without memory. */
static char *name_read(const char *text) {
  size_t length = strlen(text);
  char *name = length % 2 == 0 && strspn(text, "0123456789abcdef") == length
                   ? calloc(length / 2 + 1, 1)
                   : NULL;
  for (size_t i = 0; name && i < length / 2; i++) {
    char digits[3] = {text[2 * i], text[2 * i + 1], 0};
    name[i] = (char)strtol(digits, NULL, 16);
  }
  return name;
}

/* Reads a cursor into *place, whose text is the caller's. */
static bool cursor_read(const struct list_query *query, struct place *place) {
  const char *rest = query->cursor;
  enum job_state state;
  *place = (struct place){0};
  if (!number_read(&rest, &place->id) || place->id == 0) {
    return false;
  }
  if (query->sort == LIST_BY_ID || query->sort == LIST_BY_CREATED) {
    place->text = *rest == '\0' ? strdup("") : NULL;
    return place->text != NULL;
  }
  if (*rest++ != '-') {
    return false;
  }
  if (query->sort == LIST_BY_NAME) {
    place->text = name_read(rest);
  } else if (query->sort == LIST_BY_STATE) {
    place->text = job_state_parse(rest, &state) ? strdup(rest) : NULL;
  } else if (number_read(&rest, &place->number) && *rest == '\0') {
    place->text = strdup("");
  }
  return place->text != NULL;
}

static enum status cursor_wrong(const struct list_query *query, struct error *error) {
  return error_set(error, STATUS_INVALID, NULL,
                   "cursor=%.60s is none of a list in this order: take \"next\" of the page before "
                   "as it is, with the same sort.",
                   query->cursor);
}

/* ---- a page ------------------------------------------------------------------------------ */

/* Reads the first jobs of the places; one place more tells that there is another page. */
static enum status page_read(sqlite3 *db, const struct list_query *query, struct places *places,
                             struct job_record *records, size_t *count, char **next,
                             struct error *error) {
  size_t limit = (size_t)query->limit;
  while (*count < limit && *count < places->count) {
    enum status status = store_record_read(db, places->list[*count].id, &records[*count], error);
    if (status != STATUS_OK) {
      return status;
    }
    ++*count;
  }
  if (places->count > limit || places->ended) {
    *next = cursor_write(query, places->count > limit ? &places->list[limit - 1] : &places->end);
    if (!*next) {
      return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a cursor.");
    }
  }
  return STATUS_OK;
}

enum status store_list(struct store *store, const struct list_query *query,
                       struct job_record **records, size_t *count, char **next,
                       struct error *error) {
  struct places places = {0};
  struct place after = {0};
  sqlite3 *db = NULL;
  enum status status = STATUS_OK;
  *count = 0;
  *next = NULL;
  *records = NULL;
  if (query->cursor && !cursor_read(query, &after)) {
    status = cursor_wrong(query, error);
    goto done;
  }
  *records = calloc((size_t)query->limit, sizeof **records);
  if (!*records) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a list.");
    goto done;
  }
  db = store_read_begin(store, error);
  if (!db) {
    status = error ? error->status : STATUS_IO;
    goto done;
  }
  status = branches_collect(db, query, query->cursor ? &after : NULL, (size_t)query->limit + 1,
                            &places, error);
  if (status == STATUS_OK) {
    status = page_read(db, query, &places, *records, count, next, error);
  }
done:
  if (db) {
    store_read_end(store, db);
  }
  places_clear(&places);
  free(after.text);
  if (status != STATUS_OK) {
    for (size_t i = 0; i < *count; i++) {
      job_record_clear(&(*records)[i]);
    }
    free(*records);
    free(*next);
    *records = NULL;
    *next = NULL;
    *count = 0;
  }
  return status;
}

enum status store_take_count(sqlite3_stmt *row, void *counts, struct error *error) {
  enum job_state state;
  (void)error;
  if (job_state_parse(sql_text(row, 0), &state)) {
    ((int64_t *)counts)[state] = sqlite3_column_int64(row, 1);
  }
  return STATUS_OK;
}

enum status store_counts(struct store *store, int64_t counts[JOB_STATE_COUNT],
                         struct error *error) {
  memset(counts, 0, JOB_STATE_COUNT * sizeof *counts);
  return store_each(store, error, store_take_count, counts, "SELECT state, jobs FROM job_count",
                    "");
}
