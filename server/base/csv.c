#include "server/base/csv.h"

#include <string.h>

void csv_text(FILE *out, const char *text) {
  if (text[0] && strchr("=+-@\t\r", text[0])) {
    fputc('\'', out);
  }
  if (!strpbrk(text, ",\"\r\n") && text[0] != ' ') {
    fputs(text, out);
    return;
  }
  fputc('"', out);
  for (; *text; text++) {
    if (*text == '"') {
      fputc('"', out);
    }
    fputc(*text, out);
  }
  fputc('"', out);
}
