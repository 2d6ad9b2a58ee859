#include "solver/cancel.h"

#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <unistd.h>

static volatile sig_atomic_t all_requested, some_requested;
static char marker[PATH_MAX]; /* of the member that is being solved, "" for none */
static bool member_cancelled;

static void on_terminate(int number) {
  (void)number;
  all_requested = 1;
}

static void on_member(int number) {
  (void)number;
  some_requested = 1;
}

void cancel_watch(void) {
  struct sigaction action = {.sa_handler = on_terminate};
  sigaction(SIGTERM, &action, NULL);
  sigaction(SIGINT, &action, NULL);
}

void cancel_watch_member(const char *folder) {
  struct sigaction action = {.sa_handler = on_member, .sa_flags = SA_RESTART};
  int length = folder ? snprintf(marker, sizeof marker, "%s/cancel", folder) : 0;
  if (length <= 0 || (size_t)length >= sizeof marker) {
    marker[0] = '\0';
  }
  member_cancelled = false;
  some_requested = 0;
  sigaction(SIGUSR1, &action, NULL);
}

bool cancel_all_wanted(void) {
  return all_requested != 0;
}

bool cancel_wanted(void *context) {
  (void)context;
  if (some_requested) {
    some_requested = 0;
    member_cancelled = member_cancelled || (marker[0] && access(marker, F_OK) == 0);
  }
  return all_requested || member_cancelled;
}
