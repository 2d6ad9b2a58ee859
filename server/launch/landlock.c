#include <errno.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "server/launch/launch.h"

#define FS_READ                                                                                    \
  (LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR)
#define FS_WRITE                                                                                   \
  (LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |                                 \
   LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG |    \
   FS_REFER | FS_TRUNCATE)
#define FS_NEVER                                                                                   \
  (LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO |    \
   LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM | FS_IOCTL_DEV)
#define FS_OF_FILES                                                                                \
  (LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE |     \
   FS_TRUNCATE)
/* Rights that the headers this is built with may not have yet. */
static const uint64_t FS_REFER = 1U << 13;     /* since version 2 */
static const uint64_t FS_TRUNCATE = 1U << 14;  /* since version 3 */
static const uint64_t FS_IOCTL_DEV = 1U << 15; /* since version 5 */

enum {
  NET_TCP = 3,      /* bind and connect, since version 4 */
  SCOPE_OUTSIDE = 3 /* abstract sockets and signals, since version 6 */
};

/* The kernel takes as much of it as it knows, provided that the rest is 0. */
struct ruleset {
  uint64_t fs, net, scope;
};

/* What every program reads; links on the way to a file need no right. */
static const char *const system_paths[] = {
    "/usr",
    "/bin",
    "/sbin",
    "/lib",
    "/lib32",
    "/lib64",
    "/etc/ld.so.cache",
    "/etc/ld.so.preload",
    "/proc", /* Landlock itself shows nothing private of processes outside */
    "/sys/devices/system/cpu"};

static const char *const devices[] = {"/dev/null", "/dev/zero", "/dev/full", "/dev/random",
                                      "/dev/urandom"};

int landlock_version(void) {
  long version =
      syscall(SYS_landlock_create_ruleset, NULL, (size_t)0, LANDLOCK_CREATE_RULESET_VERSION);
  return version > 0 ? (int)version : 0;
}

/* What of the file system a version can restrict. */
static uint64_t rights_of(int version) {
  uint64_t rights = FS_READ | FS_WRITE | FS_NEVER;
  rights &= version < 2 ? ~FS_REFER : ~(uint64_t)0;
  rights &= version < 3 ? ~FS_TRUNCATE : ~(uint64_t)0;
  rights &= version < 5 ? ~FS_IOCTL_DEV : ~(uint64_t)0;
  return rights;
}

/* Allows `rights` at and below a path; one that is not there needs no rule. */
static int path_allow(int ruleset, const char *path, uint64_t rights) {
  struct stat info;
  int fd = open(path, O_PATH | O_CLOEXEC);
  if (fd < 0) {
    return errno == ENOENT || errno == EACCES || errno == ENOTDIR ? 0 : errno;
  }
  int reason = fstat(fd, &info) == 0 ? 0 : errno;
  if (reason == 0) {
    struct landlock_path_beneath_attr rule = {
        .allowed_access = S_ISDIR(info.st_mode) ? rights : rights & FS_OF_FILES, .parent_fd = fd};
    if (syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0U) != 0) {
      reason = errno;
    }
  }
  close(fd);
  return reason;
}

static int rules_add(int ruleset, const struct launch *launch, uint64_t known) {
  int reason = 0;
  for (size_t i = 0; i < sizeof system_paths / sizeof *system_paths && reason == 0; i++) {
    reason = path_allow(ruleset, system_paths[i], FS_READ & known);
  }
  for (size_t i = 0; i < launch->read_count && reason == 0; i++) {
    reason = path_allow(ruleset, launch->read[i], FS_READ & known);
  }
  for (size_t i = 0; i < launch->write_count && reason == 0; i++) {
    reason = path_allow(ruleset, launch->write[i], (FS_READ | FS_WRITE) & known);
  }
  for (size_t i = 0; i < sizeof devices / sizeof *devices && reason == 0; i++) {
    reason = path_allow(
        ruleset, devices[i],
        (LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE | FS_TRUNCATE) & known);
  }
  return reason;
}

int landlock_confine(const struct launch *launch) {
  int version = landlock_version();
  if (version == 0) {
    return ENOSYS;
  }
  struct ruleset rules = {.fs = rights_of(version),
                          .net = version >= 4 ? NET_TCP : 0,
                          .scope = version >= 6 ? SCOPE_OUTSIDE : 0};
  int ruleset = (int)syscall(SYS_landlock_create_ruleset, &rules, sizeof rules, 0U);
  if (ruleset < 0) {
    return errno;
  }
  int reason = rules_add(ruleset, launch, rules.fs);
  if (reason == 0 && syscall(SYS_landlock_restrict_self, ruleset, 0U) != 0) {
    reason = errno;
  }
  close(ruleset);
  return reason;
}
