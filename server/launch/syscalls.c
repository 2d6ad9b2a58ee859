#include <errno.h>
#include <sched.h>
#include <seccomp.h>
#include <stddef.h>
#include <sys/ioctl.h>

#include "server/launch/launch.h"

static const uint64_t CLONE_NEW = CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | CLONE_NEWIPC |
                                  CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET;

/* By name, since not every architecture and library knows each of them. */
static const char *const refused[] = {
    /* network; io_uring would open sockets past this filter */
    "socket", "socketpair", "connect", "bind", "listen", "accept", "accept4", "io_uring_setup",
    "io_uring_enter", "io_uring_register",
/* other processes and their files */
#ifndef PNEULAB_SANITIZED
    "ptrace", /* which the leak sanitizer needs */
#endif
    "process_vm_readv", "process_vm_writev", "pidfd_getfd", "kcmp", "process_madvise",
    "migrate_pages", "move_pages", "open_by_handle_at", "name_to_handle_at",
    /* file systems, and files that would mislead the daemon */
    "mount", "umount2", "move_mount", "open_tree", "fsopen", "fsconfig", "fsmount", "fspick",
    "mount_setattr", "pivot_root", "chroot", "swapon", "swapoff", "quotactl", "quotactl_fd",
    "fanotify_init", "link", "linkat", "symlink", "symlinkat", "mknod", "mknodat",
    /* namespaces */
    "unshare", "setns",
    /* memory that RLIMIT_DATA does not count */
    "memfd_create", "memfd_secret", "shmget", "shmat", "shmctl", "msgget", "semget", "mq_open",
    /* the kernel */
    "kexec_load", "kexec_file_load", "init_module", "finit_module", "delete_module", "bpf",
    "perf_event_open", "userfaultfd", "add_key", "request_key", "keyctl", "reboot", "syslog",
    "acct", "iopl", "ioperm", "personality", "lookup_dcookie", "nfsservctl", "vhangup",
    "sethostname", "setdomainname", "settimeofday", "clock_settime", "clock_adjtime", "adjtimex"};

static int rules_add(scmp_filter_ctx filter) {
  int code = 0;
  for (size_t i = 0; i < sizeof refused / sizeof *refused && code == 0; i++) {
    int number = seccomp_syscall_resolve_name(refused[i]);
    if (number != __NR_SCMP_ERROR) {
      code = seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), number, 0);
    }
  }
  for (unsigned bit = 0; bit < 32 && code == 0; bit++) {
    uint64_t flag = (uint64_t)1 << bit;
    if ((CLONE_NEW & flag) != 0) {
      code = seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(clone), 1,
                              SCMP_A0(SCMP_CMP_MASKED_EQ, flag, flag));
    }
  }
  if (code ==
      0) { /* its flags are in memory, out of the filter's sight: the C library falls back */
    code = seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
  }
  if (code == 0) { /* typing into a terminal that is still open */
    code = seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(ioctl), 1,
                            SCMP_A1(SCMP_CMP_MASKED_EQ, 0xffffffff, TIOCSTI));
  }
  if (code == 0) { /* limits of other processes */
    code = seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(prlimit64), 1,
                            SCMP_A0(SCMP_CMP_NE, 0));
  }
  return code;
}

int syscalls_confine(void) {
  scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
  if (!filter) {
    return ENOMEM;
  }
  /* System calls of a foreign architecture (32-bit ones on amd64) are refused as a whole. */
  int code = seccomp_attr_set(filter, SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_KILL_PROCESS);
  if (code == 0) {
    code = rules_add(filter);
  }
  if (code == 0) {
    code = seccomp_load(filter);
  }
  seccomp_release(filter);
  return -code;
}
