/* Who may come in: the rules that follow from where the daemon listens, and their use on a
 * request. The threat model is in docs/SECURITY.md. */
#ifndef PNEULAB_HTTP_ACCESS_H
#define PNEULAB_HTTP_ACCESS_H

#include "server/auth/limiter.h"
#include "server/auth/tokens.h"
#include "server/base/options.h"
#include "server/http/connections.h"
#include "server/http/service.h"

struct access {
  bool loopback;            /* listening on a loopback address */
  bool behind_proxy;        /* its X-Forwarded-For and X-Forwarded-Proto are believed */
  unsigned requests_open;   /* of one party at a time behind a proxy, else 0: any number */
  struct tls *tls;          /* NULL: the daemon itself does not speak TLS */
  const char *hosts;        /* names of --host, separated by commas; "" for none */
  struct tokens *tokens;    /* needed in each request, or by nobody */
  struct limiter *requests; /* of a token, else an address */
  struct limiter *failures; /* wrong tokens of an address */
};

/* Refuses (STATUS_INVALID) to listen on an address that others reach without TLS and without
 * --behind-proxy. *options must outlive *access, which is the caller's. */
enum status access_create(const struct options *options, struct access **access,
                          struct error *error);
void access_destroy(struct access *access);

/* Reads the certificate again and logs what came of it. */
void access_reload(struct access *access);

/* Finds out who sends the request: fills request->client, party and caller, with ROLE_NONE for
 * somebody unknown. When they ask too often, or for too much at a time: replies 429 and returns
 * false. `connection` is that of the request among `connections`. */
bool access_identify(struct request *request, struct connections *connections,
                     struct connection *connection, struct reply *reply);

/* Whether the caller has the role that the route asks for; otherwise replies 401, 403 or 429 and
 * returns false. */
bool access_allows(struct request *request, struct reply *reply);

/* Counts a wrong token of the request's client and logs it, without the token. When there were
 * too many: replies 429 and returns false. Right tokens are never kept waiting for wrong ones:
 * otherwise anybody could lock out those who share their address. */
bool access_note_failure(struct request *request, struct reply *reply);

/* Whether the caller's browser reached us, or the proxy, through TLS. */
bool access_is_secure(const struct request *request);

/* The name of the cookie that holds the token of a signed-in browser. A name that starts with
 * __Host- binds it to this host and to TLS. */
const char *access_cookie(const struct request *request);

#endif
