/* Tables of comma-separated values (RFC 4180). */
#ifndef PNEULAB_BASE_CSV_H
#define PNEULAB_BASE_CSV_H

#include <stdio.h>

/* Writes a text as one field, in quotes where it has to be. One that a spreadsheet would take for a
 * formula gets an apostrophe in front. */
void csv_text(FILE *out, const char *text);

#endif
