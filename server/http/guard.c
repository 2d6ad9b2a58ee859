#include "server/http/guard.h"

#include <arpa/inet.h>
#include <microhttpd.h>
#include <string.h>
#include <strings.h>

struct header_scan {
  unsigned hosts, lengths, codings;
  bool bad_name, bad_value;
};

static bool name_is_token(const char *name) {
  static const char token[] = "!#$%&'*+-.^_`|~0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                              "abcdefghijklmnopqrstuvwxyz";
  return name[0] != '\0' && name[strspn(name, token)] == '\0';
}

static enum MHD_Result header_scan_one(void *context, enum MHD_ValueKind kind, const char *name,
                                       size_t name_size, const char *value, size_t value_size) {
  struct header_scan *scan = context;
  (void)kind;
  scan->hosts += strcasecmp(name, "Host") == 0;
  scan->lengths += strcasecmp(name, "Content-Length") == 0;
  scan->codings += strcasecmp(name, "Transfer-Encoding") == 0;
  scan->bad_name = scan->bad_name || strlen(name) != name_size || !name_is_token(name);
  scan->bad_value = scan->bad_value || (value && strlen(value) != value_size);
  for (const char *c = value ? value : ""; *c; c++) {
    scan->bad_value = scan->bad_value || ((unsigned char)*c < 0x20 && *c != '\t') || *c == 0x7f;
  }
  return MHD_YES;
}

static bool refuse(struct reply *reply, unsigned status, const char *code, const char *sentence) {
  reply_problem(reply, status, code, "%s", sentence);
  reply->close = true;
  return false;
}

bool guard_host_is_loopback(const char *authority) {
  char host[64];
  size_t length;
  const char *port;
  if (authority[0] == '[') {
    const char *end = strchr(authority, ']');
    if (!end) {
      return false;
    }
    length = (size_t)(end - authority) - 1;
    authority++;
    port = end + 1;
  } else {
    length = strcspn(authority, ":");
    port = authority + length;
  }
  if (length == 0 || length >= sizeof host ||
      (*port != '\0' && (*port != ':' || port[1 + strspn(port + 1, "0123456789")] != '\0'))) {
    return false;
  }
  memcpy(host, authority, length);
  host[length] = '\0';
  struct in_addr four;
  struct in6_addr six;
  if (inet_pton(AF_INET, host, &four) == 1) {
    return (ntohl(four.s_addr) >> 24) == 127;
  }
  if (inet_pton(AF_INET6, host, &six) == 1) {
    return IN6_IS_ADDR_LOOPBACK(&six);
  }
  return strcasecmp(host, "localhost") == 0;
}

static bool guard_framing(const struct header_scan *scan, const char *coding, struct reply *reply) {
  if (scan->bad_name || scan->bad_value) {
    return refuse(reply, 400, "malformed_header",
                  "A header name is not a token (a space before the colon?), or a value has a "
                  "control character.");
  }
  if (scan->lengths > 1 || scan->codings > 1 || (scan->lengths > 0 && scan->codings > 0)) {
    return refuse(reply, 400, "ambiguous_length",
                  "Content-Length and Transfer-Encoding: exactly one of them, once.");
  }
  if (scan->codings == 1 && (!coding || strcasecmp(coding, "chunked") != 0)) {
    return refuse(reply, 501, "unknown_transfer_coding",
                  "The only transfer coding that is understood is chunked.");
  }
  return true;
}

static bool guard_host(const struct request *request, const struct header_scan *scan,
                       const char *version, const char *host, struct reply *reply) {
  if (scan->hosts > 1 || (scan->hosts == 0 && strcmp(version, "HTTP/1.0") != 0)) {
    return refuse(reply, 400, "ambiguous_host", "A request needs exactly one Host header.");
  }
  const char *authority = request->url.authority;
  if (authority && host && strcasecmp(authority, host) != 0) {
    return refuse(reply, 421, "wrong_host", "The request target names another host than Host.");
  }
  if (request->service->loopback && host && !guard_host_is_loopback(host)) {
    return refuse(reply, 421, "wrong_host",
                  "This server listens on a loopback address and answers only requests for "
                  "localhost, 127.0.0.1 or [::1].");
  }
  return true;
}

/* A browser tells where a request comes from; other clients send neither header. */
static bool guard_origin(const struct request *request, const char *host, struct reply *reply) {
  const char *origin = request_header(request, "Origin");
  const char *site = request_header(request, "Sec-Fetch-Site");
  bool foreign = site && strcasecmp(site, "same-origin") != 0 && strcasecmp(site, "none") != 0;
  if (origin) {
    const char *rest = strstr(origin, "://"); /* a proxy may speak https for us */
    foreign = foreign || !host || !rest || strncasecmp(origin, "http", 4) != 0 ||
              strcasecmp(rest + 3, host) != 0;
  }
  if (foreign && request->method != HTTP_GET) {
    return refuse(reply, 403, "cross_origin",
                  "Requests that change something are accepted from this server's own pages only.");
  }
  return true;
}

bool guard_check(const struct request *request, const char *version, struct reply *reply) {
  struct header_scan scan = {0};
  MHD_get_connection_values_n(request->connection, MHD_HEADER_KIND, header_scan_one, &scan);
  const char *host = request_header(request, "Host");
  return guard_framing(&scan, request_header(request, "Transfer-Encoding"), reply) &&
         guard_host(request, &scan, version, host, reply) && guard_origin(request, host, reply);
}
