/* Memory that runs out at every allocation while a job is read and submitted: a plain answer, no
 * crash, no leak (the sanitizer's), a sound database, and the next job is taken. NO_MEMORY_STRIDE:
 * how many allocations to go on from one to the next, 1 for all of them. */
#include <arpa/inet.h>
#include <errno.h>
#include <ftw.h>
#include <pthread.h>
#include <signal.h>
#include <sqlite3.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "server/auth/token_file.h"
#include "server/daemon.h"
#include "solver/job/embed.h"
#include "solver/job/spec.h"
#include "tests/unit/no_memory.h"

#define ACTUATOR                                                                                   \
  "{\"family\": \"pneunet\", \"length\": \"60 mm\", \"width\": \"20 mm\", \"height\": \"15 mm\","  \
  " \"chambers\": [{\"config\": \"B\", \"count\": 4}], \"side_wall\": \"2 mm\", \"top_wall\":"     \
  " \"2 mm\", \"bottom_layer\": \"4 mm\"}"
#define RESPONSE                                                                                   \
  "{\"kind\": \"response\", \"labels\": {\"paper\": \"x\"}, \"actuator\": " ACTUATOR               \
  ", \"material\": \"dragon-skin-20\", \"load\": {\"pressure\": {\"to\": \"30 kPa\", \"steps\":"   \
  " 6}}}"

#define BELLOWS                                                                                    \
  "{\"family\": \"frustum-bellows\", \"outer_diameter\": \"40 mm\", \"wall\": \"2 mm\","           \
  " \"snapping_angle\": \"40 deg\", \"supporting_angle\": \"55 deg\", \"pet_thickness\":"          \
  " \"0.25 mm\", \"snapping_slant\": \"5 mm\"}"
#define MODEL                                                                                      \
  "\"model\": {\"mass\": \"2 kg\", \"gamma\": \"0.4 N/kPa\", \"modes\": {\"free\":"                \
  " {\"stiffness\": \"400 N/m\", \"damping\": \"8 N s/m\", \"alpha\": \"-4 1/s\", \"beta\":"       \
  " \"4 1/s\"}}}, \"initial\": {\"mode\": \"free\"}"
#define HELD                                                                                       \
  "{\"kind\": \"hlpv\", " MODEL                                                                    \
  ", \"input\": {\"hold\": [[\"0 s\", \"20 kPa\"]]}, \"end\": \"2 s\"}"
#define SPREAD(sampling, more)                                                                     \
  "{\"kind\": \"study\", \"base\": " HELD ", \"sampling\": \"" sampling "\", \"size\": 2,"         \
  " \"parameters\": [{\"pointer\": \"/model/mass\", \"from\": \"1 kg\", \"to\": \"2 kg\"},"        \
  " {\"pointer\": \"/tolerance\", \"values\": [1e-6, 1e-7]}]" more "}"

static const struct {
  const char *name, *text;
  enum status status;
} documents[] = {
    {"response", RESPONSE, STATUS_OK},
    {"study",
     "{\"kind\": \"study\", \"base\": " RESPONSE ", \"sampling\": \"list\", \"designs\": [{\"set\":"
     " {\"/actuator/taper\": {\"top\": \"1 deg\"}}}]}",
     STATUS_OK},
    {"fit",
     "{\"kind\": \"fit-material\", \"model\": \"yeoh\", \"data\": {\"csv\": \"e,s\\n0,0\\n10,23\\n"
     "25,52\\n40,81\\n55,114\\n\"}, \"columns\": {\"strain\": {\"name\": \"e\", \"unit\": \"%\"},"
     " \"stress\": {\"name\": \"s\", \"unit\": \"kPa\"}}}",
     STATUS_OK},
    {"hlpv", HELD, STATUS_OK},
    {"motion",
     "{\"kind\": \"snap\", \"actuator\": " BELLOWS ", \"silicone\": {\"model\": \"neo-hooke\","
     " \"mu\": \"0.19 MPa\"}, \"load\": {\"law\": [\"0 kPa\", \"60 kPa\"]}, \"dynamics\":"
     " {\"pairs\": 3, \"pair_mass\": \"12 g\", \"plate_mass\": \"30 g\", \"damping\": \"2 N s/m\","
     " \"pneumatics\": {\"supply\": \"direct\"}}}",
     STATUS_OK},
    {"control",
     "{\"kind\": \"hlpv\", " MODEL ", \"control\": {\"reference\": {\"hold\": [[\"0 s\","
     " \"4 mm\"]]}, \"saturation\": [\"-5 psi\", \"8 psi\"]}, \"end\": \"2 s\"}",
     STATUS_OK},
    {"hypercube", SPREAD("latin-hypercube", ""), STATUS_OK},
    {"sequence",
     SPREAD("sobol", ", \"constraints\": [{\"sum\": {\"/model/mass\": 1}, \"at_most\": \"3 kg\"}]"),
     STATUS_OK},
    {"identification",
     "{\"kind\": \"identify\", \"data\": {\"csv\": "
     "\"t,u,h,p\\n0,9,0,0\\n1,9,3,3\\n2,9,5,5\\n3,9,7,7\\n"
     "4,9,8,8\\n5,9,9,9\\n6,9,9,9\\n7,9,9,9\\n8,9,9,9\\n9,9,9,9\\n10,9,9,9\\n11,9,9,9\\n12,9,9,"
     "9\\n13,9,9,9\\n\"}, \"columns\": {\"time\": "
     "{\"name\": \"t\","
     " \"unit\": \"s\"}, \"set_point\": {\"name\": \"u\", \"unit\": \"kPa\"}, \"h\": {\"name\": "
     "\"h\","
     " \"unit\": \"mm\"}, \"pressure\": {\"name\": \"p\", \"unit\": \"kPa\"}}, \"modes\": "
     "[{\"name\":"
     " \"free\", \"rest\": \"0 mm\"}]}",
     STATUS_OK},
    {"unknown word", "{\"kind\": \"verify\", \"case\": \"elastca\"}", STATUS_INVALID},
    {"missing key", "{\"kind\": \"response\", \"actuator\": " ACTUATOR "}", STATUS_INVALID},
    {"wrong unit", "{\"kind\": \"verify\", \"case\": \"elastica\", \"timeout\": \"5 mm\"}",
     STATUS_INVALID},
    {"surface",
     "{\"kind\": \"grasp\", \"actuator\": " ACTUATOR ", \"material\": \"dragon-skin-20\", \"load\":"
     " {\"pressure\": {\"to\": \"30 kPa\"}}, \"object\": {\"shape\": {\"form\": \"surface\", "
     "\"stl\":"
     " {\"base64\": \""
     "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"
     "AAAAAAAAAAAAAAAAAAAAAAAEAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAIEEAAAAAAAAgQQAA"
     "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAACBBAAAAAAAAAAAAAAAAAAAAAAAAIEEAAAAAAAAA"
     "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAgQQAAAAAAACBBAAAAAAAAAAAAAAAAAAAAAAAAAAAgQQAA"
     "AAAAAAAAAAAAAAAAIEEAAAAAAAAAAAAAAAAAACBBAAA="
     "\"}}, \"position\": [\"45 mm\", 0, \"-30 mm\"], \"friction\": 0.5}, \"grasp\": {\"pull\":"
     " {\"direction\": [1, 0, 0], \"distance\": \"10 mm\"}}}",
     STATUS_OK},
    {"impossible body",
     "{\"kind\": \"response\", \"actuator\": {\"family\": \"pneunet\", \"length\": \"60 mm\","
     " \"width\": \"3 mm\", \"height\": \"15 mm\", \"chambers\": [{\"config\": \"B\", \"count\":"
     " 4}], \"side_wall\": \"2 mm\", \"top_wall\": \"2 mm\", \"bottom_layer\": \"4 mm\"},"
     " \"material\": \"dragon-skin-20\", \"load\": {\"pressure\": {\"to\": \"30 kPa\"}}}",
     STATUS_GEOMETRY},
    {"no JSON", "{\"kind\": \"verify\", \"case\": oops}", STATUS_SYNTAX},
};

static char directory[] = "/tmp/no-memory-XXXXXX";
static struct sockaddr_in address = {.sin_family = AF_INET};
static long stride = 7;
static int failures;
static char answer[3000]; /* to the last request */

static void fail(const char *what, long place, const char *found) {
  printf("FAILED: %s, allocation %ld: %s\n", what, place, found);
  failures++;
}

/* ---- reading -------------------------------------------------------------------------------- */

static long read_all(const struct job_reader *reader, size_t index, bool onwards) {
  long place = 1;
  for (bool failed = true; failed; place += stride) {
    struct job_spec spec;
    struct error error = {.status = STATUS_OK};
    const char *text = documents[index].text;
    no_memory_arm(place, onwards);
    enum status status = job_reader_read(reader, text, strlen(text), &spec, &error);
    failed = no_memory_disarm();
    job_spec_release(&spec);
    if (status != documents[index].status && (!failed || status != STATUS_NO_MEMORY)) {
      fail(documents[index].name, place, error.message);
    }
    if (status != error.status) {
      fail(documents[index].name, place, "the error says something else than the status");
    }
  }
  return place;
}

static void write_in_directory(const char *name, const char *text, char *path, size_t size) {
  snprintf(path, size, "%s/%s", directory, name);
  FILE *file = fopen(path, "w");
  if (!file || fputs(text, file) == EOF || fclose(file) != 0) {
    abort();
  }
}

/* A study whose base is a file, which names a table, with a sign that is no UTF-8, and a surface.
 */
static long embed_all(void) {
  static const char study[] = "{\"kind\": \"study\", \"base\": {\"file\": \"base.json\"}}";
  char path[100];
  long place = 1;
  write_in_directory("curve.csv", "e,\xB0\n0,0\n1,1\n", path, sizeof path);
  write_in_directory("part.stl",
                     "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                     "vertex 0 1 0\nendloop\nendfacet\nendsolid\n",
                     path, sizeof path);
  write_in_directory("base.json",
                     "{\"kind\": \"fit-material\", \"data\": {\"file\": \"curve.csv\"},"
                     " \"object\": {\"shape\": {\"stl\": {\"file\": \"part.stl\"}}}}",
                     path, sizeof path);
  for (bool failed = true; failed; place++) {
    char *embedded = NULL;
    size_t length = 0;
    struct error error = {.status = STATUS_OK};
    no_memory_arm(place, false);
    enum status status = embed_files(study, strlen(study), path, &embedded, &length, &error);
    failed = no_memory_disarm();
    free(embedded);
    if (status != STATUS_OK && (!failed || status != STATUS_NO_MEMORY)) {
      fail("embedding", place, error.message);
    }
  }
  return place;
}

static void create_all(void) {
  bool failed = true;
  for (long place = 1; failed; place++) {
    struct job_reader *reader = NULL;
    struct error error = {.status = STATUS_OK};
    no_memory_arm(place, false);
    enum status status = place < 40 ? job_reader_create(&reader, &error) : STATUS_OK;
    failed = no_memory_disarm();
    job_reader_destroy(reader);
    if (failed && status != STATUS_NO_MEMORY && status != STATUS_OK) {
      fail("reader", place, error.message);
    }
  }
}

/* A file of tokens that cannot be read for lack of memory is not called damaged. */
static void read_tokens(void) {
  struct token_list list = {0};
  char path[100], secret[TOKEN_SECRET_SIZE];
  bool failed = true;
  if (token_list_add(&list, "a", ROLE_READ, secret, NULL) != STATUS_OK ||
      token_list_add(&list, "b", ROLE_ADMIN, secret, NULL) != STATUS_OK ||
      token_file_write(directory, &list, NULL) != STATUS_OK) {
    abort();
  }
  token_list_clear(&list);
  for (long place = 1; failed; place++) {
    struct error error = {.status = STATUS_OK};
    no_memory_arm(place, place % 2 == 0);
    enum status status = token_file_read(directory, &list, &error);
    failed = no_memory_disarm();
    if (status != STATUS_NO_MEMORY && (status != STATUS_OK || list.count != 2)) {
      fail("tokens", place, error.message);
    }
    token_list_clear(&list);
  }
  if (!token_file_path(directory, path, sizeof path) || unlink(path) != 0) {
    abort();
  }
}

/* ---- submitting ------------------------------------------------------------------------------ */

static int remove_one(const char *path, const struct stat *info, int kind, struct FTW *walk) {
  (void)info, (void)kind, (void)walk;
  return remove(path);
}

/* A worker that ends when this file is removed, so that nobody else writes to the database before.
 */
static void write_launcher(char *path, size_t size) {
  write_in_directory("launcher", "#!/bin/sh\nwhile [ -e \"$0\" ]; do sleep 0.1; done\n", path,
                     size);
  if (chmod(path, 0700) != 0) {
    abort();
  }
}

static void *run_daemon(void *argument) {
  char *arguments[] = {"pneulabd",    "--data",    directory,    "--listen",        "127.0.0.1:0",
                       "--solver",    "/bin/true", "--launcher", argument,          "--isolation",
                       "off",         "--workers", "1",          "--drain-timeout", "0",
                       "--log-level", "error",     NULL};
  daemon_run(sizeof arguments / sizeof *arguments - 1, arguments);
  return NULL;
}

/* Starts the daemon and learns its port from the line that it prints. */
static void start_daemon(pthread_t *thread, char *launcher) {
  int ends[2], own = dup(STDOUT_FILENO);
  char line[200] = "";
  fflush(stdout);
  if (own < 0 || pipe(ends) != 0 || dup2(ends[1], STDOUT_FILENO) < 0) {
    abort();
  }
  if (pthread_create(thread, NULL, run_daemon, launcher) != 0) {
    abort();
  }
  for (size_t length = 0; !strchr(line, '\n');) { /* a timer's signal may interrupt the reading */
    ssize_t got = read(ends[0], line + length, sizeof line - 1 - length);
    length += got > 0 ? (size_t)got : 0;
    if (got == 0 || (got < 0 && errno != EINTR) || length == sizeof line - 1) {
      abort();
    }
  }
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons((uint16_t)strtoul(strrchr(line, ':') + 1, NULL, 10));
  dup2(own, STDOUT_FILENO);
  close(own);
  close(ends[1]);
  close(ends[0]);
}

/* Posts a job; returns the HTTP status, 0 when the connection was closed without an answer. */
static int post(const char *path, const char *text) {
  char request[4000];
  snprintf(request, sizeof request,
           "POST %s HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Length: %zu\r\n\r\n"
           "%s",
           path, strlen(text), text);
  int connection = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (connection < 0 ||
      connect(connection, (const struct sockaddr *)&address, sizeof address) != 0) {
    abort();
  }
  send(connection, request, strlen(request), MSG_NOSIGNAL);
  ssize_t length = recv(connection, answer, sizeof answer - 1, MSG_WAITALL);
  answer[length > 0 ? length : 0] = '\0';
  close(connection);
  return length > 12 ? (int)strtol(answer + 9, NULL, 10) : 0;
}

/* Posts until it is not answered with 503: after a failure of its database the daemon looks some
 * seconds later whether that works again. */
static int post_soon(const char *path) {
  int status = 503;
  for (int i = 0; status == 503 && i < 75; i++) {
    nanosleep(&(struct timespec){.tv_nsec = i > 0 ? 200000000 : 0}, NULL);
    status = post(path, RESPONSE);
  }
  return status;
}

static long submit_all(const char *path, bool onwards, int wanted, long *accepted) {
  long place = 1;
  for (bool failed = true; failed; place += stride) {
    no_memory_arm(place, onwards);
    int status = post(path, RESPONSE);
    failed = no_memory_disarm();
    *accepted += status == 202;
    if (status != wanted && (!failed || (status != 503 && status != 0))) {
      fail(path, place, answer);
    }
    if (place % 5 == 1) {
      status = post_soon(path);
      *accepted += status == 202;
      if (status != wanted) {
        fail(path, place, answer);
      }
    }
  }
  return place;
}

/* Jobs in the database: none that was acknowledged is missing, and it is sound. */
static void check_database(long accepted) {
  sqlite3 *db = NULL;
  sqlite3_stmt *statement = NULL;
  char path[100];
  snprintf(path, sizeof path, "%s/pneulab.db", directory);
  if (sqlite3_open_v2(path, &db, SQLITE_OPEN_READONLY, NULL) != SQLITE_OK ||
      sqlite3_prepare_v2(db,
                         "SELECT (SELECT count(*) FROM job), (SELECT group_concat("
                         "integrity_check) FROM pragma_integrity_check)",
                         -1, &statement, NULL) != SQLITE_OK ||
      sqlite3_step(statement) != SQLITE_ROW) {
    fail("database", 0, sqlite3_errmsg(db));
  } else if (sqlite3_column_int64(statement, 0) < accepted ||
             strcmp((const char *)sqlite3_column_text(statement, 1), "ok") != 0) {
    fail("database", accepted, (const char *)sqlite3_column_text(statement, 1));
  }
  sqlite3_finalize(statement);
  sqlite3_close(db);
}

int main(void) {
  const char *given = getenv("NO_MEMORY_STRIDE");
  struct job_reader *reader = NULL;
  char launcher[100];
  pthread_t daemon;
  long places = 0, accepted = 0;
  stride = given ? strtol(given, NULL, 10) : stride;
  no_memory_install();
  if (!mkdtemp(directory) || job_reader_create(&reader, NULL) != STATUS_OK) {
    return EXIT_FAILURE;
  }
  create_all();
  read_tokens();
  for (size_t i = 0; i < sizeof documents / sizeof *documents; i++) {
    places += read_all(reader, i, false) + read_all(reader, i, true);
  }
  job_reader_destroy(reader);
  places += embed_all();
  printf("reading: %ld allocations\n", places);
  write_launcher(launcher, sizeof launcher);
  start_daemon(&daemon, launcher);
  accepted += post_soon("/api/v1/jobs") == 202; /* keeps the worker busy */
  places = submit_all("/api/v1/jobs:validate", false, 200, &accepted);
  places += submit_all("/api/v1/jobs", false, 202, &accepted);
  places += submit_all("/api/v1/jobs", true, 202, &accepted);
  printf("submitting: %ld allocations, %ld jobs acknowledged\n", places, accepted);
  check_database(accepted);
  unlink(launcher);
  pthread_kill(daemon, SIGTERM);
  pthread_join(daemon, NULL);
  nftw(directory, remove_one, 16, FTW_DEPTH | FTW_PHYS);
  printf("%d failed\n", failures);
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
