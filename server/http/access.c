#include "server/http/access.h"

#include <arpa/inet.h>
#include <math.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "server/base/log.h"
#include "server/http/guard.h"
#include "server/http/tls.h"

enum { PUBLIC_RATE_HZ = 100, BURST_S = 10, FAILURES_BURST = 10 };

/* Ten wrong tokens at once, then one in six seconds. */
static const double failure_rate_hz = 1.0 / 6;

/* ---- rules ------------------------------------------------------------------------------- */

static enum status listening_check(const struct options *options, bool loopback,
                                   struct error *error) {
  bool certificate = options->tls_certificate[0], key = options->tls_key[0];
  if (certificate != key) {
    return error_set(error, STATUS_INVALID, NULL,
                     "--tls-certificate and --tls-key belong together, for example "
                     "--tls-certificate fullchain.pem --tls-key privkey.pem.");
  }
  if (!loopback && !certificate && !options->behind_proxy) {
    return error_set(error, STATUS_INVALID, NULL,
                     "--listen %s: other machines can reach this address, so it needs "
                     "--tls-certificate FILE and --tls-key FILE, or --behind-proxy when a proxy "
                     "in front of it speaks TLS. Without --listen only this machine is served.",
                     options->listen.host);
  }
  return STATUS_OK;
}

enum status access_create(const struct options *options, struct access **access,
                          struct error *error) {
  const char *host = options->listen.host;
  bool loopback = guard_host_is_loopback(host) || strcmp(host, "::1") == 0;
  bool open = loopback && !options->behind_proxy && !options->tls_certificate[0];
  enum status status = listening_check(options, loopback, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct access *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the rules of access.");
  }
  made->loopback = loopback;
  made->behind_proxy = options->behind_proxy;
  made->requests_open = options->behind_proxy ? options->connections_per_address : 0;
  made->hosts = options->hosts;
  double rate_hz = options->request_rate_hz;
  if (rate_hz < 0) {
    rate_hz = open ? 0 : PUBLIC_RATE_HZ;
  }
  status = tokens_create(options->data, !open, &made->tokens, error);
  if (status == STATUS_OK) {
    status = limiter_create(rate_hz, BURST_S * rate_hz, &made->requests, error);
  }
  if (status == STATUS_OK) {
    status = limiter_create(failure_rate_hz, FAILURES_BURST, &made->failures, error);
  }
  if (status == STATUS_OK && options->tls_certificate[0]) {
    status = tls_create(options->tls_certificate, options->tls_key, &made->tls, error);
  }
  if (status != STATUS_OK) {
    access_destroy(made);
    return status;
  }
  *access = made;
  return STATUS_OK;
}

void access_destroy(struct access *access) {
  if (access) {
    tokens_destroy(access->tokens);
    limiter_destroy(access->requests);
    limiter_destroy(access->failures);
    tls_destroy(access->tls);
    free(access);
  }
}

void access_reload(struct access *access) {
  struct error error;
  if (!access->tls) {
    return;
  }
  if (tls_reload(access->tls, &error) == STATUS_OK) {
    log_line("the certificate was read again");
  } else {
    log_line("the certificate stays as it was: %s", error.message);
  }
}

/* ---- who it is --------------------------------------------------------------------------- */

static enum MHD_Result take_last(void *context, enum MHD_ValueKind kind, const char *name,
                                 const char *value) {
  const char **last = context;
  (void)kind;
  if (value && strcasecmp(name, "X-Forwarded-For") == 0) {
    *last = value;
  }
  return MHD_YES;
}

/* The address that the proxy saw: the last one of the last header, which the proxy has added;
 * what comes before it is the client's word. NULL when there is none. */
static const char *forwarded_address(const struct request *request) {
  const char *value = NULL;
  MHD_get_connection_values(request->connection, MHD_HEADER_KIND, take_last, &value);
  const char *comma = value ? strrchr(value, ',') : NULL;
  value = comma ? comma + 1 : value;
  return value ? value + strspn(value, " \t") : NULL;
}

/* The address of the other end of the connection as text. */
static void peer_address(const struct request *request, char client[CLIENT_SIZE]) {
  const union MHD_ConnectionInfo *info =
      MHD_get_connection_info(request->connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
  const struct sockaddr *address = info ? info->client_addr : NULL;
  strcpy(client, "unknown");
  if (address && address->sa_family == AF_INET) {
    inet_ntop(AF_INET, &((const struct sockaddr_in *)(const void *)address)->sin_addr, client,
              CLIENT_SIZE);
  } else if (address && address->sa_family == AF_INET6) {
    inet_ntop(AF_INET6, &((const struct sockaddr_in6 *)(const void *)address)->sin6_addr, client,
              CLIENT_SIZE);
  }
}

/* An address as a party of the limits: of IPv6 the network, since one host has 2^64 addresses. */
static void address_party(const char *client, char party[CLIENT_SIZE]) {
  struct in6_addr six;
  snprintf(party, CLIENT_SIZE, "%s", client);
  if (inet_pton(AF_INET6, client, &six) == 1 && !IN6_IS_ADDR_V4MAPPED(&six)) {
    memset(six.s6_addr + 8, 0, 8);
    inet_ntop(AF_INET6, &six, party, CLIENT_SIZE);
  }
}

/* The secret that the request carries, NULL when it has none. */
static const char *request_secret(const struct request *request) {
  const char *value = request_header(request, "Authorization");
  if (value && strncasecmp(value, "Bearer ", 7) == 0) {
    return value + 7 + strspn(value + 7, " ");
  }
  return MHD_lookup_connection_value(request->connection, MHD_COOKIE_KIND, access_cookie(request));
}

/* Fills request->client and request->party. */
static void identify_address(struct request *request) {
  const char *forwarded =
      request->service->access->behind_proxy ? forwarded_address(request) : NULL;
  unsigned char raw[16];
  if (forwarded && strlen(forwarded) < CLIENT_SIZE &&
      (inet_pton(AF_INET, forwarded, raw) == 1 || inet_pton(AF_INET6, forwarded, raw) == 1)) {
    strcpy(request->client, forwarded);
  } else {
    peer_address(request, request->client);
  }
  address_party(request->client, request->party);
}

static void reply_too_many(struct reply *reply, const char *what, const char *party,
                           double wait_s) {
  reply_problem(reply, 429, "too_many_requests", "%s (%s). Try again in %.0f s.", what, party,
                ceil(wait_s));
  reply_header(reply, "Retry-After", "%.0f", ceil(wait_s));
}

bool access_identify(struct request *request, struct connections *connections,
                     struct connection *connection, struct reply *reply) {
  struct access *access = request->service->access;
  const char *name = request->caller.name;
  double wait_s;
  identify_address(request);
  if (!tokens_required(access->tokens)) {
    request->caller.role = ROLE_ADMIN;
  } else {
    const char *secret = request_secret(request);
    request->bad_token = secret && !tokens_check(access->tokens, secret, &request->caller);
  }
  if (!limiter_take(access->requests, name[0] ? name : request->party, &wait_s)) {
    reply_too_many(reply, "There are more requests than --request-rate allows",
                   name[0] ? name : request->party, wait_s);
    return false;
  }
  if (access->requests_open > 0 &&
      connections_party(connections, connection, request->party) > access->requests_open) {
    reply_too_many(reply, "There are more requests at a time than --connections-per-address allows",
                   request->party, 1);
    return false;
  }
  return true;
}

/* ---- what they may do -------------------------------------------------------------------- */

bool access_note_failure(struct request *request, struct reply *reply) {
  double wait_s;
  if (limiter_take(request->service->access->failures, request->party, &wait_s)) {
    log_line("a wrong token from %s", request->client);
    return true;
  }
  reply_too_many(reply, "Too many wrong tokens were sent", request->party, wait_s);
  return false;
}

bool access_allows(struct request *request, struct reply *reply) {
  if (request->caller.role >= request->least_role) {
    return true;
  }
  if (request->caller.role != ROLE_NONE) {
    reply_problem(
        reply, 403, "forbidden", "The token %s has the role %s; this needs the role %s or more.",
        request->caller.name, role_word(request->caller.role), role_word(request->least_role));
    return false;
  }
  if (request->bad_token && !access_note_failure(request, reply)) {
    return false;
  }
  reply_problem(reply, 401, "unauthorized",
                "%s Send a token of the role %s or more as `Authorization: Bearer TOKEN`, or sign "
                "in at /sign-in; `pneulabd token add NAME` makes one.",
                request->bad_token ? "The token is not valid." : "This needs a token.",
                role_word(request->least_role));
  reply_header(reply, "WWW-Authenticate", "Bearer realm=\"pneulab\"%s",
               request->bad_token ? ", error=\"invalid_token\"" : "");
  return false;
}

bool access_is_secure(const struct request *request) {
  const struct access *access = request->service->access;
  const char *scheme = access->behind_proxy ? request_header(request, "X-Forwarded-Proto") : NULL;
  return access->tls || (scheme && strcasecmp(scheme, "https") == 0);
}

const char *access_cookie(const struct request *request) {
  return access_is_secure(request) ? "__Host-pneulab" : "pneulab";
}
