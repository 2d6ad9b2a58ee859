/* A solver that does what it must not. The job's name says what ("trespass PID", "bomb", ...); the
 * metrics of its result are the errno of every trial (0: it succeeded) or what it could get. */
#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { MEGABYTE = 1 << 20, BOMB_MAX = 3000, DESCRIPTORS = 1024 };

static const char *folder; /* of artifacts: DATA/attempts/JOB-NUMBER/out */

static void note(json_t *metrics, const char *name, long result) {
  json_object_set_new(metrics, name, json_integer(result < 0 ? errno : 0));
}

static long file_open(const char *format, int flags) {
  char path[4096];
  snprintf(path, sizeof path, format, folder);
  int fd = open(path, flags | O_CLOEXEC, 0600);
  if (fd >= 0) {
    close(fd);
  }
  return fd;
}

static void trespass_files(json_t *metrics) {
  char path[4096];
  note(metrics, "write_own", file_open("%s/mine", O_WRONLY | O_CREAT));
  note(metrics, "write_tmp", file_open("/tmp/pneulab-escaped", O_WRONLY | O_CREAT));
  note(metrics, "write_data", file_open("%s/../../../escaped", O_WRONLY | O_CREAT));
  note(metrics, "write_attempts", file_open("%s/../../99-1", O_WRONLY | O_CREAT));
  note(metrics, "read_shadow", file_open("/etc/shadow", O_RDONLY));
  note(metrics, "read_passwd", file_open("/etc/passwd", O_RDONLY));
  note(metrics, "read_database", file_open("%s/../../../pneulab.db", O_RDONLY));
  note(metrics, "truncate_database", file_open("%s/../../../pneulab.db", O_WRONLY | O_TRUNC));
  snprintf(path, sizeof path, "%s/link", folder);
  note(metrics, "symlink", symlink("/etc/shadow", path));
  note(metrics, "fifo", mkfifo(path, 0600));
  snprintf(path, sizeof path, "%s/../../../pneulab.db", folder);
  note(metrics, "delete_database", unlink(path));
}

static void trespass_kernel(json_t *metrics) {
  char area[256] = "";
  note(metrics, "socket_inet", socket(AF_INET, SOCK_STREAM, 0));
  note(metrics, "socket_inet6", socket(AF_INET6, SOCK_DGRAM, 0));
  note(metrics, "socket_unix", socket(AF_UNIX, SOCK_STREAM, 0));
  note(metrics, "socket_netlink", socket(AF_NETLINK, SOCK_RAW, 0));
  note(metrics, "io_uring", syscall(SYS_io_uring_setup, 4, area));
  note(metrics, "mount", mount("none", folder, "tmpfs", 0, NULL));
  note(metrics, "unshare_user", unshare(CLONE_NEWUSER));
  note(metrics, "unshare_net", unshare(CLONE_NEWNET));
  note(metrics, "clone_user", syscall(SYS_clone, CLONE_NEWUSER | SIGCHLD, 0, 0, 0, 0));
  note(metrics, "bpf", syscall(SYS_bpf, 5, area, sizeof area));
  note(metrics, "keyctl", syscall(SYS_keyctl, 0, -3, 0));
  note(metrics, "kexec", syscall(SYS_kexec_load, 0, 0, NULL, 0));
  note(metrics, "memfd", syscall(SYS_memfd_create, "x", 0));
  note(metrics, "chroot", chroot(folder));
}

static void trespass_processes(json_t *metrics, pid_t daemon) {
  char path[64];
  struct rlimit more = {RLIM_INFINITY, RLIM_INFINITY}, theirs;
  note(metrics, "signal_daemon", kill(daemon, 0));
  note(metrics, "limits_of_daemon", syscall(SYS_prlimit64, daemon, RLIMIT_NOFILE, NULL, &theirs));
  note(metrics, "raise_memory", setrlimit(RLIMIT_DATA, &more));
  note(metrics, "raise_files", setrlimit(RLIMIT_FSIZE, &more));
  snprintf(path, sizeof path, "/proc/%d/environ", daemon);
  note(metrics, "environment_of_daemon", file_open(path, O_RDONLY));
  snprintf(path, sizeof path, "/proc/%d/mem", daemon);
  note(metrics, "memory_of_daemon", file_open(path, O_RDWR));
  note(metrics, "environment_kept", getenv("PNEULAB_SECRET") ? 0 : (errno = ENOENT, -1));
  int inherited = 0;
  for (int fd = 3; fd < DESCRIPTORS; fd++) {
    inherited += fcntl(fd, F_GETFD) >= 0;
  }
  json_object_set_new(metrics, "inherited_descriptors", json_integer(inherited));
}

static void bomb(json_t *metrics) {
  long made = 0;
  while (made < BOMB_MAX) {
    pid_t pid = fork();
    if (pid == 0) {
      for (;;) {
        pause();
      }
    }
    if (pid < 0) {
      break;
    }
    made++;
  }
  json_object_set_new(metrics, "processes", json_integer(made));
}

/* Memory in pieces that are written to, until there is no more. */
static void hoard(json_t *metrics, int sharing) {
  long pieces = 0;
  while (pieces < 100000) {
    char *piece = mmap(NULL, MEGABYTE, PROT_READ | PROT_WRITE, sharing | MAP_ANONYMOUS, -1, 0);
    if (piece == MAP_FAILED) {
      break;
    }
    piece[0] = 1;
    pieces++;
  }
  json_object_set_new(metrics, "memory_MB", json_integer(pieces));
}

/* Files of 4 MB until somebody stops it; after 15 s nobody has. */
static void many_files(void) {
  static char content[4 * MEGABYTE];
  for (int i = 0; i < 150; i++) {
    char path[4096];
    snprintf(path, sizeof path, "%s/file-%d", folder, i);
    int fd = creat(path, 0600);
    if (fd < 0 || write(fd, content, sizeof content) < 0) {
      break;
    }
    close(fd);
    usleep(100000);
  }
}

/* A grandchild in a session of its own that has let go of everything and ignores what it can. */
static void detach(const char *tag) {
  if (fork() == 0) {
    setsid();
    if (fork() == 0) {
      char *arguments[] = {"sleep", "600", NULL};
      for (int number = 1; number < NSIG; number++) {
        signal(number, SIG_IGN);
      }
      setsid();
      close(0), close(1), close(2);
      if (setenv("DETACHED", tag, 1) == 0) {
        execv("/bin/sleep", arguments);
      }
    }
    _exit(0);
  }
  usleep(100000);
}

static void misbehave(const char *name, json_t *metrics) {
  if (strncmp(name, "trespass ", 9) == 0) {
    pid_t daemon = atoi(name + 9);
    trespass_files(metrics);
    trespass_kernel(metrics);
    trespass_processes(metrics, daemon);
  } else if (strcmp(name, "bomb") == 0) {
    bomb(metrics);
  } else if (strcmp(name, "hoard") == 0) {
    hoard(metrics, MAP_PRIVATE);
  } else if (strcmp(name, "hoard shared") == 0) {
    hoard(metrics, MAP_SHARED);
  } else if (strcmp(name, "big file") == 0) {
    signal(SIGXFSZ, SIG_IGN);
    char path[4096];
    snprintf(path, sizeof path, "%s/big", folder);
    int fd = creat(path, 0600);
    note(metrics, "big_file", pwrite(fd, "x", 1, (off_t)1 << 40));
  } else if (strcmp(name, "many files") == 0) {
    many_files();
  } else if (strncmp(name, "detach", 6) == 0) {
    detach(name);
    if (strstr(name, "and wait")) {
      pause();
    }
  } else if (strcmp(name, "deaf") == 0) {
    signal(SIGTERM, SIG_IGN);
    for (;;) {
      pause();
    }
  }
}

int main(int argc, char **argv) {
  for (int i = 1; i + 1 < argc; i++) {
    folder = strcmp(argv[i], "--out") == 0 ? argv[i + 1] : folder;
  }
  json_t *job = json_load_file(argv[argc - 1], 0, NULL);
  json_t *metrics = json_object();
  const char *name = json_string_value(json_object_get(job, "name"));
  misbehave(name ? name : "", metrics);
  json_t *result = json_pack("{s:s, s:O}", "status", "succeeded", "metrics", metrics);
  json_dumpf(result, stdout, 0);
  putchar('\n');
  return fflush(stdout) == 0 ? 0 : 4;
}
