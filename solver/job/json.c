#include "solver/job/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- reading ---------------------------------------------------------------------------- */

/* Jansson has its own, far larger limit; this one is checked before anything is built. */
static enum status check_depth(const char *text, size_t size, struct error *error) {
  int depth = 0, line = 1, column = 0;
  bool in_string = false;
  for (size_t i = 0; i < size; i++) {
    unsigned char c = (unsigned char)text[i];
    column += (c & 0xC0) != 0x80;
    if (c == '\n') {
      line++;
      column = 0;
    }
    if (in_string) {
      i += c == '\\';
      column += c == '\\';
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if ((c == '{' || c == '[') && ++depth > JSON_DEPTH_MAX) {
      error_set(error, STATUS_SYNTAX, NULL,
                "objects and arrays are nested deeper than %d levels, the most that is allowed",
                JSON_DEPTH_MAX);
      if (error) {
        error->line = line;
        error->column = column;
      }
      return STATUS_SYNTAX;
    } else if (c == '}' || c == ']') {
      depth--;
    }
  }
  return STATUS_OK;
}

enum status json_text_read(const char *text, size_t size, json_t **root, struct error *error) {
  if (size > JSON_TEXT_MAX) {
    return error_set(error, STATUS_TOO_LARGE, NULL,
                     "the document has %zu bytes; at most %d (1 MiB) are allowed", size,
                     JSON_TEXT_MAX);
  }
  enum status status = check_depth(text, size, error);
  if (status != STATUS_OK) {
    return status;
  }
  json_error_t problem;
  *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, &problem);
  if (*root) {
    return STATUS_OK;
  }
  if (json_error_code(&problem) == json_error_out_of_memory) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the document");
  }
  error_set(error, STATUS_SYNTAX, NULL, "not well-formed JSON: %s", problem.text);
  if (error) {
    error->line = problem.line > 0 ? problem.line : 1;
    error->column = problem.column > 0 ? problem.column : 1;
  }
  return STATUS_SYNTAX;
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
  json_t *key = json_loadb(quoted, size, JSON_DECODE_ANY, NULL);
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
  *line = *column = 1;
  for (const char *at = text; at < found; at++) {
    *column += ((unsigned char)*at & 0xC0) != 0x80;
    if (*at == '\n') {
      ++*line;
      *column = 1;
    }
  }
}

const char *json_type_phrase(const json_t *value) {
  switch (json_typeof(value)) {
  case JSON_OBJECT:
    return "an object";
  case JSON_ARRAY:
    return "an array";
  case JSON_STRING:
    return "a string";
  case JSON_INTEGER:
  case JSON_REAL:
    return "a number";
  case JSON_TRUE:
  case JSON_FALSE:
    return "true or false";
  default:
    return "null";
  }
}

void json_set_finite(json_t *object, const char *key, double value) {
  if (isfinite(value)) {
    json_object_set_new(object, key, json_real(value));
  }
}

json_t *json_texts(const char *text, size_t size, int count) {
  json_t *texts = json_array();
  for (int i = 0; i < count; i++) {
    json_array_append_new(texts, json_string(text + (size_t)i * size));
  }
  return texts;
}
