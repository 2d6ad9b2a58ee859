/* check_lines SCHEMA.json: reads one JSON document a line from standard input and prints for each a
 * line ["ok", ""], or the pointer and the message with which the schema checker refuses it. */
#include <stdio.h>
#include <stdlib.h>

#include "solver/job/json.h"
#include "solver/job/schema.h"

static void check_line(const struct schema *schema, const char *line, size_t size) {
  json_t *document = NULL;
  struct error error = {.status = STATUS_OK};
  enum status status = json_text_read(line, size, &document, &error);
  if (status == STATUS_OK) {
    status = schema_check(schema, document, &error);
    json_decref(document);
  }
  bool good = status == STATUS_OK;
  json_t *answer = json_pack("[s, s]", good ? "ok" : error.pointer, good ? "" : error.message);
  json_dumpf(answer, stdout, JSON_COMPACT); /* keys may have line feeds */
  putchar('\n');
  json_decref(answer);
}

int main(int argc, char **argv) {
  struct units *units = NULL;
  struct schema *schema = NULL;
  struct error error = {.status = STATUS_OK};
  char *line = NULL;
  size_t capacity = 0;
  int result = EXIT_FAILURE;
  FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
  ssize_t size = file ? getdelim(&line, &capacity, '\0', file) : -1;
  if (size < 0 || units_create(&units, &error) != STATUS_OK ||
      schema_create(line, (size_t)size, units, &schema, &error) != STATUS_OK) {
    fprintf(stderr, "no usable schema: %s\n", error.message);
    goto done;
  }
  while ((size = getline(&line, &capacity, stdin)) > 0) {
    check_line(schema, line, (size_t)size);
  }
  result = EXIT_SUCCESS;
done:
  if (file) {
    fclose(file);
  }
  free(line);
  schema_destroy(schema);
  units_destroy(units);
  return result;
}
