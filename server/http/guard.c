#include "server/http/guard.h"

#include <arpa/inet.h>
#include <microhttpd.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>

#include "server/http/access.h"

/* libmicrohttpd keeps the header as it came, in one piece, with NUL for each colon and line end. So
 * where a value does not follow its name, or the next name is not two bytes after the value, the
 * lines were not what they seem: ended by a bare LF, folded (which 0.9.75 mixes up), or cut by NUL.
 * Others may have read them differently. */
enum { HEADER_MAX = 65536 /* more than libmicrohttpd takes */ };

struct header_scan {
  const char *expected; /* where the next name has to be */
  unsigned hosts, lengths, codings, credentials;
  bool bad_name, bad_value, bad_line;
};

static bool name_is_token(const char *name) {
  static const char token[] = "!#$%&'*+-.^_`|~0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                              "abcdefghijklmnopqrstuvwxyz";
  return name[0] != '\0' && name[strspn(name, token)] == '\0';
}

/* Whether name and value are two parts of one line that begins where the line before it ended. */
static bool line_is_whole(const char *expected, const char *name, size_t name_size,
                          const char *value, size_t value_size) {
  uintptr_t between = (uintptr_t)value - ((uintptr_t)name + name_size + 1);
  if (name != expected || between > HEADER_MAX) {
    return false;
  }
  for (const char *at = name + name_size + 1; at < value; at++) {
    if (*at != ' ' && *at != '\t') {
      return false;
    }
  }
  char last = value[value_size + 1]; /* that of the line end */
  return last == '\0' || last == '\n';
}

static enum MHD_Result header_scan_one(void *context, enum MHD_ValueKind kind, const char *name,
                                       size_t name_size, const char *value, size_t value_size) {
  struct header_scan *scan = context;
  (void)kind;
  scan->bad_line = scan->bad_line || !value ||
                   !line_is_whole(scan->expected, name, name_size, value, value_size);
  scan->expected = value ? value + value_size + 2 : NULL;
  scan->hosts += strcasecmp(name, "Host") == 0;
  scan->lengths += strcasecmp(name, "Content-Length") == 0;
  scan->codings += strcasecmp(name, "Transfer-Encoding") == 0;
  scan->credentials += strcasecmp(name, "Authorization") == 0;
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
  if (scan->bad_line) {
    return refuse(reply, 400, "malformed_header",
                  "A line of the header is folded, has a NUL byte or no name, or does not end "
                  "with CR LF.");
  }
  if (scan->bad_name || scan->bad_value) {
    return refuse(reply, 400, "malformed_header",
                  "A header name is not a token (a space before the colon?), or a value has a "
                  "control character.");
  }
  if (scan->credentials > 1) {
    return refuse(reply, 400, "ambiguous_credentials", "Authorization may be given once.");
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

/* Whether a name of --host is that of the authority, apart from its port. */
static bool host_is_named(const char *hosts, const char *authority) {
  size_t length = authority[0] == '[' ? strcspn(authority, "]") + 1 : strcspn(authority, ":");
  while (*hosts) {
    size_t name = strcspn(hosts, ",");
    if (name == length && strncasecmp(hosts, authority, name) == 0) {
      return authority[length] == '\0' ||
             (authority[length] == ':' &&
              authority[length + 1 + strspn(authority + length + 1, "0123456789")] == '\0');
    }
    hosts += name + (hosts[name] == ',');
  }
  return false;
}

/* A name that was rebound to our address is refused where we know our names. Without --host a
 * server that others reach does not know them; there every request needs a token. */
static bool host_is_ours(const struct access *access, const char *authority) {
  return host_is_named(access->hosts, authority) ||
         (access->loopback ? guard_host_is_loopback(authority) : access->hosts[0] == '\0');
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
  if (host && !host_is_ours(request->service->access, host)) {
    return refuse(reply, 421, "wrong_host",
                  "This server answers requests for the names given with --host and, on a loopback "
                  "address, for localhost, 127.0.0.1 or [::1].");
  }
  return true;
}

/* Whether the origin that a browser names is this server. A proxy may speak https for us. */
static bool origin_is_ours(const struct request *request, const char *origin, const char *host) {
  const char *rest = strncasecmp(origin, "https://", 8) == 0  ? origin + 8
                     : strncasecmp(origin, "http://", 7) == 0 ? origin + 7
                                                              : NULL;
  bool secure = rest == origin + 8;
  return host && rest && strcasecmp(rest, host) == 0 && (secure || !access_is_secure(request));
}

/* A browser tells where a request comes from; other clients send neither header. Pages of other
 * origins may lead here, but neither change anything nor load something of ours into themselves. */
static bool guard_origin(const struct request *request, const char *host, struct reply *reply) {
  const char *origin = request_header(request, "Origin");
  const char *site = request_header(request, "Sec-Fetch-Site");
  const char *mode = request_header(request, "Sec-Fetch-Mode");
  bool foreign = (site && strcasecmp(site, "same-origin") != 0 && strcasecmp(site, "none") != 0) ||
                 (origin && !origin_is_ours(request, origin, host));
  bool navigates = request->method == HTTP_GET && mode && strcasecmp(mode, "navigate") == 0;
  if (foreign && !navigates) {
    return refuse(reply, 403, "cross_origin",
                  "A browser's requests are accepted from this server's own pages only; pages of "
                  "other origins may link here.");
  }
  if (request->method != HTTP_GET && !origin && !site && request_header(request, "Cookie")) {
    return refuse(reply, 403, "cross_origin",
                  "A request that changes something and carries a cookie must name its Origin.");
  }
  return true;
}

/* Whether the header ends with CR LF right after its last line. A line that begins with a colon
 * ends it for libmicrohttpd, too: what follows would be a request of its own. */
static bool end_is_blank(const struct request *request, const char *method, const char *expected) {
  const union MHD_ConnectionInfo *info =
      MHD_get_connection_info(request->connection, MHD_CONNECTION_INFO_REQUEST_HEADER_SIZE);
  return info && expected && method + info->header_size == expected + 2 && expected[1] == '\0';
}

bool guard_check(const struct request *request, const char *method, const char *version,
                 struct reply *reply) {
  struct header_scan scan = {.expected = version + strlen(version) + 2};
  MHD_get_connection_values_n(request->connection, MHD_HEADER_KIND, header_scan_one, &scan);
  scan.bad_line = scan.bad_line || !end_is_blank(request, method, scan.expected);
  const char *host = request_header(request, "Host");
  return guard_framing(&scan, request_header(request, "Transfer-Encoding"), reply) &&
         guard_host(request, &scan, version, host, reply) && guard_origin(request, host, reply);
}
