#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/http/handlers.h"
#include "server/http/study_table.h"
#include "server/study/export.h"

/* The objectives of the query, else the first metric. */
static enum status read_objectives(const struct request *request, const struct study_table *table,
                                   struct criterion objectives[CRITERIA_MAX], size_t *count,
                                   struct error *error) {
  const char *text = url_query(&request->url, "objectives");
  if (text) {
    return criteria_read(table, text, objectives, count, error);
  }
  *count = table->metrics > 0;
  objectives[0] = (struct criterion){.metric = 0, .number = NAN};
  return STATUS_OK;
}

void study_export(struct request *request, struct reply *reply) {
  struct criterion objectives[CRITERIA_MAX];
  struct error error = {.status = STATUS_OK};
  const char *format = url_query(&request->url, "format");
  bool optuna = format && strcmp(format, "optuna") == 0;
  char *text = NULL;
  size_t size = 0, count = 0;
  if ((format && !optuna && strcmp(format, "table") != 0) ||
      (!optuna && url_query(&request->url, "objectives"))) {
    reply_problem(reply, 400, "invalid_query",
                  "format=%.40s: expected table, or optuna, which alone takes objectives, for "
                  "example format=optuna&objectives=max:bending_angle_deg.",
                  format ? format : "table");
    return;
  }
  const struct study_table *table = study_table_open(request, reply);
  if (!table) {
    return;
  }
  enum status status = STATUS_OK;
  if (optuna) {
    status = read_objectives(request, table, objectives, &count, &error);
  }
  if (status == STATUS_OK) {
    status = optuna ? export_optuna(request->service->store, table, objectives, count, &text, &size,
                                    &error)
                    : export_csv(table, &text, &size, &error);
  }
  if (status == STATUS_OK) {
    reply_header(reply, "Content-Disposition", "attachment; filename=\"study-%lld%s.csv\"",
                 (long long)table->study_id, optuna ? "-optuna" : "");
    reply_text(reply, "text/csv; charset=utf-8", text, size);
  } else {
    study_reply(reply, status, NULL, &error);
  }
  study_table_close(request, table);
}
