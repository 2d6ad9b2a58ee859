#include "server/slurm/words.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { FIELDS = 7 };

enum slurm_state slurm_state_of(const char *word) {
  static const struct {
    const char *word;
    enum slurm_state state;
  } words[] = {{"PENDING", SLURM_PENDING},        {"CONFIGURING", SLURM_RUNNING},
               {"RUNNING", SLURM_RUNNING},        {"SUSPENDED", SLURM_RUNNING},
               {"STOPPED", SLURM_RUNNING},        {"COMPLETING", SLURM_RUNNING},
               {"SIGNALING", SLURM_RUNNING},      {"STAGE_OUT", SLURM_RUNNING},
               {"RESIZING", SLURM_RUNNING},       {"REQUEUED", SLURM_PENDING},
               {"REQUEUE_HOLD", SLURM_PENDING},   {"REQUEUE_FED", SLURM_PENDING},
               {"RESV_DEL_HOLD", SLURM_PENDING},  {"SPECIAL_EXIT", SLURM_PENDING},
               {"COMPLETED", SLURM_COMPLETED},    {"FAILED", SLURM_FAILED},
               {"CANCELLED", SLURM_CANCELLED},    {"TIMEOUT", SLURM_TIMED_OUT},
               {"DEADLINE", SLURM_TIMED_OUT},     {"OUT_OF_MEMORY", SLURM_OUT_OF_MEMORY},
               {"NODE_FAIL", SLURM_NODE_LOST},    {"BOOT_FAIL", SLURM_NODE_LOST},
               {"PREEMPTED", SLURM_NODE_LOST},    {"REVOKED", SLURM_NODE_LOST},
               {"LAUNCH_FAILED", SLURM_NODE_LOST}};
  size_t length = strcspn(word, " +");
  for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
    if (strlen(words[i].word) == length && strncmp(word, words[i].word, length) == 0) {
      return words[i].state;
    }
  }
  return SLURM_UNKNOWN;
}

const char *slurm_state_word(enum slurm_state state) {
  static const char *const words[] = {
      [SLURM_PENDING] = "pending",     [SLURM_RUNNING] = "running",
      [SLURM_COMPLETED] = "completed", [SLURM_FAILED] = "failed",
      [SLURM_CANCELLED] = "cancelled", [SLURM_TIMED_OUT] = "timed_out",
      [SLURM_NODE_LOST] = "node_lost", [SLURM_OUT_OF_MEMORY] = "out_of_memory",
      [SLURM_UNKNOWN] = "unknown"};
  return words[state];
}

bool slurm_line_read(char *line, struct slurm_line *read) {
  char *field[FIELDS], *rest = line, *end;
  for (int i = 0; i < FIELDS; i++) {
    field[i] = strsep(&rest, "|");
    if (!field[i]) {
      return false;
    }
  }
  errno = 0;
  *read = (struct slurm_line){.job = strtoll(field[0], &end, 10),
                              .tasks = field[1] + (field[1][0] == '['),
                              .state = slurm_state_of(field[2]),
                              .reason = field[3],
                              .node = field[4],
                              .partition = field[5],
                              .name = field[6]};
  return rest == NULL && end != field[0] && *end == '\0' && errno == 0 && read->job > 0;
}

static bool number_next(const char **cursor, int64_t *number) {
  char *end;
  errno = 0;
  *number = strtoll(*cursor, &end, 10);
  bool good = end != *cursor && errno == 0 && *number >= 0;
  *cursor = end;
  return good;
}

bool slurm_range_next(const char **cursor, struct slurm_range *range) {
  if (**cursor == ',') {
    (*cursor)++;
  }
  if (**cursor < '0' || **cursor > '9' || !number_next(cursor, &range->low)) {
    return false;
  }
  range->high = range->low;
  range->step = 1;
  if (**cursor == '-') {
    (*cursor)++;
    if (!number_next(cursor, &range->high)) {
      return false;
    }
  }
  if (**cursor == ':') {
    (*cursor)++;
    if (!number_next(cursor, &range->step) || range->step < 1) {
      return false;
    }
  }
  return true;
}

const char *slurm_reason_sentence(const char *reason) {
  static const struct {
    const char *start, *sentence;
  } reasons[] = {
      {"Resources", "The nodes are busy; it is next when one becomes free."},
      {"Priority", "Other jobs of the cluster come first."},
      {"None", "The cluster has not looked at it yet."},
      {"BeginTime", "The cluster starts it at a later time."},
      {"PartitionDown", "The partition is down."},
      {"PartitionInactive", "The partition takes no jobs now."},
      {"PartitionNodeLimit", "It asks for more nodes than the partition allows."},
      {"PartitionTimeLimit", "It asks for more time than the partition allows."},
      {"ReqNodeNotAvail", "Nodes that it needs are not available."},
      {"Nodes required for job are DOWN", "All nodes that could take it are down or drained."},
      {"NodeDown", "A node that it needs is down."},
      {"BadConstraints", "No node can meet what it asks for."},
      {"JobHeldUser", "Its owner has held it on the cluster."},
      {"JobHeldAdmin", "An administrator of the cluster has held it."},
      {"JobArrayTaskLimit", "As many tasks of its array run as may run at a time."},
      {"Dependency", "It waits for another job of the cluster."},
      {"Reservation", "It waits for a reservation."},
      {"Licenses", "It waits for a licence."},
      {"launch failed requeued held", "It could not be started on a node and was held there."},
      {"Assoc", "A limit of the account is reached."},
      {"QOS", "A limit of the quality of service is reached."},
      {"MaxCpuPerAccount", "A limit of the account is reached."}};
  for (size_t i = 0; i < sizeof reasons / sizeof *reasons; i++) {
    if (strncmp(reason, reasons[i].start, strlen(reasons[i].start)) == 0) {
      return reasons[i].sentence;
    }
  }
  return NULL;
}

int64_t slurm_submitted_job(const char *output) {
  char *end;
  errno = 0;
  long long number = strtoll(output, &end, 10);
  bool good = end != output && errno == 0 && number > 0 && strchr(";\n", *end);
  return good ? number : 0;
}

bool slurm_unreachable(const char *problem) {
  static const char *const signs[] = {"contact slurm controller",
                                      "timed out",
                                      "Zero Bytes",
                                      "onnection refused",
                                      "ransport endpoint",
                                      "temporarily unable",
                                      "munge",
                                      "Munge",
                                      "Protocol authentication",
                                      "onnect failure",
                                      "onnection reset",
                                      "Invalid authentication credential",
                                      "backup controller",
                                      "not responding"};
  for (size_t i = 0; i < sizeof signs / sizeof *signs; i++) {
    if (strstr(problem, signs[i])) {
      return true;
    }
  }
  return false;
}
