#include "server/maintenance.h"

#include <stdio.h>
#include <unistd.h>

#include "server/base/lock.h"
#include "server/store/store.h"

enum exit_code maintenance_exit_code(enum status status) {
  switch (status) {
  case STATUS_OK:
    return EXIT_FINE;
  case STATUS_DAMAGED:
  case STATUS_CONFLICT:
    return EXIT_DATABASE_REFUSED;
  default:
    return EXIT_FAILED;
  }
}

bool maintenance_wanted(const struct options *options) {
  return options->backup[0] || options->restore[0] || options->check;
}

static enum exit_code restore(const struct options *options, struct error *error) {
  int lock = -1;
  if (lock_take(options->data, &lock, error) != STATUS_OK) {
    return error->status == STATUS_CONFLICT ? EXIT_IN_USE : EXIT_FAILED;
  }
  enum status status = store_restore(options->data, options->restore, options->force, error);
  close(lock);
  return maintenance_exit_code(status);
}

enum exit_code maintenance_run(const struct options *options) {
  struct error error = {.status = STATUS_OK};
  enum exit_code code = EXIT_COMMAND_LINE;
  if ((options->backup[0] != 0) + (options->restore[0] != 0) + (options->check != 0) > 1) {
    error_set(&error, STATUS_INVALID, NULL,
              "--backup, --restore and --check exclude each other; give one of them, for example "
              "pneulabd --data var --check.");
  } else if (options->backup[0]) {
    code =
        maintenance_exit_code(store_backup(options->data, options->backup, options->force, &error));
  } else if (options->restore[0]) {
    code = restore(options, &error);
  } else {
    code = maintenance_exit_code(store_verify(options->data, &error));
  }
  if (code != EXIT_FINE) {
    fprintf(stderr, "pneulabd: %s\n", error.message);
  } else if (options->backup[0]) {
    printf("%s is a backup of %s/pneulab.db\n", options->backup, options->data);
  } else if (options->restore[0]) {
    printf("%s/pneulab.db is restored from %s\n", options->data, options->restore);
  } else {
    printf("%s/pneulab.db is sound\n", options->data);
  }
  return code;
}
