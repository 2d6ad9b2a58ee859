#include "server/http/headers.h"

#include <string.h>

/* Pages have their scripts and styles in files of this server; nothing inline, nothing foreign. */
static const char page_policy[] =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
    "form-action 'self'; base-uri 'none'; frame-ancestors 'none'; "
    "require-trusted-types-for 'script'; trusted-types 'none'";

/* All the rest is data: even when a browser shows it as a page, nothing in it runs or loads. */
static const char data_policy[] = "default-src 'none'; sandbox; frame-ancestors 'none'";

void headers_add(struct MHD_Response *response, const struct reply *reply) {
  bool cached = false;
  bool page = reply->content_type && strncmp(reply->content_type, "text/html", 9) == 0;
  for (size_t i = 0; i < reply->header_count; i++) {
    MHD_add_response_header(response, reply->headers[i].name, reply->headers[i].value);
    cached = cached || strcmp(reply->headers[i].name, "Cache-Control") == 0;
  }
  if (reply->content_type) {
    MHD_add_response_header(response, "Content-Type", reply->content_type);
  }
  if (!cached) {
    MHD_add_response_header(response, "Cache-Control", "no-store");
  }
  MHD_add_response_header(response, "X-Content-Type-Options", "nosniff");
  MHD_add_response_header(response, "Referrer-Policy", "same-origin");
  MHD_add_response_header(response, "Cross-Origin-Opener-Policy", "same-origin");
  MHD_add_response_header(response, "Cross-Origin-Resource-Policy", "same-origin");
  MHD_add_response_header(response, "Content-Security-Policy", page ? page_policy : data_policy);
  if (reply->close) {
    MHD_add_response_header(response, "Connection", "close");
  }
}
