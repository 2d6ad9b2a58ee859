#include "server/store/branch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/store/sql.h"

/* LOOK_MAX: rows of a range that are looked through for jobs with several labels; about 1 ms. */
enum { SQL_SIZE = 4096, RARE = 1000, LOOK_MAX = 500 };

/* Where a range begins. */
enum start {
  START_NOWHERE, /* all of it comes before the place */
  START_FIRST,   /* all of it comes after the place */
  START_ID,      /* after the place's id: the range is in the order of ids */
  START_KEY,     /* after the place's key and id: START_TIE, then */
  START_TIE      /* at the place's key, after its id */
};

/* What is the same for all ranges of a page. */
struct branches {
  sqlite3 *db;
  const struct list_query *query;
  const struct place *after;
  size_t most;
  size_t label;             /* index of the label that leads, if there is one */
  sqlite3_stmt *cached[10]; /* by start and whether the range is in the order of ids */
  struct places *places;
};

int place_compare(const struct place *a, const struct place *b) {
  int order = strcmp(a->text, b->text);
  if (order == 0) {
    order = (a->number > b->number) - (a->number < b->number);
  }
  return order != 0 ? order : (a->id > b->id) - (a->id < b->id);
}

void places_clear(struct places *places) {
  for (size_t i = 0; i < places->count; i++) {
    free(places->list[i].text);
  }
  free(places->list);
  free(places->end.text);
  *places = (struct places){0};
}

static enum status places_add(struct places *places, int64_t id, int64_t number, const char *text,
                              struct error *error) {
  if (places->count == places->room) {
    size_t room = 2 * places->room + 64;
    struct place *grown = realloc(places->list, room * sizeof *grown);
    if (!grown) {
      return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a list.");
    }
    places->list = grown;
    places->room = room;
  }
  char *copy = strdup(text);
  if (!copy) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a list.");
  }
  places->list[places->count++] = (struct place){.id = id, .number = number, .text = copy};
  return STATUS_OK;
}

/* What comes after this place has not been looked at: of several such places the first counts. */
static enum status places_end(struct places *places, bool descending, int64_t id, int64_t number,
                              const char *text, struct error *error) {
  struct place end = {.id = id, .number = number, .text = strdup(text)};
  if (!end.text) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a list.");
  }
  int order = places->ended ? place_compare(&end, &places->end) : 0;
  if (!places->ended || (descending ? order > 0 : order < 0)) {
    free(places->end.text);
    places->end = end;
    places->ended = true;
  } else {
    free(end.text);
  }
  return STATUS_OK;
}

/* ---- one range --------------------------------------------------------------------------- */

/* Whether a range of the state is in the order of ids: where the order has nothing else, or the
 * same for all of the state. */
static bool by_id(const struct list_query *query, enum job_state state) {
  return query->sort == LIST_BY_ID || query->sort == LIST_BY_CREATED ||
         query->sort == LIST_BY_STATE ||
         (query->sort == LIST_BY_FINISHED && !job_state_terminal(state));
}

static enum start range_start(const struct branches *all, enum job_state state) {
  const struct place *after = all->after;
  if (!after) {
    return START_FIRST;
  }
  if (!by_id(all->query, state) && !(all->query->sort == LIST_BY_FINISHED && after->number == 0)) {
    return START_KEY;
  }
  int order = 0; /* of the range against the place */
  if (all->query->sort == LIST_BY_STATE) {
    order = strcmp(job_state_word(state), after->text);
  } else if (all->query->sort == LIST_BY_FINISHED) {
    order = job_state_terminal(state) - (after->number != 0);
  }
  order = all->query->descending ? -order : order;
  return order < 0 ? START_NOWHERE : order > 0 ? START_FIRST : START_ID;
}

/* The index of a range of the members of a study, or of jobs that belong to none; of each the
 * tables have their own. Members of a study are of one kind. */
static void range_index(const struct list_query *query, bool ids, char *text, size_t size) {
  bool single = query->study == LIST_STUDY_NONE;
  snprintf(text, size, " INDEXED BY job_%s_by%s%s", single ? "single" : "member",
           single && query->kind ? "_kind" : "",
           !ids                    ? query->sort == LIST_BY_NAME ? "_name" : "_finished"
           : single && query->kind ? ""
                                   : "_state");
}

/* Whether rows of a range have to be looked at one by one. */
static bool range_looks(const struct list_query *query) {
  return query->label_count > 1 || (query->label_count > 0 && query->study != LIST_STUDY_ANY);
}

/* The text of a range's query: id and key of its rows, and whether the other labels are there, too.
 * Parameters: 1, 2 label and value, 3 kind, 4 state, 5 key and 6 id of
 * the place, 7 how many, 8 the study; from 9 on the other labels. */
static void range_sql(const struct branches *all, enum start start, bool ids, char sql[SQL_SIZE]) {
  const struct list_query *query = all->query;
  bool labels = query->label_count > 0, names = query->sort == LIST_BY_NAME;
  const char *id = labels ? "job_id" : "id", *table = labels ? "job_label" : "job";
  const char *key = names ? labels ? "job_name" : "name" : "finished_ms";
  const char *sign = query->descending ? "<" : ">", *way = query->descending ? "DESC" : "ASC";
  size_t used = 0;
#define ADD(...) used += (size_t)snprintf(sql + used, SQL_SIZE - used, __VA_ARGS__)
  char index[80] = "";
  if (query->study != LIST_STUDY_ANY && !labels) {
    range_index(query, ids, index, sizeof index);
  }
  ADD("SELECT %s, %s, 1", id, ids ? "0" : key);
  for (size_t i = 0, parameter = 9; i < query->label_count; i++) {
    if (i != all->label) {
      ADD(" AND EXISTS (SELECT 1 FROM job_label AS l WHERE l.job_id = j.job_id AND l.name = ?%zu "
          "AND l.value = ?%zu)",
          parameter, parameter + 1);
      parameter += 2;
    }
  }
  if (query->study != LIST_STUDY_ANY && labels) {
    ADD(" AND (SELECT study_id FROM job WHERE id = j.job_id) IS nullif(?8, %d)", LIST_STUDY_NONE);
  }
  ADD(" FROM %s AS j%s WHERE j.state = ?4", table, index);
  if (query->study != LIST_STUDY_ANY && !labels) {
    ADD(query->study == LIST_STUDY_NONE ? " AND j.study_id IS NULL" : " AND j.study_id = ?8");
  }
  if (labels) {
    ADD(" AND j.name = ?1 AND j.value = ?2");
  }
  if (labels || query->kind) {
    ADD(" AND j.kind = ?3");
  }
  if (start == START_ID) {
    ADD(" AND j.%s %s ?6", id, sign);
  } else if (start == START_KEY) {
    ADD(" AND j.%s %s ?5", key, sign);
  } else if (start == START_TIE) {
    ADD(" AND j.%s = ?5 AND j.%s %s ?6", key, id, sign);
  }
  if (!ids) {
    /* The indexes of ends leave out jobs without one. */
    ADD("%s ORDER BY j.%s %s, j.%s %s LIMIT ?7", names ? "" : " AND j.finished_ms IS NOT NULL", key,
        way, id, way);
  } else {
    ADD(" ORDER BY j.%s %s LIMIT ?7", id, way);
  }
#undef ADD
}

static void range_bind(const struct branches *all, sqlite3_stmt *statement, const char *kind,
                       enum job_state state) {
  const struct list_query *query = all->query;
  bool names = query->sort == LIST_BY_NAME;
  int parameter = 9, count = sqlite3_bind_parameter_count(statement);
  if (query->label_count > 0) {
    sqlite3_bind_text(statement, 1, query->labels[all->label].name, -1, SQLITE_STATIC);
    sqlite3_bind_text(statement, 2, query->labels[all->label].value, -1, SQLITE_STATIC);
  }
  sqlite3_bind_text(statement, 3, kind, -1, SQLITE_STATIC);
  sqlite3_bind_text(statement, 4, job_state_word(state), -1, SQLITE_STATIC);
  if (all->after && names) {
    sqlite3_bind_text(statement, 5, all->after->text, -1, SQLITE_STATIC);
  } else if (all->after) {
    sqlite3_bind_int64(statement, 5, all->after->number);
  }
  sqlite3_bind_int64(statement, 6, all->after ? all->after->id : 0);
  sqlite3_bind_int64(statement, 7, range_looks(query) ? LOOK_MAX : (int64_t)all->most);
  sqlite3_bind_int64(statement, 8, query->study);
  for (size_t i = 0; i < query->label_count && parameter + 1 <= count; i++) {
    if (i != all->label) {
      sqlite3_bind_text(statement, parameter++, query->labels[i].name, -1, SQLITE_STATIC);
      sqlite3_bind_text(statement, parameter++, query->labels[i].value, -1, SQLITE_STATIC);
    }
  }
}

static enum status range_read(struct branches *all, const char *kind, enum job_state state,
                              enum start start, struct error *error) {
  bool ids = by_id(all->query, state), names = all->query->sort == LIST_BY_NAME;
  sqlite3_stmt **statement = &all->cached[2 * start + ids];
  enum status status = STATUS_OK;
  if (!*statement) {
    char sql[SQL_SIZE];
    range_sql(all, start, ids, sql);
    status = sql_prepare(all->db, statement, error, sql, "");
  }
  if (status != STATUS_OK) {
    return status;
  }
  int row = 0, looked = 0;
  size_t wanted = all->places->count + all->most;
  const char *word = all->query->sort == LIST_BY_STATE ? job_state_word(state) : "";
  range_bind(all, *statement, kind, state);
  while (all->places->count < wanted && (status = sql_step(*statement, &row, error)) == STATUS_OK &&
         row) {
    int64_t id = sqlite3_column_int64(*statement, 0);
    int64_t number = names ? 0 : sqlite3_column_int64(*statement, 1);
    const char *text = names ? sql_text(*statement, 1) : word;
    if (sqlite3_column_int(*statement, 2)) {
      status = places_add(all->places, id, number, text, error);
    }
    if (status == STATUS_OK && ++looked == LOOK_MAX) {
      status = places_end(all->places, all->query->descending, id, number, text, error);
    }
    if (status != STATUS_OK) {
      break;
    }
  }
  sql_done(*statement);
  return status;
}

/* Equals of the place come from a range of their own: however many there are, none is passed over.
 */
static enum status range_collect(struct branches *all, const char *kind, enum job_state state,
                                 struct error *error) {
  enum start start = range_start(all, state);
  enum status status = STATUS_OK;
  if (start == START_KEY) {
    status = range_read(all, kind, state, START_TIE, error);
  }
  if (status == STATUS_OK && start != START_NOWHERE) {
    status = range_read(all, kind, state, start, error);
  }
  return status;
}

/* All states that the query asks for. */
static enum status states_collect(struct branches *all, const char *kind, struct error *error) {
  bool any = true;
  for (int i = 0; i < JOB_STATE_COUNT; i++) {
    any = any && !all->query->states[i];
  }
  enum status status = STATUS_OK;
  for (int i = 0; i < JOB_STATE_COUNT && status == STATUS_OK; i++) {
    if (any || all->query->states[i]) {
      status = range_collect(all, kind, (enum job_state)i, error);
    }
  }
  return status;
}

/* ---- labels ------------------------------------------------------------------------------ */

/* Lets the rarest label lead: counted up to where it does not matter any more. */
static enum status label_choose(struct branches *all, struct error *error) {
  const struct list_query *query = all->query;
  int64_t least = INT64_MAX;
  for (size_t i = 0; query->label_count > 1 && i < query->label_count; i++) {
    sqlite3_stmt *statement;
    int row = 0;
    enum status status =
        sql_prepare(all->db, &statement, error,
                    "SELECT count(*) FROM (SELECT 1 FROM job_label WHERE name = ? AND value = ? "
                    "LIMIT ?)",
                    "tti", query->labels[i].name, query->labels[i].value, (int64_t)RARE);
    if (status == STATUS_OK) {
      status = sql_step(statement, &row, error);
    }
    if (status == STATUS_OK && sqlite3_column_int64(statement, 0) < least) {
      least = sqlite3_column_int64(statement, 0);
      all->label = i;
    }
    sql_done(statement);
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

/* Goes through the kinds that jobs with the label have: each is found by one step in the index. */
static enum status kinds_collect(struct branches *all, struct error *error) {
  char kind[64] = "";
  for (;;) {
    sqlite3_stmt *statement;
    int row = 0;
    enum status status = sql_prepare(
        all->db, &statement, error,
        "SELECT min(kind) FROM job_label WHERE name = ? AND value = ? AND kind > ?", "ttt",
        all->query->labels[all->label].name, all->query->labels[all->label].value, kind);
    if (status == STATUS_OK) {
      status = sql_step(statement, &row, error);
    }
    char next[sizeof kind] = "";
    if (status == STATUS_OK) {
      snprintf(next, sizeof next, "%s", sql_text(statement, 0));
    }
    sql_done(statement);
    if (status != STATUS_OK || strcmp(next, kind) <= 0) {
      return status;
    }
    memcpy(kind, next, sizeof kind);
    status = states_collect(all, kind, error);
    if (status != STATUS_OK) {
      return status;
    }
  }
}

/* ---- all of them ------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b) {
  return place_compare(a, b);
}

static int descending(const void *a, const void *b) {
  return place_compare(b, a);
}

/* Sorts the places, and leaves out those of which it is not known whether they are the next. */
static void places_sort(struct places *places, bool down) {
  if (places->count > 1) {
    qsort(places->list, places->count, sizeof *places->list, down ? descending : ascending);
  }
  while (places->ended && places->count > 0) {
    struct place *last = &places->list[places->count - 1];
    int order = place_compare(last, &places->end);
    if (down ? order >= 0 : order <= 0) {
      break;
    }
    free(last->text);
    places->count--;
  }
}

enum status branches_collect(sqlite3 *db, const struct list_query *query, const struct place *after,
                             size_t most, struct places *places, struct error *error) {
  struct branches all = {.db = db, .query = query, .after = after, .most = most, .places = places};
  enum status status = STATUS_OK;
  if (query->label_count > 0) {
    status = label_choose(&all, error);
  }
  if (status == STATUS_OK && query->label_count > 0 && !query->kind) {
    status = kinds_collect(&all, error);
  } else if (status == STATUS_OK) {
    status = states_collect(&all, query->kind, error);
  }
  for (size_t i = 0; i < sizeof all.cached / sizeof *all.cached; i++) {
    sqlite3_finalize(all.cached[i]);
  }
  places_sort(places, query->descending);
  return status;
}
