#include "server/http/server.h"

#include <microhttpd.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/http/access.h"
#include "server/http/analyst.h"
#include "server/http/answers.h"
#include "server/http/connections.h"
#include "server/http/feed.h"
#include "server/http/guard.h"
#include "server/http/headers.h"
#include "server/http/listen.h"
#include "server/http/record.h"
#include "server/http/route.h"
#include "server/http/snapshots.h"
#include "server/http/waiters.h"

enum {
  TICK_MS = 200,
  LAST_ANSWERS_MS = 1000,
  STREAM_BLOCK = 4096,
  TARGET_MAX = 65536, /* more than libmicrohttpd takes */
  /* Bodies over the limit are read to their end, so that the client sees the answer, unless they
   * are longer than this. */
  BODY_DISCARD_MAX = 16 << 20
};

struct server {
  struct service *service;
  struct connections *connections;
  struct MHD_Daemon *daemon;
  pthread_t ticker;
  pthread_mutex_t mutex; /* guards stopping */
  pthread_cond_t stop;
  bool stopping, ticking;
};

/* A request while libmicrohttpd delivers it in pieces. */
struct exchange {
  struct request request;
  struct connections *connections;
  struct reply reply; /* prepared before the body has been read, if status is not 0 */
  struct record record;
  handler *handle;
  size_t body_room, received;
  uintptr_t target_at; /* where libmicrohttpd keeps the target that request.target copies */
  enum { EXCHANGE_NEW, EXCHANGE_BODY, EXCHANGE_WAITING } phase;
  bool last; /* the connection ends with it */
};

void server_job_changed(struct service *service, int64_t job_id) {
  struct job_record record;
  if (!waiters_want(service->waiters, job_id) ||
      store_job(service->store, job_id, &record, NULL) != STATUS_OK) {
    return;
  }
  if (job_state_terminal(record.state)) {
    waiters_job_ended(service->waiters, job_id);
  }
  job_record_clear(&record);
}

static struct connection *exchange_connection(const struct exchange *exchange) {
  const union MHD_ConnectionInfo *info =
      MHD_get_connection_info(exchange->request.connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
  return info ? info->socket_context : NULL;
}

/* ---- sending ----------------------------------------------------------------------------- */

static struct MHD_Response *response_make(struct reply *reply) {
  struct MHD_Response *response;
  if (reply->stream.read) {
    response = MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, STREAM_BLOCK, reply->stream.read,
                                                 reply->stream.context, reply->stream.done);
    reply->stream.done = response ? NULL : reply->stream.done;
  } else if (reply->kept) {
    response = MHD_create_response_from_buffer_with_free_callback(
        reply->kept->size, reply->kept->text, answer_release);
    reply->kept = response ? NULL : reply->kept;
  } else if (reply->fd >= 0) {
    response = MHD_create_response_from_fd(reply->size, reply->fd);
    reply->fd = response ? -1 : reply->fd;
  } else if (reply->body) {
    response = MHD_create_response_from_buffer(reply->size, reply->body, MHD_RESPMEM_MUST_FREE);
    reply->body = response ? NULL : reply->body;
  } else {
    response = MHD_create_response_from_buffer(reply->size, (void *)(uintptr_t)reply->static_body,
                                               MHD_RESPMEM_PERSISTENT);
  }
  return response;
}

static enum MHD_Result reply_send(struct exchange *exchange, struct reply *reply) {
  struct MHD_Response *response = response_make(reply);
  if (!response) {
    reply_clear(reply);
    return MHD_NO;
  }
  reply->close = reply->close || exchange->last;
  headers_add(response, reply);
  MHD_add_response_header(response, "X-Request-Id", exchange->record.id);
  enum MHD_Result result =
      MHD_queue_response(exchange->request.connection, reply->status, response);
  MHD_destroy_response(response);
  if (reply->stream.read) {
    connections_phase(exchange->connections, exchange_connection(exchange), CONNECTION_STREAM);
  }
  record_answer(&exchange->record, reply);
  reply_clear(reply);
  return result;
}

/* ---- receiving --------------------------------------------------------------------------- */

/* Whether a NUL byte hides the rest of the target: then the version, which follows it in the same
 * buffer, is further away than the target is long. */
static bool target_is_cut(const struct exchange *exchange, const char *version) {
  uintptr_t distance = (uintptr_t)version - exchange->target_at;
  return distance < TARGET_MAX && distance != strlen(exchange->request.target) + 1;
}

/* Understands the header: fills exchange->handle, or prepares the reply that refuses it. */
static void exchange_open(struct exchange *exchange, const char *method, const char *version) {
  struct request *request = &exchange->request;
  struct reply *reply = &exchange->reply;
  reply_init(reply);
  if (strcmp(method, "GET") == 0 || strcmp(method, "HEAD") == 0) {
    request->method = HTTP_GET;
  } else if (strcmp(method, "POST") == 0) {
    request->method = HTTP_POST;
  } else if (strcmp(method, "PATCH") == 0) {
    request->method = HTTP_PATCH;
  } else if (strcmp(method, "DELETE") == 0) {
    request->method = HTTP_DELETE;
  }
  const char *problem = target_is_cut(exchange, version)
                            ? "The request target has a NUL byte."
                            : url_parse(request->target, &request->url);
  if (problem) {
    reply_problem(reply, 400, "malformed_target", "%s", problem);
    reply->close = true;
    return;
  }
  if (!guard_check(request, method, version, reply) ||
      !access_identify(request, exchange->connections, exchange_connection(exchange), reply)) {
    return;
  }
  /* libmicrohttpd is lenient with the ends of chunks: what follows them is not read as a request.
   */
  exchange->last = request_header(request, "Transfer-Encoding") != NULL;
  exchange->handle = route_find(request, reply);
  if (exchange->handle && !access_allows(request, reply)) {
    exchange->handle = NULL;
  }
  const char *length = request_header(request, "Content-Length");
  if (exchange->handle && length && strtoull(length, NULL, 10) > HTTP_BODY_MAX) {
    exchange->handle = NULL;
    reply_problem(reply, 413, "too_large", "The body may have at most %d bytes.", HTTP_BODY_MAX);
    reply->close = true;
  }
}

/* Whether the refusal has to be sent before the body: when the client waits for a go-ahead, when
 * its length cannot be trusted, or when it is too long to be thrown away. */
static bool exchange_refuse_now(const struct exchange *exchange) {
  const char *length = request_header(&exchange->request, "Content-Length");
  const char *expect = request_header(&exchange->request, "Expect");
  return !exchange->handle && (expect || exchange->reply.status != 413 ||
                               (length && strtoull(length, NULL, 10) > BODY_DISCARD_MAX));
}

/* Takes a piece of the body; MHD_NO ends the connection. */
static enum MHD_Result exchange_body(struct exchange *exchange, const char *data, size_t *size) {
  struct request *request = &exchange->request;
  exchange->received += *size;
  if (exchange->received > BODY_DISCARD_MAX) {
    return MHD_NO;
  }
  if (exchange->handle && exchange->received > HTTP_BODY_MAX) {
    exchange->handle = NULL;
    reply_problem(&exchange->reply, 413, "too_large", "The body may have at most %d bytes.",
                  HTTP_BODY_MAX);
    exchange->reply.close = true;
  }
  if (exchange->handle) {
    if (exchange->received + 1 > exchange->body_room) {
      size_t room = 2 * (exchange->received + 1);
      char *grown = realloc(request->body, room);
      if (!grown) {
        return MHD_NO;
      }
      request->body = grown;
      exchange->body_room = room;
    }
    memcpy(request->body + request->body_size, data, *size);
    request->body_size += *size;
    request->body[request->body_size] = '\0';
  }
  *size = 0;
  return MHD_YES;
}

/* Suspends the connection until the job that the reply waits for has ended. */
static enum MHD_Result exchange_wait(struct exchange *exchange, const struct reply *reply) {
  struct service *service = exchange->request.service;
  struct MHD_Connection *connection = exchange->request.connection;
  int64_t job_id = reply->wait_job_id;
  exchange->phase = EXCHANGE_WAITING;
  exchange->record.waits = true;
  exchange->handle = reply->then;
  MHD_suspend_connection(connection);
  if (!waiters_add(service->waiters, connection, job_id, reply->wait_ms)) {
    MHD_resume_connection(connection);
    return MHD_YES;
  }
  /* From here on another thread may resume and even finish the exchange. */
  if (job_id < 0) {
    if (snapshots_done(service->snapshots, -job_id) || analyst_done(service->analyst, job_id)) {
      waiters_job_ended(service->waiters, job_id);
    }
    return MHD_YES;
  }
  struct job_record record;
  bool gone = store_job(service->store, job_id, &record, NULL) != STATUS_OK;
  if (gone || job_state_terminal(record.state)) {
    waiters_job_ended(service->waiters, job_id);
  }
  if (!gone) {
    job_record_clear(&record);
  }
  return MHD_YES;
}

static enum MHD_Result exchange_answer(struct exchange *exchange) {
  struct reply reply;
  if (!exchange->handle) {
    return reply_send(exchange, &exchange->reply);
  }
  reply_init(&reply);
  if (request_query_known(&exchange->request, &reply)) {
    exchange->handle(&exchange->request, &reply);
  }
  if (reply.wait_job_id != 0) {
    return exchange_wait(exchange, &reply);
  }
  return reply_send(exchange, &reply);
}

static enum MHD_Result server_handle(void *context, struct MHD_Connection *connection,
                                     const char *url, const char *method, const char *version,
                                     const char *data, size_t *size, void **state) {
  struct server *server = context;
  struct exchange *exchange = *state;
  (void)url; /* the target as received is in the exchange */
  if (!exchange) {
    return MHD_NO;
  }
  if (exchange->phase == EXCHANGE_NEW) {
    exchange->phase = EXCHANGE_BODY;
    exchange->request.connection = connection;
    exchange->request.service = server->service;
    exchange->connections = server->connections;
    exchange->request.id = exchange->record.id;
    record_begin(&exchange->record, &exchange->request, method);
    exchange_open(exchange, method, version);
    connections_phase(server->connections, exchange_connection(exchange), CONNECTION_BODY);
    return exchange_refuse_now(exchange) ? reply_send(exchange, &exchange->reply) : MHD_YES;
  }
  if (*size > 0) {
    return exchange_body(exchange, data, size);
  }
  if (exchange->phase == EXCHANGE_BODY) {
    connections_phase(server->connections, exchange_connection(exchange), CONNECTION_ANSWER);
  }
  return exchange_answer(exchange);
}

/* Called with the request line: the exchange starts here, with the target as it was sent. */
static void *server_note_target(void *context, const char *target,
                                struct MHD_Connection *connection) {
  (void)context;
  (void)connection;
  struct exchange *exchange = calloc(1, sizeof *exchange);
  if (exchange) {
    reply_init(&exchange->reply);
    exchange->target_at = (uintptr_t)target;
    record_target(&exchange->record, target);
    exchange->request.target = strdup(target);
    if (!exchange->request.target) {
      free(exchange->record.path);
      free(exchange);
      exchange = NULL;
    }
  }
  return exchange;
}

static void server_completed(void *context, struct MHD_Connection *connection, void **state,
                             enum MHD_RequestTerminationCode code) {
  struct server *server = context;
  struct exchange *exchange = *state;
  (void)code;
  if (!exchange) {
    return;
  }
  exchange->request.connection = connection;
  connections_phase(server->connections, exchange_connection(exchange), CONNECTION_HEADER);
  record_end(&exchange->record, &exchange->request);
  reply_clear(&exchange->reply);
  free(exchange->request.body);
  free(exchange->request.target);
  free(exchange);
  *state = NULL;
}

static void server_connection(void *context, struct MHD_Connection *connection,
                              void **socket_context, enum MHD_ConnectionNotificationCode code) {
  struct server *server = context;
  if (code == MHD_CONNECTION_NOTIFY_STARTED) {
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    *socket_context = info ? connections_add(server->connections, info->connect_fd) : NULL;
  } else {
    connections_remove(server->connections, *socket_context);
    *socket_context = NULL;
  }
}

/* ---- life -------------------------------------------------------------------------------- */

static void *server_tick(void *context) {
  struct server *server = context;
  pthread_mutex_lock(&server->mutex);
  while (!server->stopping) {
    struct timespec until = clock_deadline(TICK_MS);
    pthread_cond_timedwait(&server->stop, &server->mutex, &until);
    pthread_mutex_unlock(&server->mutex);
    waiters_expire(server->service->waiters, false);
    connections_expire(server->connections);
    tokens_refresh(server->service->access->tokens);
    pthread_mutex_lock(&server->mutex);
  }
  pthread_mutex_unlock(&server->mutex);
  return NULL;
}

enum status server_create(const struct options *options, struct service *service,
                          struct server **server, struct error *error) {
  struct server *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the server.");
  }
  made->service = service;
  pthread_mutex_init(&made->mutex, NULL);
  clock_condition_init(&made->stop);
  struct connection_times times = {.header_ms = (int64_t)(1000 * options->header_timeout_s),
                                   .body_ms = (int64_t)(1000 * options->body_timeout_s)};
  enum status status = connections_create(&times, service->access->tls, &made->connections, error);
  service->connections = made->connections; /* before the first request can come */
  if (status == STATUS_OK) {
    struct listen_calls calls = {.context = made,
                                 .handle = server_handle,
                                 .note_target = server_note_target,
                                 .completed = server_completed,
                                 .connection = server_connection};
    status = listen_start(options, &calls, &made->daemon, error);
  }
  if (status == STATUS_OK && pthread_create(&made->ticker, NULL, server_tick, made) != 0) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "Cannot start a thread.");
  }
  made->ticking = status == STATUS_OK;
  if (status != STATUS_OK) {
    server_destroy(made);
    return status;
  }
  *server = made;
  return STATUS_OK;
}

uint16_t server_port(const struct server *server) {
  const union MHD_DaemonInfo *info = MHD_get_daemon_info(server->daemon, MHD_DAEMON_INFO_BIND_PORT);
  return info ? info->port : 0;
}

void server_stop_accepting(struct server *server) {
  MHD_socket listening = MHD_quiesce_daemon(server->daemon);
  if (listening != MHD_INVALID_SOCKET) {
    close(listening);
  }
}

/* Answers those who still wait for a job, ends the streams of events, and gives all open requests a
 * moment to be answered. */
static void server_answer_waiting(struct server *server) {
  struct timespec pause = {.tv_nsec = 10000000};
  waiters_expire(server->service->waiters, true);
  feed_close(server->service->feed);
  for (int i = 0; i < LAST_ANSWERS_MS / 10 && connections_busy(server->connections) > 0; i++) {
    nanosleep(&pause, NULL);
  }
}

void server_destroy(struct server *server) {
  if (!server) {
    return;
  }
  if (server->ticking) {
    pthread_mutex_lock(&server->mutex);
    server->stopping = true;
    pthread_cond_broadcast(&server->stop);
    pthread_mutex_unlock(&server->mutex);
    pthread_join(server->ticker, NULL);
  }
  if (server->daemon) {
    server_answer_waiting(server);
    MHD_stop_daemon(server->daemon);
  }
  connections_destroy(server->connections);
  pthread_cond_destroy(&server->stop);
  pthread_mutex_destroy(&server->mutex);
  free(server);
}
