/* What is noted of each request: for the log, and for the metrics of HTTP. */
#ifndef PNEULAB_HTTP_RECORD_H
#define PNEULAB_HTTP_RECORD_H

#include <stdio.h>

#include "server/http/service.h"

struct http_meter;

enum { RECORD_ID_SIZE = 40 };

/* One request. Zero is a valid start. */
struct record {
  char id[RECORD_ID_SIZE]; /* of the request, as answered in X-Request-Id */
  char *path;              /* as received, when requests are logged */
  char method[8];
  int64_t begun_us, answered_us; /* header complete; answer handed over */
  uint64_t size;                 /* bytes of the answer's body */
  unsigned status;               /* 0: the connection ended before there was an answer */
  bool waits;                    /* for a job or for events: no latency of the server */
};

/* The caller owns *meter. */
enum status http_meter_create(struct http_meter **meter, struct error *error);
void http_meter_destroy(struct http_meter *meter);

/* The request line is there: keeps its target. */
void record_target(struct record *record, const char *target);

/* The header is there. The id is the client's X-Request-Id when that is up to 36 letters, digits
 * or ._-, else a new one. */
void record_begin(struct record *record, const struct request *request, const char *method);

/* The answer is handed over. */
void record_answer(struct record *record, const struct reply *reply);

/* The request has ended: counts and logs it, and releases what the record holds. */
void record_end(struct record *record, const struct request *request);

/* Writes the metrics of HTTP in the text form of Prometheus. */
void http_meter_write(const struct http_meter *meter, FILE *out);

#endif
