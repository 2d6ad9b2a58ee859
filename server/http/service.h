/* What every handler may use, and the form of requests and replies. */
#ifndef PNEULAB_HTTP_SERVICE_H
#define PNEULAB_HTTP_SERVICE_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "server/base/caller.h"
#include "server/exec/disk.h"
#include "server/exec/executor.h"
#include "server/http/url.h"
#include "server/store/store.h"

struct MHD_Connection;
struct analyst;
struct answer;
struct answers;
struct access;
struct feed;
struct conductor;
struct connections;
struct http_meter;
struct isolation;
struct job_reader;
struct models;
struct snapshots;
struct tables;
struct waiters;

enum { HTTP_BODY_MAX = 1 << 20, HTTP_WAIT_MAX_S = 60, CLIENT_SIZE = 46 };

/* Shared by all requests; everything pointed to outlives the server. */
struct service {
  struct store *store;
  struct executor *executor;   /* runs jobs */
  struct conductor *conductor; /* runs studies */
  struct disk *disk;
  struct waiters *waiters;
  struct snapshots *snapshots;       /* copies of the database */
  struct feed *feed;                 /* the stream of events */
  struct answers *answers;           /* kept answers */
  struct tables *tables;             /* kept tables of studies */
  struct analyst *analyst;           /* handles what takes long */
  struct models *models;             /* surrogates of studies */
  struct access *access;             /* who may come in */
  struct job_reader *reader;         /* checks job documents */
  const char *data;                  /* data directory */
  uint64_t memory_limit_bytes;       /* of a worker, 0: none */
  int64_t started_ms;                /* on the monotonic clock */
  atomic_bool draining;              /* no new jobs */
  struct http_meter *meter;          /* counts of requests */
  struct connections *connections;   /* of the server */
  const struct isolation *isolation; /* of workers */
};

enum http_method {
  HTTP_GET = 1,
  HTTP_POST = 2,
  HTTP_PATCH = 8,
  HTTP_DELETE = 4 /* bits, so that a set of them is a number */
};

struct request {
  struct service *service;
  struct MHD_Connection *connection;
  char client[CLIENT_SIZE]; /* numeric address of the client */
  char party[CLIENT_SIZE];  /* the same for limits: of IPv6 the network of 64 bits */
  struct caller caller;
  bool bad_token;          /* one was sent, but it is nobody's */
  const char *id;          /* of the request, for logs */
  unsigned route;          /* its number, see route.h */
  enum role least_role;    /* that the route asks for */
  enum http_method method; /* HEAD counts as GET: the body is left out while sending */
  char *target;            /* as received, then cut into pieces by url_parse */
  struct url url;
  const char *known_query;   /* names of the query parameters of the route, NULL: whatever */
  const char *parameters[2]; /* of the route, in order */
  int64_t job_id;  /* of the job that the request waits for; negative: of a copy or analysis */
  bool job_is_new; /* the request made that job: the reply says where it is */
  char *body;      /* NUL-terminated; NULL when empty */
  size_t body_size;
};

struct reply;
typedef void handler(struct request *request, struct reply *reply);

enum { REPLY_HEADERS_MAX = 4 };

/* A body without an end: read() fills a buffer as libmicrohttpd's readers do, done() is called once
 * when the reply is over. */
struct reply_stream {
  ssize_t (*read)(void *context, uint64_t position, char *buffer, size_t room);
  void (*done)(void *context);
  void *context;
};

/* What a handler fills in. Exactly one of the bodies is used. */
struct reply {
  unsigned status;
  const char *content_type;
  char *body;              /* malloc'd, taken over by the reply */
  const void *static_body; /* of the program itself */
  struct answer *kept;     /* a use of a kept answer, taken over */
  size_t size;
  int fd; /* -1, or an open file of `size` bytes, taken over */
  struct reply_stream stream;
  struct {
    const char *name;
    char value[200];
  } headers[REPLY_HEADERS_MAX];
  size_t header_count;
  bool close; /* end the connection afterwards */
  /* Instead of replying now: call `then` once the job is terminal (or, when negative, the copy of
   * the database with that ticket is made) or the time is over. */
  int64_t wait_job_id;
  int64_t wait_ms;
  handler *then;
};

/* ---- reply.c ----------------------------------------------------------------------------- */

void reply_init(struct reply *reply);
void reply_clear(struct reply *reply);

/* Sets a header, once each; the value is cut at its field's size. */
void reply_header(struct reply *reply, const char *name, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Replies with a JSON value, whose reference is taken over; NULL (no memory) becomes a 503. */
void reply_json(struct reply *reply, unsigned status, json_t *value);

/* Replies with text from the heap, taken over; NULL becomes a 503. */
void reply_text(struct reply *reply, const char *content_type, char *text, size_t size);

/* Replies with bytes of the program. */
void reply_static(struct reply *reply, const char *content_type, const void *data, size_t size);

/* Replies with a kept answer, whose use is taken over. */
void reply_kept(struct reply *reply, const char *content_type, struct answer *answer);

/* Replies with a regular file below a directory, as of file_open_below; 404 when it is missing. */
void reply_file(struct reply *reply, const char *content_type, const char *directory,
                const char *path);

/* The same with a file of a job, `path` being relative to the data directory: 410 with the reason
 * when the job's files were removed. */
void reply_job_file(const struct request *request, struct reply *reply, const char *content_type,
                    int64_t job_id, const char *path);

/* Replies with a stream; stream->done is called in any case. */
void reply_stream(struct reply *reply, const char *content_type, const struct reply_stream *stream);

/* Replies with an RFC 9457 problem of an HTTP status of its own. */
void reply_problem(struct reply *reply, unsigned status, const char *code, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* The 503 of a server that takes nothing any more. */
void reply_shutting_down(struct reply *reply);

/* A problem from a failure: the HTTP status follows from error->status. */
void reply_error(struct reply *reply, const struct error *error);

/* ---- request.c --------------------------------------------------------------------------- */

/* A request header, NULL when absent. Valid during the request. */
const char *request_header(const struct request *request, const char *name);

/* The first route parameter as a job id; otherwise replies 404 and returns false. */
bool request_id(const struct request *request, struct reply *reply, int64_t *id);

/* Whether every query parameter is one of request->known_query; otherwise replies 400 and returns
 * false. */
bool request_query_known(const struct request *request, struct reply *reply);

/* A whole number from the query within limits, `otherwise` when absent; replies 400 and returns
 * false when it is malformed. */
bool request_query_integer(const struct request *request, struct reply *reply, const char *name,
                           int64_t low, int64_t high, int64_t otherwise, int64_t *value);

/* The query parameter `name`, as in "jobs=1,2,3", as up to `limit` different ids; replies 400 and
 * returns false when it is missing or malformed. */
bool request_query_jobs(const struct request *request, struct reply *reply, const char *name,
                        size_t limit, int64_t *ids, size_t *count);

/* Seconds of "Prefer: wait=N", at most HTTP_WAIT_MAX_S, 0 when absent or malformed. */
int64_t request_wait_s(const struct request *request);

#endif
