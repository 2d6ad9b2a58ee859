/* STL as text: solid NAME, facet normal x y z, outer loop, three times vertex x y z, endloop,
 * endfacet, ..., endsolid NAME; words in any case, parted by any blanks; several solids one after
 * the other. */
#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "solver/base/text.h"
#include "solver/rigid/stl_internal.h"

enum { WORD = 64 };

struct scan {
  const unsigned char *at, *end;
  int line;
  char word[WORD]; /* the last one, "" at the end; longer ones cut */
  struct error *error;
};

/* Goes on to the next word; blanks are those of C. */
static void next_word(struct scan *scan) {
  size_t length = 0;
  while (scan->at < scan->end && isspace(*scan->at)) {
    scan->line += *scan->at++ == '\n';
  }
  while (scan->at < scan->end && !isspace(*scan->at)) {
    if (length < WORD - 1) {
      scan->word[length++] = (char)*scan->at;
    }
    scan->at++;
  }
  scan->word[length] = '\0';
}

static void skip_line(struct scan *scan) {
  while (scan->at < scan->end && *scan->at != '\n') {
    scan->at++;
  }
}

static bool is_word(const struct scan *scan, const char *word) {
  return strcasecmp(scan->word, word) == 0;
}

static enum status refuse(const struct scan *scan, const char *wanted) {
  char quoted[40], repaired[WORD];
  memcpy(repaired, scan->word, sizeof repaired);
  text_repair(repaired);
  return error_set(
      scan->error, STATUS_INVALID, NULL,
      "line %d of the STL file has %s where %s is due\nsolid NAME; for each triangle: facet "
      "normal x y z, outer loop, three times vertex x y z, endloop, endfacet; endsolid",
      scan->line, repaired[0] ? text_quote(quoted, sizeof quoted, repaired) : "its end", wanted);
}

static enum status expect(struct scan *scan, const char *word) {
  char quoted[40];
  next_word(scan);
  return is_word(scan, word) ? STATUS_OK : refuse(scan, text_quote(quoted, sizeof quoted, word));
}

/* A decimal number; strtod alone would take "nan", "inf" and hexadecimal ones. */
static enum status read_number(struct scan *scan, double *value) {
  char *end;
  next_word(scan);
  if (scan->word[0] == '\0' || scan->word[strspn(scan->word, "+-.0123456789eE")] != '\0') {
    return refuse(scan, "a number");
  }
  *value = strtod(scan->word, &end);
  return *end == '\0' && fabs(*value) <= (double)FLT_MAX
             ? STATUS_OK
             : refuse(scan, "a number of single precision");
}

static enum status read_vector(struct scan *scan, double vector[3]) {
  enum status status = STATUS_OK;
  for (int i = 0; i < 3 && status == STATUS_OK; i++) {
    status = read_number(scan, &vector[i]);
  }
  return status;
}

/* What follows the word "facet". */
static enum status read_facet(struct scan *scan, double corner[9]) {
  double normal[3];
  enum status status = expect(scan, "normal");
  if (status == STATUS_OK) {
    status = read_vector(scan, normal);
  }
  if (status == STATUS_OK) {
    status = expect(scan, "outer");
  }
  if (status == STATUS_OK) {
    status = expect(scan, "loop");
  }
  for (int i = 0; i < 3 && status == STATUS_OK; i++) {
    status = expect(scan, "vertex");
    if (status == STATUS_OK) {
      status = read_vector(scan, corner + 3 * i);
    }
  }
  if (status == STATUS_OK) {
    status = expect(scan, "endloop");
  }
  return status == STATUS_OK ? expect(scan, "endfacet") : status;
}

static enum status add_facet(struct scan *scan, struct stl *stl, int *capacity) {
  if (stl->count == STL_TRIANGLES_MAX) {
    return stl_refuse_count(STL_TRIANGLES_MAX + 1, scan->error);
  }
  if (stl->count == *capacity) {
    int larger = *capacity ? 2 * *capacity : 64;
    double *corner = realloc(stl->corner, sizeof(double[9]) * (size_t)larger);
    if (!corner) {
      return stl_refuse_memory(scan->error);
    }
    stl->corner = corner;
    *capacity = larger;
  }
  enum status status = read_facet(scan, stl->corner + 9 * (size_t)stl->count);
  stl->count += status == STATUS_OK;
  return status;
}

/* What follows the word "solid", to its end. */
static enum status read_solid(struct scan *scan, struct stl *stl, int *capacity) {
  skip_line(scan);
  for (;;) {
    next_word(scan);
    if (is_word(scan, "endsolid")) {
      skip_line(scan);
      return STATUS_OK;
    }
    enum status status = is_word(scan, "facet") ? add_facet(scan, stl, capacity)
                                                : refuse(scan, "\"facet\" or \"endsolid\"");
    if (status != STATUS_OK) {
      return status;
    }
  }
}

enum status stl_read_text(const unsigned char *data, size_t size, struct stl *stl,
                          struct error *error) {
  struct scan scan = {.at = data, .end = data + size, .line = 1, .error = error};
  enum status status = STATUS_OK;
  int capacity = 0;
  for (next_word(&scan); status == STATUS_OK && scan.word[0] != '\0'; next_word(&scan)) {
    status = is_word(&scan, "solid") ? read_solid(&scan, stl, &capacity)
                                     : refuse(&scan, "\"solid\" or the end");
  }
  return status;
}
