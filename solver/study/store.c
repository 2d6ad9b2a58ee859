#include "solver/study/store.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static enum status make_folder(const char *path, struct error *error) {
  if (mkdir(path, 0777) == 0 || errno == EEXIST) {
    return STATUS_OK;
  }
  return error_set(error, STATUS_IO, NULL, "cannot make the directory %s: %s", path,
                   strerror(errno));
}

/* "FIRST/SECOND" in memory of its own, or NULL. */
static char *join(const char *first, const char *second) {
  size_t size = strlen(first) + strlen(second) + 2;
  char *path = malloc(size);
  if (path) {
    snprintf(path, size, "%s/%s", first, second);
  }
  return path;
}

/* Keeps other studies out of the folder until it is closed, which a killed process does, too. */
static enum status lock(struct member_store *store, struct error *error) {
  store->lock = open(store->directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (store->lock >= 0 && flock(store->lock, LOCK_EX | LOCK_NB) == 0) {
    return STATUS_OK;
  }
  bool taken = store->lock >= 0 && errno == EWOULDBLOCK;
  return error_set(error, STATUS_IO, NULL, "%s %s", store->directory,
                   taken ? "is in use by another study: wait for its end, or name another folder"
                         : strerror(errno));
}

enum status member_store_open(const char *out_dir, struct member_store *store,
                              struct error *error) {
  const char *temporary = getenv("TMPDIR");
  *store = (struct member_store){.temporary = out_dir == NULL, .lock = -1};
  store->directory =
      out_dir ? join(out_dir, "members")
              : join(temporary && temporary[0] ? temporary : "/tmp", "pneulab-study-XXXXXX");
  if (!store->directory) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a path");
  }
  if (out_dir) {
    enum status status = make_folder(store->directory, error);
    return status == STATUS_OK ? lock(store, error) : status;
  }
  if (!mkdtemp(store->directory)) {
    store->temporary = false;
    return error_set(error, STATUS_IO, NULL, "cannot make a temporary directory: %s",
                     strerror(errno));
  }
  return STATUS_OK;
}

void member_store_close(struct member_store *store, const struct study *study) {
  if (store->temporary && store->directory) {
    for (size_t i = 0; i < study->count; i++) {
      for (int file = 0; file < MEMBER_FILES; file++) {
        member_store_remove(store, &study->member[i], (enum member_file)file);
      }
    }
    rmdir(store->directory);
  }
  if (store->lock >= 0) {
    close(store->lock);
  }
  free(store->directory);
  *store = (struct member_store){.lock = -1};
}

char *member_store_path(const struct member_store *store, const struct study_member *member,
                        enum member_file file) {
  static const char *const endings[MEMBER_FILES] = {
      [MEMBER_JOB] = ".job.json",
      [MEMBER_PART] = ".part",
      [MEMBER_LOG] = ".log",
      [MEMBER_RESULT] = ".json",
  };
  char name[100];
  snprintf(name, sizeof name, "%s%s", member->hash, endings[file]);
  return join(store->directory, name);
}

void member_store_remove(const struct member_store *store, const struct study_member *member,
                         enum member_file file) {
  char *path = member_store_path(store, member, file);
  if (path) {
    unlink(path);
  }
  free(path);
}

enum status member_store_job(const struct member_store *store, const struct study_member *member,
                             struct error *error) {
  char *path = member_store_path(store, member, MEMBER_JOB);
  enum status status = STATUS_OK;
  if (!path || json_dump_file(member->document, path, JSON_INDENT(1)) != 0) {
    status = error_set(error, STATUS_IO, NULL, "cannot write %s: %s", path ? path : "a job",
                       strerror(errno));
  }
  free(path);
  return status;
}

enum status member_store_write(const struct member_store *store, const struct study_member *member,
                               const json_t *document, struct error *error) {
  char *path = member_store_path(store, member, MEMBER_PART);
  enum status status = STATUS_OK;
  if (!path || !document ||
      json_dump_file(document, path, JSON_COMPACT | JSON_REAL_PRECISION(12)) != 0) {
    status = error_set(error, STATUS_IO, NULL, "cannot write %s: %s", path ? path : "a result",
                       strerror(errno));
  }
  free(path);
  return status;
}

enum status member_store_keep(const struct member_store *store, const struct study_member *member,
                              struct error *error) {
  char *part = member_store_path(store, member, MEMBER_PART);
  char *result = member_store_path(store, member, MEMBER_RESULT);
  enum status status = STATUS_OK;
  if (!part || !result || rename(part, result) != 0) {
    status = error_set(error, STATUS_IO, NULL, "cannot keep the result of a member: %s",
                       strerror(errno));
  }
  free(part);
  free(result);
  return status;
}

static json_t *load(const struct member_store *store, const struct study_member *member,
                    enum member_file file) {
  char *path = member_store_path(store, member, file);
  json_t *document = path ? json_load_file(path, JSON_REJECT_DUPLICATES, NULL) : NULL;
  free(path);
  return document;
}

static bool is_text(const json_t *object, const char *key, const char *wanted) {
  const char *text = json_string_value(json_object_get(object, key));
  return text && strcmp(text, wanted) == 0;
}

json_t *member_store_result(const struct member_store *store, const struct study_member *member) {
  json_t *result = load(store, member, MEMBER_RESULT);
  const json_t *provenance = json_object_get(result, "provenance");
  bool good = is_text(provenance, "version", PNEULAB_VERSION) &&
              is_text(provenance, "spec_hash", member->hash) &&
              (is_text(result, "status", "succeeded") || is_text(result, "status", "diverged")) &&
              !is_text(result, "reason", "cancelled") && !is_text(result, "reason", "no_memory") &&
              json_is_object(json_object_get(result, "metrics"));
  if (!good) {
    json_decref(result);
    return NULL;
  }
  return result;
}

json_t *member_store_error(const struct member_store *store, const struct study_member *member) {
  json_t *printed = load(store, member, MEMBER_PART);
  json_t *error = json_incref(json_object_get(printed, "error"));
  json_decref(printed);
  return error;
}
