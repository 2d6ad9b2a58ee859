/* Writing HTML: every text and every value of an attribute is escaped here, and every element that
 * is opened gets closed. Nothing else of the daemon makes markup. */
#ifndef PNEULAB_HTTP_HTML_H
#define PNEULAB_HTTP_HTML_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { HTML_DEPTH = 32 };

/* A document being written. */
struct html {
  FILE *out;
  char *text;
  size_t size;
  const char *open[HTML_DEPTH]; /* names of the elements that are not closed yet */
  int depth;
};

/* Starts an empty document; false without memory. html_finish has to follow. */
bool html_start(struct html *html);

/* Ends the document, whose elements are all closed: its text, which the caller frees, of *size
 * bytes; NULL without memory. */
char *html_finish(struct html *html, size_t *size);

/* Copies markup of the program itself. */
void html_copy(struct html *html, const char *markup, size_t size);

/* Opens an element. Then come names and values of its attributes in turn, ended by NULL; one whose
 * value is NULL is left out. Names of elements and attributes are words of the program. */
void html_open(struct html *html, const char *tag, ...) __attribute__((sentinel));

/* The same for an element that has no content (img, input). */
void html_void(struct html *html, const char *tag, ...) __attribute__((sentinel));

/* An element with nothing but a text in it. */
void html_leaf(struct html *html, const char *tag, const char *text, ...) __attribute__((sentinel));

/* Closes the element that was opened last. */
void html_close(struct html *html);

/* Writes a text. */
void html_text(struct html *html, const char *text);
void html_format(struct html *html, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
