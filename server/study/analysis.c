#include "server/study/analysis.h"

#include <math.h>

#include "solver/explore/importance.h"

json_t *analysis_number(double value) {
  return isfinite(value) ? json_real(value) : json_null();
}

json_t *analysis_share(const struct share *share) {
  return json_pack("{s:o, s:o, s:o}", "value", analysis_number(share->value), "low",
                   analysis_number(share->low), "high", analysis_number(share->high));
}

json_t *analysis_column(const struct study_column *column) {
  return json_pack("{s:s, s:s, s:s}", "key", column->key, "title", column->title, "unit",
                   column->unit);
}

json_t *analysis_member(const struct study_table *table, size_t row) {
  return json_pack("{s:i, s:I, s:s}", "member", table->member[row], "job",
                   (json_int_t)table->job_id[row], "name", table->member_name[row]);
}

enum status analysis_made(json_t *answer, struct error *error) {
  return answer
             ? STATUS_OK
             : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the analysis of a study.");
}
