#include "solver/base/table.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "solver/base/text.h"

/* One line of the text in fields. Fields lie in the scanner's buffer until the next line. */
struct record {
  int line;
  size_t count;
  char *field[TABLE_FIELDS_MAX];
};

struct scanner {
  const char *at, *end;
  int line; /* of `at` */
  char delimiter;
  char *buffer; /* as large as the text and two bytes more */
};

/* Everything on the way from the text to the table. */
struct reading {
  const char *text, *pointer;
  size_t size;
  const struct table_column *wanted;
  size_t count;
  size_t place[TABLE_WANTED_MAX]; /* field of each wanted column */
  int header_line;
  char decimal; /* '.' or ',' once a number has shown it, otherwise 0 */
  struct table *table;
  struct error *error;
};

/* ---- lines and fields ------------------------------------------------------------------- */

static void scanner_start(struct scanner *scanner, const char *text, size_t size, char delimiter) {
  static const char mark[] = "\xEF\xBB\xBF";
  size_t skip = size >= 3 && memcmp(text, mark, 3) == 0 ? 3 : 0;
  scanner->at = text + skip;
  scanner->end = text + size;
  scanner->line = 1;
  scanner->delimiter = delimiter;
}

static bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}

static void pass_line_end(struct scanner *scanner) {
  if (scanner->at < scanner->end) {
    bool pair = *scanner->at == '\r' && scanner->at + 1 < scanner->end && scanner->at[1] == '\n';
    scanner->at += pair ? 2 : 1;
    scanner->line++;
  }
}

/* Copies the field at `at` to `out` without its quotes; returns the end of the copy, NULL when a
 * quote stays open. */
static char *copy_field(struct scanner *scanner, char *out) {
  bool quoted = scanner->at < scanner->end && *scanner->at == '"';
  scanner->at += quoted;
  while (scanner->at < scanner->end) {
    char c = *scanner->at;
    if (quoted && c == '"') {
      bool doubled = scanner->at + 1 < scanner->end && scanner->at[1] == '"';
      scanner->at += doubled;
      quoted = doubled;
      if (!doubled) {
        scanner->at++;
        continue;
      }
    } else if (!quoted && (c == scanner->delimiter || is_line_end(c))) {
      break;
    } else if (quoted && is_line_end(c)) {
      pass_line_end(scanner);
      *out++ = ' ';
      continue;
    }
    *out++ = c;
    scanner->at++;
  }
  return quoted ? NULL : out;
}

static char *trim(char *start, char *end) {
  while (end > start && (end[-1] == ' ' || end[-1] == '\t')) {
    end--;
  }
  *end = '\0';
  return start + strspn(start, " \t");
}

/* 1: a line was read, 0: there is none any more, -1: a quote stays open, -2: too many fields. */
static int read_record(struct scanner *scanner, struct record *record) {
  char *out = scanner->buffer;
  *record = (struct record){.line = scanner->line};
  if (scanner->at >= scanner->end) {
    return 0;
  }
  for (;;) {
    if (record->count == TABLE_FIELDS_MAX) {
      return -2;
    }
    char *start = out, *end = copy_field(scanner, out);
    if (!end) {
      return -1;
    }
    record->field[record->count++] = trim(start, end);
    out = end + 1;
    if (scanner->at >= scanner->end || is_line_end(*scanner->at)) {
      pass_line_end(scanner);
      return 1;
    }
    scanner->at++; /* the delimiter */
  }
}

static bool is_empty(const struct record *record) {
  for (size_t i = 0; i < record->count; i++) {
    if (record->field[i][0] != '\0') {
      return false;
    }
  }
  return true;
}

/* ---- delimiter and header --------------------------------------------------------------- */

static char find_delimiter(struct scanner *scanner, const struct reading *reading) {
  static const char candidates[] = "\t;,";
  struct record record;
  char best = ',';
  size_t most = 0;
  for (const char *c = candidates; *c; c++) {
    size_t divided = 0;
    scanner_start(scanner, reading->text, reading->size, *c);
    while (read_record(scanner, &record) == 1) {
      divided += record.count > 1;
    }
    if (divided > most) {
      most = divided;
      best = *c;
    }
  }
  return best;
}

static enum status refuse_record(const struct reading *reading, int code, int line) {
  if (code == -2) {
    return error_set(reading->error, STATUS_TOO_LARGE, reading->pointer,
                     "line %d of the table has too many columns\nat most %d", line,
                     TABLE_FIELDS_MAX);
  }
  return error_set(reading->error, STATUS_INVALID, reading->pointer,
                   "line %d of the table opens a quote (\") that is never closed\nquotes in pairs",
                   line);
}

static size_t find_field(const struct record *record, const char *name) {
  size_t place = 0;
  while (place < record->count && strcmp(record->field[place], name) != 0) {
    place++;
  }
  return place;
}

static size_t count_found(const struct reading *reading, const struct record *record) {
  size_t found = 0;
  for (size_t i = 0; i < reading->count; i++) {
    found += find_field(record, reading->wanted[i].name) < record->count;
  }
  return found;
}

/* Whether the field is text that no number starts with. */
static bool is_word(const char *field) {
  return field[0] != '\0' && !strchr("0123456789+-.,", field[0]);
}

/* Likeness to a header of a line without all names: first by the names that it has, then by being
 * the widest line of words only. */
static size_t header_score(const struct reading *reading, const struct record *record) {
  size_t words = 0;
  for (size_t i = 0; i < record->count; i++) {
    words += is_word(record->field[i]);
    if (record->field[i][0] != '\0' && !is_word(record->field[i])) {
      words = 0;
      break;
    }
  }
  return count_found(reading, record) * (TABLE_FIELDS_MAX + 1) + words;
}

/* Leaves the scanner behind the line that is the header, or the likeliest to be meant as one. */
static enum status find_header(struct scanner *scanner, const struct reading *reading,
                               struct record *header) {
  struct scanner behind = *scanner;
  size_t best = 0;
  int best_line = 0, code;
  while ((code = read_record(scanner, header)) == 1) {
    if (count_found(reading, header) == reading->count) {
      return STATUS_OK;
    }
    size_t score = header_score(reading, header);
    if (score > best) {
      best = score;
      best_line = header->line;
    }
  }
  if (code < 0) {
    return refuse_record(reading, code, header->line);
  }
  if (best_line == 0) {
    return error_set(reading->error, STATUS_INVALID, reading->pointer,
                     "the table has no line with the names of its columns\nsuch a line, for "
                     "example \"Strain,Stress (MPa)\" above the numbers");
  }
  *scanner = behind;
  while (read_record(scanner, header) == 1 && header->line < best_line) {
  }
  return STATUS_OK;
}

static enum status refuse_name(const struct reading *reading, const struct record *header,
                               size_t column) {
  const struct table_column *wanted = &reading->wanted[column];
  const char *words[TABLE_FIELDS_MAX];
  char list[220] = "", name[70], known[50];
  size_t count = 0, length = 0;
  for (size_t i = 0; i < header->count; i++) {
    if (header->field[i][0] != '\0') {
      words[count++] = header->field[i];
    }
  }
  for (size_t i = 0; i < count && length + sizeof known + 4 < sizeof list; i++) {
    length += (size_t)snprintf(list + length, sizeof list - length, "%s%s", i > 0 ? ", " : "",
                               text_quote(known, sizeof known, words[i]));
  }
  const char *near = text_nearest(wanted->name, words, count);
  char hint[80] = "";
  if (near) {
    snprintf(hint, sizeof hint, " (did you mean %s?)", text_quote(known, sizeof known, near));
  }
  return error_nearest(
      reading->error,
      error_set(reading->error, STATUS_INVALID, wanted->pointer,
                "the table has no column %s%s: its header, line %d, has others\n%s",
                text_quote(name, sizeof name, wanted->name), hint, header->line, list),
      near);
}

static enum status place_columns(struct reading *reading, const struct record *header) {
  reading->header_line = header->line;
  for (size_t i = 0; i < reading->count; i++) {
    const struct table_column *wanted = &reading->wanted[i];
    size_t place = find_field(header, wanted->name);
    if (place == header->count) {
      return refuse_name(reading, header, i);
    }
    char name[70];
    for (size_t k = place + 1; k < header->count; k++) {
      if (strcmp(header->field[k], wanted->name) == 0) {
        return error_set(reading->error, STATUS_INVALID, wanted->pointer,
                         "columns %zu and %zu of the table (line %d) are both called %s\ndifferent "
                         "names: rename one of them",
                         place + 1, k + 1, header->line,
                         text_quote(name, sizeof name, wanted->name));
      }
    }
    for (size_t k = 0; k < i; k++) {
      if (reading->place[k] == place) {
        return error_set(reading->error, STATUS_INVALID, wanted->pointer,
                         "the column %s is named for two quantities\na column for each",
                         text_quote(name, sizeof name, wanted->name));
      }
    }
    reading->place[i] = place;
  }
  return STATUS_OK;
}

/* ---- numbers ---------------------------------------------------------------------------- */

/* Whether the whole field is a decimal number with this sign between whole and fraction. Stricter
 * than strtod: no hexadecimal, no "inf", no "nan". */
static bool is_number(const char *field, char decimal) {
  static const char digits[] = "0123456789";
  const char *at = field + (*field == '-' || *field == '+');
  size_t whole = strspn(at, digits);
  at += whole;
  size_t part = 0;
  if (*at == decimal) {
    part = strspn(++at, digits);
    at += part;
  }
  if (whole + part > 0 && (*at == 'e' || *at == 'E')) {
    at += 1 + (at[1] == '-' || at[1] == '+');
    size_t exponent = strspn(at, digits);
    part = exponent > 0 ? part : 0;
    whole = exponent > 0 ? whole : 0;
    at += exponent;
  }
  return whole + part > 0 && *at == '\0';
}

static enum status refuse_field(const struct reading *reading, int line, size_t column,
                                const char *field, const char *why) {
  char quoted[50], name[60];
  return error_set(reading->error, STATUS_INVALID, reading->pointer,
                   "line %d of the table, column %s: %s%s%s", line,
                   text_quote(name, sizeof name, reading->wanted[column].name),
                   field ? text_quote(quoted, sizeof quoted, field) : "", field ? " " : "", why);
}

static bool is_spelled_infinite(const char *field) {
  field += *field == '-' || *field == '+';
  return strncasecmp(field, "nan", 3) == 0 || strncasecmp(field, "inf", 3) == 0;
}

static enum status read_number(struct reading *reading, const struct record *record, size_t column,
                               double *value) {
  if (reading->place[column] >= record->count) {
    char why[100];
    snprintf(why, sizeof why, "the line ends after %zu of %zu columns: a number is missing",
             record->count, reading->place[column] + 1);
    return refuse_field(reading, record->line, column, NULL, why);
  }
  char *field = record->field[reading->place[column]];
  if (field[0] == '\0') {
    return refuse_field(reading, record->line, column, NULL,
                        "the field is empty: fill the gap "
                        "or leave out the line");
  }
  char *comma =
      reading->table->delimiter != ',' && is_number(field, ',') ? strchr(field, ',') : NULL;
  if (!comma && !is_number(field, '.')) {
    return refuse_field(reading, record->line, column, field,
                        is_spelled_infinite(field) ? "is not a finite number"
                                                   : "is not a number; for example 0.25");
  }
  char decimal = comma ? ',' : strchr(field, '.') ? '.' : reading->decimal;
  if (reading->decimal && decimal != reading->decimal) {
    return refuse_field(reading, record->line, column, field,
                        decimal == ','
                            ? "has a decimal comma, but numbers above have decimal points"
                            : "has a decimal point, but numbers above have decimal commas");
  }
  reading->decimal = decimal;
  if (comma) {
    *comma = '.';
  }
  *value = strtod(field, NULL);
  return isfinite(*value)
             ? STATUS_OK
             : refuse_field(reading, record->line, column, field, "is beyond the range of numbers");
}

/* ---- rows ------------------------------------------------------------------------------- */

/* Whether every field of the line is empty or in brackets, as in "(s);(MPa)". */
static bool is_units_line(const struct record *record) {
  for (size_t i = 0; i < record->count; i++) {
    if (record->field[i][0] != '\0' && record->field[i][0] != '(' && record->field[i][0] != '[') {
      return false;
    }
  }
  return true;
}

/* Makes room for at least one row more. */
static enum status grow(struct reading *reading, size_t *capacity) {
  struct table *table = reading->table;
  if (table->rows < *capacity) {
    return STATUS_OK;
  }
  size_t wanted = *capacity > 0 ? 2 * *capacity : 256;
  int *line = realloc(table->line, wanted * sizeof *line);
  table->line = line ? line : table->line;
  bool good = line != NULL;
  for (size_t i = 0; i < reading->count; i++) {
    double *value = realloc(table->value[i], wanted * sizeof *value);
    table->value[i] = value ? value : table->value[i];
    good = good && value;
  }
  *capacity = wanted;
  return good ? STATUS_OK
              : error_set(reading->error, STATUS_NO_MEMORY, NULL, "no memory for a table");
}

static enum status read_rows(struct scanner *scanner, struct reading *reading,
                             struct record *record) {
  struct table *table = reading->table;
  size_t capacity = 0;
  int code;
  while ((code = read_record(scanner, record)) == 1) {
    if (is_empty(record) || (table->rows == 0 && is_units_line(record))) {
      continue;
    }
    if (table->rows == TABLE_ROWS_MAX) {
      return error_set(
          reading->error, STATUS_TOO_LARGE, reading->pointer,
          "line %d of the table\nat most %d rows: leave out points, they need not be so close",
          record->line, TABLE_ROWS_MAX);
    }
    enum status status = grow(reading, &capacity);
    for (size_t i = 0; i < reading->count && status == STATUS_OK; i++) {
      status = read_number(reading, record, i, &table->value[i][table->rows]);
    }
    if (status != STATUS_OK) {
      return status;
    }
    table->line[table->rows++] = record->line;
  }
  if (code < 0) {
    return refuse_record(reading, code, record->line);
  }
  return table->rows > 0
             ? STATUS_OK
             : error_set(
                   reading->error, STATUS_INVALID, reading->pointer,
                   "the table has no rows below its header, line %d\none row of numbers or more",
                   reading->header_line);
}

enum status table_read(const char *text, size_t size, const char *pointer,
                       const struct table_column *wanted, size_t count, struct table *table,
                       struct error *error) {
  struct reading reading = {.text = text,
                            .pointer = pointer,
                            .size = size,
                            .wanted = wanted,
                            .count = count,
                            .table = table,
                            .error = error};
  struct scanner scanner = {.buffer = malloc(size + 2)};
  struct record record;
  *table = (struct table){.rows = 0};
  if (!scanner.buffer) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a table");
  }
  table->delimiter = find_delimiter(&scanner, &reading);
  scanner_start(&scanner, text, size, table->delimiter);
  enum status status = find_header(&scanner, &reading, &record);
  if (status == STATUS_OK) {
    status = place_columns(&reading, &record);
  }
  if (status == STATUS_OK) {
    status = read_rows(&scanner, &reading, &record);
  }
  if (status != STATUS_OK) {
    table_release(table);
  }
  free(scanner.buffer);
  return status;
}

void table_release(struct table *table) {
  for (size_t i = 0; i < TABLE_WANTED_MAX; i++) {
    free(table->value[i]);
  }
  free(table->line);
  *table = (struct table){.rows = 0};
}
