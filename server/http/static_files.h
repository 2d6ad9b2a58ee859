/* The pages and their scripts as part of the program; the table is generated from static/. */
#ifndef PNEULAB_HTTP_STATIC_FILES_H
#define PNEULAB_HTTP_STATIC_FILES_H

#include <stdbool.h>
#include <stddef.h>

struct static_content {
  const unsigned char *data; /* NULL: not there */
  size_t size;
};

struct static_file {
  const char *path;         /* "/index.html", "/static/app.js" */
  const char *content_type; /* "text/html; charset=utf-8" */
  const char *hash;         /* of the content, in hexadecimal digits */
  bool forever;             /* the hash is part of the path: what a client has, it may keep */
  struct static_content plain, gzip, brotli;
};

extern const struct static_file static_files[];
extern const size_t static_file_count;

#endif
