/* The pages and their scripts as part of the program; the table is generated from static/. */
#ifndef PNEULAB_HTTP_STATIC_FILES_H
#define PNEULAB_HTTP_STATIC_FILES_H

#include <stddef.h>

struct static_file {
  const char *path;         /* "/index.html", "/static/app.js" */
  const char *content_type; /* "text/html; charset=utf-8" */
  const unsigned char *data;
  size_t size;
  const char *etag; /* quoted: "\"5f3a...\"" */
};

extern const struct static_file static_files[];
extern const size_t static_file_count;

#endif
