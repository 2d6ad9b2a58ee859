/* Documents written from a template whose lines stand for sections. */
#ifndef PNEULAB_TOOLS_TEMPLATE_H
#define PNEULAB_TOOLS_TEMPLATE_H

#include <stdbool.h>
#include <stdio.h>

/* Prints the section that a line of the template (with its line feed) stands for; false when the
 * line is plain text. */
typedef bool (*template_section_fn)(FILE *out, const char *line, const void *context);

/* Writes `path` from the template: its sections printed, its other lines copied. False, with the
 * reason on standard error, when a file cannot be read or written. */
bool template_fill(const char *template_path, const char *path, template_section_fn section,
                   const void *context);

#endif
