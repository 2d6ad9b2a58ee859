/* Any bytes as a table: finite numbers in rows of rising lines, or a sentence, never worse. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/table.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const struct table_column wanted[] = {{"x", "/columns/x"}, {"y", "/columns/y"}};
  struct table table;
  struct error error = {.status = STATUS_OK};
  enum status status = table_read((const char *)data, size, "/data/csv", wanted, 2, &table, &error);
  if (status != STATUS_OK) {
    if (error.status != status || error.message[0] == '\0' || error.pointer[0] != '/' ||
        table.rows > 0 || (status != STATUS_INVALID && status != STATUS_TOO_LARGE)) {
      abort();
    }
    return 0;
  }
  if (table.rows == 0 || table.rows > TABLE_ROWS_MAX) {
    abort();
  }
  for (size_t i = 0; i < table.rows; i++) {
    if (!isfinite(table.value[0][i]) || !isfinite(table.value[1][i]) || table.line[i] < 2 ||
        (i > 0 && table.line[i] <= table.line[i - 1])) {
      abort();
    }
  }
  table_release(&table);
  return 0;
}
