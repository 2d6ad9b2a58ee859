#include "solver/job/json.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/text.h"

/* ---- places -------------------------------------------------------------------------------- */

static void count_place(const char *text, size_t offset, int *line, int *column) {
  *line = *column = 1;
  for (size_t i = 0; i < offset; i++) {
    *column += ((unsigned char)text[i] & 0xC0) != 0x80;
    if (text[i] == '\n') {
      ++*line;
      *column = 1;
    }
  }
}

static void place(const char *text, size_t offset, struct error *error) {
  if (error) {
    count_place(text, offset, &error->line, &error->column);
  }
}

/* ---- reading ---------------------------------------------------------------------------- */

/* Jansson has its own, far larger limit; this one is checked before anything is built. */
static enum status check_depth(const char *text, size_t size, struct error *error) {
  int depth = 0;
  bool in_string = false;
  for (size_t i = 0; i < size; i++) {
    char c = text[i];
    if (in_string) {
      i += c == '\\';
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if ((c == '{' || c == '[') && ++depth > JSON_DEPTH_MAX) {
      error_set(error, STATUS_SYNTAX, NULL,
                "objects and arrays are nested too deep\nat most %d levels", JSON_DEPTH_MAX);
      place(text, i, error);
      return STATUS_SYNTAX;
    } else if (c == '}' || c == ']') {
      depth--;
    }
  }
  return STATUS_OK;
}

/* Where the piece of text that ends at `end` begins: a string with its quotes, or a word. */
static size_t piece_start(const char *text, size_t end) {
  size_t at = end;
  if (at > 0 && text[at - 1] == '"') {
    for (at--; at > 0 && text[at - 1] != '"' && text[at - 1] != '\n';) {
      at--;
    }
    return at > 0 ? at - 1 : 0;
  }
  while (at > 0 && (isalnum((unsigned char)text[at - 1]) || strchr("+-._", text[at - 1])) &&
         text[at - 1] != '\0') {
    at--;
  }
  return at < end ? at : end > 0 ? end - 1 : 0;
}

/* What is wrong with a piece that is no JSON, and what would be right. */
static const char *piece_advice(const char *piece, size_t length) {
  static const struct {
    const char *start, *advice;
  } known[] = {
      {"NaN", "the word NaN is no JSON\na finite number\n0.5"},
      {"nan", "the word nan is no JSON\na finite number\n0.5"},
      {"-I", "Infinity is no JSON\na finite number\n1e6"},
      {"I", "Infinity is no JSON\na finite number\n1e6"},
      {"inf", "Infinity is no JSON\na finite number\n1e6"},
      {"//", "JSON has no remarks\ntext under the key \"comment\"\n{\"comment\": \"a remark\"}"},
      {"/*", "JSON has no remarks\ntext under the key \"comment\"\n{\"comment\": \"a remark\"}"},
      {"#", "JSON has no remarks\ntext under the key \"comment\"\n{\"comment\": \"a remark\"}"},
      {"'", "a single quote begins no string\ntext in double quotes\n\"fast\""},
      {"True", "True is no JSON\ntrue or false in small letters\ntrue"},
      {"False", "False is no JSON\ntrue or false in small letters\nfalse"},
      {"None", "None is no JSON\na value, or the key left out\nnull"},
      {"}", "a brace ends the object where a key or value is due\nno comma before it"},
      {"]", "a bracket ends the array where a value is due\nno comma before it"},
      {"+", "a number begins with a plus sign\nits digits, or a minus sign\n1.5"},
      {".", "a number begins with a point\na digit before it\n0.5"},
      {"0", "a number begins with a zero before other digits\nno leading zero\n1"},
  };
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    size_t start = strlen(known[i].start);
    if (length >= start && strncmp(piece, known[i].start, start) == 0) {
      return known[i].advice;
    }
  }
  return NULL;
}

/* A piece that is no JSON, or stands where another is due: Jansson names those as "':' expected".
 */
static void refuse_piece(const char *text, size_t size, size_t start, size_t end,
                         const json_error_t *problem, struct error *error) {
  char piece[64], quoted[70];
  const char *advice = piece_advice(text + start, size - start);
  const char *due = strstr(problem->text, " expected");
  snprintf(piece, sizeof piece, "%.*s", (int)(end - start), text + start);
  text_quote(quoted, sizeof quoted, piece);
  if (advice) {
    error_set(error, STATUS_SYNTAX, NULL, "not well-formed JSON: %s", advice);
  } else if (due) {
    error_set(error, STATUS_SYNTAX, NULL,
              "not well-formed JSON: %s stands where something else is due\n%.*s",
              piece[0] == '"' ? piece : quoted, (int)(due - problem->text), problem->text);
  } else {
    char said[2 * JSON_ERROR_TEXT_LENGTH];
    text_quote(said, sizeof said, problem->text); /* it quotes the text with its line feeds */
    error_set(error, STATUS_SYNTAX, NULL, "not well-formed JSON: the reader says %s", said);
  }
}

static bool is_blank(const char *text, size_t size) {
  size_t at = 0;
  while (at < size && text[at] != '\0' && strchr(" \t\r\n", text[at])) {
    at++;
  }
  return at == size;
}

/* Says what Jansson found, with the place where the offending piece begins. */
static enum status refuse_syntax(const char *text, size_t size, const json_error_t *problem,
                                 struct error *error) {
  static const char example[] = "{\"kind\": \"verify\", \"case\": \"elastica\"}";
  size_t end = problem->position > 0 ? (size_t)problem->position : 0;
  end = end < size ? end : size;
  size_t start = piece_start(text, end);
  char piece[64], quoted[70];
  snprintf(piece, sizeof piece, "%.*s", (int)(end - start), text + start);
  text_quote(quoted, sizeof quoted, piece);
  switch (json_error_code(problem)) {
  case json_error_duplicate_key:
    error_set(error, STATUS_SYNTAX, NULL,
              "the key %s stands twice in one object, a duplicate object key\neach key once",
              piece);
    break;
  case json_error_premature_end_of_input:
    start = size;
    error_set(error, STATUS_SYNTAX, NULL,
              "not well-formed JSON: the text %s\na whole JSON object\n%s",
              is_blank(text, size) ? "is empty" : "ends too early", example);
    break;
  case json_error_end_of_input_expected:
    error_set(error, STATUS_SYNTAX, NULL,
              "%s follows the document, where the end of file is due\none JSON object alone",
              quoted);
    break;
  case json_error_numeric_overflow:
    error_set(error, STATUS_SYNTAX, NULL,
              "the number %s is too big (overflow)\nnumbers up to 1e308, whole ones up to "
              "9223372036854775807",
              piece);
    break;
  case json_error_null_byte_in_key:
  case json_error_null_character:
    error_set(error, STATUS_SYNTAX, NULL, "the string has a NUL character\ntext without one");
    break;
  case json_error_invalid_utf8:
    start = text_valid(text, size);
    error_set(error, STATUS_SYNTAX, NULL,
              "not well-formed JSON: a byte that is no UTF-8, which cannot be decoded\ntext in "
              "UTF-8");
    break;
  default:
    refuse_piece(text, size, start, end, problem, error);
  }
  place(text, start, error);
  return STATUS_SYNTAX;
}

enum status json_text_read(const char *text, size_t size, json_t **root, struct error *error) {
  static const char mark[] = "\xEF\xBB\xBF";
  if (size > JSON_TEXT_MAX) {
    return error_set(error, STATUS_TOO_LARGE, NULL,
                     "the document has %zu bytes\nat most %d (1 MiB)", size, JSON_TEXT_MAX);
  }
  if (size >= 3 && memcmp(text, mark, 3) == 0) {
    error_set(error, STATUS_SYNTAX, NULL,
              "a byte order mark stands before the document\nthe document alone, in UTF-8");
    place(text, 0, error);
    return STATUS_SYNTAX;
  }
  enum status status = check_depth(text, size, error);
  if (status != STATUS_OK) {
    return status;
  }
  json_error_t problem;
  *root = json_read(text, size, JSON_REJECT_DUPLICATES, &problem);
  if (!*root && errno == ENOMEM) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the document");
  }
  return *root ? STATUS_OK : refuse_syntax(text, size, &problem, error);
}

/* ---- pointers --------------------------------------------------------------------------- */

static size_t push(struct json_pointer *pointer, const char *part, size_t length) {
  size_t mark = pointer->length;
  if (pointer->hidden > 0 || mark + 1 + length >= sizeof pointer->text) {
    pointer->hidden++;
    return mark;
  }
  pointer->text[mark] = '/';
  memcpy(pointer->text + mark + 1, part, length);
  pointer->length = mark + 1 + length;
  pointer->text[pointer->length] = '\0';
  return mark;
}

size_t json_pointer_key(struct json_pointer *pointer, const char *key) {
  char escaped[sizeof pointer->text];
  size_t length = 0;
  for (; *key && length + 2 < sizeof escaped; key++) {
    bool special = *key == '~' || *key == '/';
    escaped[length++] = special ? '~' : *key;
    if (special) {
      escaped[length++] = *key == '~' ? '0' : '1';
    }
  }
  return push(pointer, escaped, *key ? sizeof escaped : length);
}

size_t json_pointer_index(struct json_pointer *pointer, size_t index) {
  char part[24];
  int length = snprintf(part, sizeof part, "%zu", index);
  return push(pointer, part, (size_t)length);
}

void json_pointer_pop(struct json_pointer *pointer, size_t mark) {
  if (pointer->hidden > 0) {
    pointer->hidden--;
    return;
  }
  pointer->length = mark;
  pointer->text[mark] = '\0';
}

/* ---- from a pointer back to the text ---------------------------------------------------- */

/* The text is known to be well-formed; the bounds are checked all the same. */
struct scan {
  const char *at, *end;
};

static void skip_space(struct scan *scan) {
  while (scan->at < scan->end && strchr(" \t\r\n", *scan->at) && *scan->at) {
    scan->at++;
  }
}

static void skip_string(struct scan *scan) {
  for (scan->at++; scan->at < scan->end && *scan->at != '"'; scan->at++) {
    scan->at += *scan->at == '\\' && scan->at + 1 < scan->end;
  }
  scan->at += scan->at < scan->end;
}

static void skip_value(struct scan *scan) {
  int depth = 0;
  for (; scan->at < scan->end; scan->at++) {
    char c = *scan->at;
    if (c == '"') {
      skip_string(scan);
      scan->at--;
    } else if (c == '{' || c == '[') {
      depth++;
    } else if (c == '}' || c == ']') {
      if (depth-- == 0) {
        return;
      }
    } else if (c == ',' && depth == 0) {
      return;
    }
  }
}

/* Whether the key written at `quoted` (with quotes and escapes) is the pointer part `part`. */
static bool is_key(const char *quoted, size_t size, const char *part, size_t part_length) {
  json_t *key = json_read(quoted, size, JSON_DECODE_ANY, NULL);
  const char *name = json_string_value(key);
  bool same = name != NULL;
  size_t i = 0;
  for (; same && *name; name++) {
    char c = i < part_length ? part[i++] : '\0';
    if (c == '~' && i < part_length) {
      c = part[i++] == '0' ? '~' : '/';
    }
    same = c == *name;
  }
  json_decref(key);
  return same && i == part_length;
}

/* Moves from the start of a container to the member that `part` names. */
static bool enter_member(struct scan *scan, const char *part, size_t part_length) {
  bool object = *scan->at == '{';
  if (!object && *scan->at != '[') {
    return false;
  }
  unsigned long wanted = strtoul(part, NULL, 10);
  scan->at++;
  for (unsigned long index = 0; scan->at < scan->end; index++) {
    skip_space(scan);
    bool found = !object && index == wanted;
    if (object) {
      const char *key = scan->at;
      skip_string(scan);
      found = is_key(key, (size_t)(scan->at - key), part, part_length);
      skip_space(scan);
      scan->at += scan->at < scan->end; /* the colon */
      skip_space(scan);
    }
    if (found) {
      return scan->at < scan->end && *scan->at != ']';
    }
    skip_value(scan);
    if (scan->at >= scan->end || *scan->at != ',') {
      return false;
    }
    scan->at++;
  }
  return false;
}

void json_text_locate(const char *text, size_t size, const char *pointer, int *line, int *column) {
  struct scan scan = {text, text + size};
  skip_space(&scan);
  const char *found = scan.at;
  while (*pointer == '/' && scan.at < scan.end) {
    size_t length = strcspn(pointer + 1, "/");
    if (!enter_member(&scan, pointer + 1, length)) {
      break;
    }
    found = scan.at;
    pointer += 1 + length;
  }
  count_place(text, (size_t)(found - text), line, column);
}

void json_set_finite(json_t *object, const char *key, double value) {
  if (isfinite(value)) {
    json_object_set_new(object, key, json_real(value));
  }
}

void json_set_error(json_t *problem, const struct error *error) {
  const struct {
    const char *key, *text;
  } parts[] = {{"found", error->found}, {"allowed", error->allowed}, {"nearest", error->nearest}};
  if (error->line > 0) {
    json_object_set_new(problem, "line", json_integer(error->line));
    json_object_set_new(problem, "column", json_integer(error->column));
  }
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    if (parts[i].text[0] != '\0') {
      json_object_set_new(problem, parts[i].key, json_string(parts[i].text));
    }
  }
  json_t *example = error->example[0]
                        ? json_read(error->example, strlen(error->example), JSON_DECODE_ANY, NULL)
                        : NULL;
  if (example) {
    json_object_set_new(problem, "example", example);
  }
}

json_t *json_texts(const char *text, size_t size, int count) {
  json_t *texts = json_array();
  for (int i = 0; i < count; i++) {
    json_array_append_new(texts, json_string(text + (size_t)i * size));
  }
  return texts;
}
