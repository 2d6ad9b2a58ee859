/* What an earlier run wrote of papers that a run with --only leaves alone. */
#include <stdlib.h>
#include <string.h>

#include "tools/reproduction.h"

enum { DOCUMENT_BYTES_MAX = 1 << 22 };

static const char end_mark[] = "<!-- end -->\n";

char *kept_read(const char *path) {
  FILE *file = fopen(path, "rb");
  char *text = file ? calloc(1, DOCUMENT_BYTES_MAX + 1) : NULL;
  if (text) {
    text[fread(text, 1, DOCUMENT_BYTES_MAX, file)] = '\0';
  }
  if (file) {
    fclose(file);
  }
  return text;
}

void kept_begin(FILE *out, const char *section) {
  fprintf(out, "<!-- %s -->\n", section);
}

void kept_end(FILE *out) {
  fputs(end_mark, out);
}

bool kept_print(FILE *out, const char *kept, const char *section) {
  char mark[120];
  snprintf(mark, sizeof mark, "<!-- %s -->\n", section);
  const char *from = kept ? strstr(kept, mark) : NULL;
  const char *to = from ? strstr(from, end_mark) : NULL;
  if (to) {
    from += strlen(mark);
    fwrite(from, 1, (size_t)(to - from), out);
  }
  return to != NULL;
}

bool kept_print_row(FILE *out, const char *kept, const char *job, double *cpu_s) {
  char start[WORK_NAME + 16];
  snprintf(start, sizeof start, "\n| [`%s`](", job);
  const char *row = kept ? strstr(kept, start) : NULL;
  const char *end = row ? strchr(row + 1, '\n') : NULL;
  if (!end) {
    return false;
  }
  fwrite(row + 1, 1, (size_t)(end - row), out);
  const char *time = end;
  while (time > row && strncmp(time, "| ", 2) != 0) {
    time--;
  }
  *cpu_s = strtod(time + 2, NULL);
  return true;
}
