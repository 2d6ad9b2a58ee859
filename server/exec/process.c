#include "server/exec/process.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

enum { REPORT_FD = 3, USAGE_FD = 4, CHILD_FILES = 5 };
enum { ARGUMENTS_MAX = 2 * (2 * ISOLATION_PATHS_MAX + PROCESS_FOLDERS_MAX) + 48, NUMBER_SIZE = 24 };

/* The command line of the launcher. */
struct command {
  const char *argv[ARGUMENTS_MAX];
  size_t count;
  char numbers[9][NUMBER_SIZE];
  size_t number_count;
};

static void command_add(struct command *command, const char *argument) {
  if (command->count + 1 < ARGUMENTS_MAX) {
    command->argv[command->count++] = argument;
  }
}

static void command_number(struct command *command, const char *option, uint64_t value) {
  char *text = command->numbers[command->number_count++];
  snprintf(text, NUMBER_SIZE, "%llu", (unsigned long long)value);
  command_add(command, option);
  command_add(command, text);
}

static void command_paths(struct command *command, const char *option, const char *const *paths) {
  for (; *paths; paths++) {
    command_add(command, option);
    command_add(command, *paths);
  }
}

static void command_make(struct command *command, const char *const *argv,
                         const char *const *folders, const struct process_limits *limits,
                         const struct isolation *isolation) {
  *command = (struct command){.count = 0};
  command_add(command, isolation->launcher);
  command_number(command, "--parent", (uint64_t)getpid());
  command_number(command, "--report", REPORT_FD);
  command_number(command, "--usage", USAGE_FD);
  command_number(command, "--memory", limits->memory_bytes);
  command_number(command, "--cpu", limits->cpu_s);
  command_number(command, "--file", limits->file_bytes);
  command_number(command, "--descriptors", limits->descriptors);
  command_number(command, "--processes", limits->processes);
  command_number(command, "--nice", isolation->nice);
  if (isolation->namespaces) {
    command_add(command, "--namespaces");
  }
  if (isolation->seccomp) {
    command_add(command, "--seccomp");
  }
  if (isolation->landlock) {
    command_add(command, "--landlock");
  }
  command_paths(command, "--write", folders);
  command_paths(command, "--write", isolation->write);
  command_paths(command, "--read", isolation->read);
  command_add(command, "--");
  for (; *argv; argv++) {
    command_add(command, *argv);
  }
}

/* Between fork and exec in a program with threads: async-signal-safe calls only. files: standard
 * input, output, error, where to report, and where to tell what was used. */
static int child_prepare(pid_t parent, const int files[CHILD_FILES]) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
  signal(SIGPIPE, SIG_DFL);
  /* The parent may have died before the request took hold. */
  if (setpgid(0, 0) != 0 || prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent) {
    return errno ? errno : ESRCH;
  }
  /* The daemon has descriptors 0 to 2 open; both pipes first go where nothing is run over. */
  int report = fcntl(files[REPORT_FD], F_DUPFD_CLOEXEC, CHILD_FILES);
  int used = fcntl(files[USAGE_FD], F_DUPFD_CLOEXEC, CHILD_FILES);
  const int sources[CHILD_FILES] = {files[0], files[1], files[2], report, used};
  for (int i = 0; i < CHILD_FILES; i++) {
    if (dup2(sources[i], i) < 0) {
      return errno;
    }
  }
  close_range(CHILD_FILES, ~0U, CLOSE_RANGE_CLOEXEC);
  return 0;
}

/* Forks and executes; what prevents the start comes as a sentence through a pipe, which a success
 * closes. */
static enum status process_fork(const struct command *command, int files[CHILD_FILES],
                                const int report[2], struct process *process, struct error *error) {
  char sentence[400];
  files[REPORT_FD] = report[1];
  pid_t parent = getpid();
  pid_t pid = fork();
  if (pid == 0) {
    if (child_prepare(parent, files) == 0) {
      execv(command->argv[0], (char *const *)(uintptr_t)command->argv);
    }
    static const char failed[] = "Cannot run the launcher of workers.";
    ssize_t ignored = write(report[1], failed, sizeof failed - 1);
    (void)ignored;
    _exit(127);
  }
  int fork_reason = errno;
  close(report[1]);
  if (pid < 0) {
    return error_set(error, STATUS_IO, NULL, "Cannot start a process: %s.",
                     strerrordesc_np(fork_reason));
  }
  ssize_t got;
  do {
    got = read(report[0], sentence, sizeof sentence - 1);
  } while (got < 0 && errno == EINTR);
  if (got > 0) {
    sentence[got] = '\0';
    waitpid(pid, NULL, 0);
    return error_set(error, STATUS_NOT_FOUND, NULL, "%s", sentence);
  }
  *process = (struct process){.pid = pid, .pidfd = (int)syscall(SYS_pidfd_open, pid, 0)};
  return STATUS_OK;
}

static enum status process_launch(const struct command *command, int files[CHILD_FILES],
                                  struct process *process, struct error *error) {
  int report[2], used[2];
  if (pipe2(report, O_CLOEXEC) != 0) {
    return error_set(error, STATUS_IO, NULL, "Cannot create a pipe: %s.", strerrordesc_np(errno));
  }
  if (pipe2(used, O_CLOEXEC | O_NONBLOCK) != 0) {
    int reason = errno;
    close(report[0]);
    close(report[1]);
    return error_set(error, STATUS_IO, NULL, "Cannot create a pipe: %s.", strerrordesc_np(reason));
  }
  files[USAGE_FD] = used[1];
  enum status status = process_fork(command, files, report, process, error);
  close(report[0]);
  close(used[1]);
  if (status == STATUS_OK) {
    process->used = used[0];
  } else {
    close(used[0]);
  }
  return status;
}

enum status process_start(const char *const *argv, const char *output_path, const char *error_path,
                          const char *const *folders, const struct process_limits *limits,
                          const struct isolation *isolation, struct process *process,
                          struct error *error) {
  int flags = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW;
  int files[CHILD_FILES] = {open("/dev/null", O_RDONLY | O_CLOEXEC), open(output_path, flags, 0644),
                            open(error_path, flags | O_APPEND, 0644), -1, -1};
  enum status status;
  struct command command;
  if (files[0] < 0 || files[1] < 0 || files[2] < 0) {
    status = error_set(error, errno == ENOSPC || errno == EDQUOT ? STATUS_NO_SPACE : STATUS_IO,
                       NULL, "Cannot create %s: %s.", output_path, strerrordesc_np(errno));
  } else {
    command_make(&command, argv, folders, limits, isolation);
    status = process_launch(&command, files, process, error);
  }
  for (int i = 0; i < 3; i++) {
    if (files[i] >= 0) {
      close(files[i]);
    }
  }
  return status;
}

/* Largest resident set in MB as the launcher told it; 0 when it was killed before it could. What
 * the kernel tells of the launcher itself would begin with the size of the daemon it came from. */
static double peak_memory(int used) {
  int64_t kilobytes = 0;
  bool told = read(used, &kilobytes, sizeof kilobytes) == (ssize_t)sizeof kilobytes;
  close(used);
  return told ? (double)kilobytes / 1024 : 0.0;
}

bool process_wait(struct process *process, int timeout_ms, struct process_end *end) {
  struct pollfd watched = {.fd = process->pidfd, .events = POLLIN};
  if (process->pidfd >= 0) {
    poll(&watched, 1, timeout_ms);
  } else {
    poll(NULL, 0, timeout_ms); /* a kernel without pidfd: the wait is merely less prompt */
  }
  int state;
  struct rusage usage;
  pid_t got = wait4(process->pid, &state, WNOHANG, &usage);
  if (got == 0 || (got < 0 && errno == EINTR)) {
    return false;
  }
  *end = (struct process_end){.exit_code = -1};
  if (got > 0) {
    end->exit_code = WIFEXITED(state) ? WEXITSTATUS(state) : -1;
    end->signal = WIFSIGNALED(state) ? WTERMSIG(state) : 0;
    end->cpu_s = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                 1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  }
  end->peak_memory_MB = peak_memory(process->used);
  if (process->pidfd >= 0) {
    close(process->pidfd);
  }
  *process = (struct process){.pid = -1, .pidfd = -1, .used = -1};
  return true;
}

void process_terminate(const struct process *process) {
  kill(process->pid, SIGTERM);
}

void process_kill(struct process *process) {
  /* The launcher is to see that nothing is left; one that cannot any more takes the rest with it.
   */
  kill(process->pid, process->ending ? SIGKILL : SIGHUP);
  process->ending = true;
}
