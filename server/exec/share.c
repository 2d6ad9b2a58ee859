#include "server/exec/share.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "server/base/file.h"
#include "server/exec/run.h"

/* Two open folders of attempts, or of their artifacts. */
struct folders {
  int from, to;
};

static int folder_open(const char *data, const char *name, const char *inside) {
  char path[PATH_MAX];
  int length = snprintf(path, sizeof path, "%s/%s%s", data, name, inside);
  return length > 0 && (size_t)length < sizeof path
             ? open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW)
             : -1;
}

static bool folders_open(const char *data, const char *from, const char *to, const char *inside,
                         struct folders *folders) {
  *folders = (struct folders){.from = folder_open(data, from, inside),
                              .to = folder_open(data, to, inside)};
  return folders->from >= 0 && folders->to >= 0;
}

static void folders_close(const struct folders *folders) {
  if (folders->from >= 0) {
    close(folders->from);
  }
  if (folders->to >= 0) {
    close(folders->to);
  }
}

static bool folders_link(const struct folders *folders, const char *name) {
  return linkat(folders->from, name, folders->to, name, 0) == 0;
}

static bool artifacts_link(const struct folders *folders, const json_t *names) {
  size_t index;
  json_t *name;
  json_array_foreach(names, index, name) {
    const char *text = json_string_value(name);
    if (!text || !file_name_is_plain(text) || !folders_link(folders, text)) {
      return false;
    }
  }
  return fsync(folders->to) == 0;
}

enum status share_files(void *context, const char *from, const json_t *names, int64_t job_id,
                        int64_t attempt, char directory[STORE_DIRECTORY_SIZE],
                        struct error *error) {
  const char *data = context;
  char path[PATH_MAX], artifacts[PATH_MAX];
  struct folders outer = {-1, -1}, inner = {-1, -1};
  bool good = false;
  run_directory(job_id, attempt, directory);
  int length = snprintf(path, sizeof path, "%s/%s", data, directory);
  int longer = snprintf(artifacts, sizeof artifacts, "%s/%s/out", data, directory);
  if (length < 0 || longer < 0 || (size_t)longer >= sizeof artifacts) {
    return error_set(error, STATUS_NOT_FOUND, NULL, "The path of the data directory is too long.");
  }
  file_remove_tree(path); /* of a submission that was not stored in the end */
  if (file_make_directory(artifacts, error) == STATUS_OK &&
      folders_open(data, from, directory, "", &outer) &&
      folders_open(data, from, directory, "/out", &inner)) {
    folders_link(&outer, "log.txt");
    good = artifacts_link(&inner, names) && fsync(outer.to) == 0;
  }
  int reason = errno;
  folders_close(&outer);
  folders_close(&inner);
  if (!good) {
    file_remove_tree(path);
    return error_set(error, STATUS_NOT_FOUND, NULL, "The files in %s cannot be shared: %s.", from,
                     strerrordesc_np(reason));
  }
  return STATUS_OK;
}
