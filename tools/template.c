#include "tools/template.h"

bool template_fill(const char *template_path, const char *path, template_section_fn section,
                   const void *context) {
  FILE *in = fopen(template_path, "r");
  FILE *out = in ? fopen(path, "w") : NULL;
  if (!out) {
    perror(in ? path : template_path);
    if (in) {
      fclose(in);
    }
    return false;
  }
  char line[4096];
  while (fgets(line, sizeof line, in)) {
    if (!section(out, line, context)) {
      fputs(line, out);
    }
  }
  bool good = !ferror(in) && !ferror(out);
  fclose(in);
  good = fclose(out) == 0 && good;
  if (!good) {
    perror(path);
  }
  return good;
}
