/* Inside of the Slurm engine. */
#ifndef PNEULAB_SLURM_SLURM_INTERNAL_H
#define PNEULAB_SLURM_SLURM_INTERNAL_H

#include <pthread.h>

#include "server/exec/ending.h"
#include "server/exec/run_internal.h"
#include "server/slurm/client.h"
#include "server/slurm/draft.h"
#include "server/slurm/slurm.h"
#include "server/slurm/words.h"
#include "server/store/cluster.h"

/* Folder below the data directory for the batches that have not ended. */
#define CLUSTER_FOLDER "cluster"

enum { NO_MEMBER = -1, ENDS_MAX = 64 };

struct slurm_task;

/* An attempt that a task solves. */
struct slurm_member {
  int64_t job_id, attempt;
  struct slurm_task *task;
  double time_limit_s;
  struct ending_job job;
  bool cancel;  /* it is to end; under the mutex */
  bool told;    /* the task knows */
  bool noted;   /* that it runs is in the database */
  bool gone;    /* its attempt has ended without us: nothing is stored of it */
  bool settled; /* its outcome is stored, or it was none of ours */
};

/* How far a task is that runs: what it has written and we have read. */
struct slurm_follow {
  off_t offset;       /* in its lines */
  int running;        /* the member that it solves, or NO_MEMBER */
  bool any;           /* some member is done */
  int64_t kill_at_ms; /* a request to end that member is not waited for any longer; 0: none */
  struct watch watch; /* of that member */
  struct progress_reader reader;
  struct progress progress; /* under the mutex */
};

enum slurm_phase {
  TASK_WAITS, /* is not known to have begun */
  TASK_RUNS,
  TASK_OVER
};

struct slurm_task {
  struct slurm_batch *batch;
  unsigned index; /* in the array */
  enum slurm_phase phase;
  size_t count, open;
  struct slurm_member *member;
  struct slurm_follow *follow; /* once it runs */
  enum slurm_state state;      /* as the cluster says; under the mutex, like the next two */
  char reason[CLUSTER_WORD_SIZE];
  char node[CLUSTER_WORD_SIZE];
  bool seen;             /* by the last poll */
  bool requeued;         /* the cluster means to start it a second time */
  int64_t absent_ms;     /* since when polls do not see it; 0: they do */
  enum stop_cause cause; /* why we want it to end as a whole */
  int stopped;           /* the member for whose sake */
  bool killed;           /* the cluster knows */
};

/* A job array. */
struct slurm_batch {
  struct slurm_batch *next;
  struct slurm *slurm;
  int64_t id, cluster_job; /* the latter 0: not known to be submitted */
  char name[CLUSTER_NAME_SIZE];
  char partition[CLUSTER_WORD_SIZE]; /* asked for by a label; "" for the daemon's */
  char folder[PATH_MAX];
  uint64_t memory_bytes;
  bool memory_own; /* asked for by a job */
  double time_s;
  int priority;
  int64_t tried_ms; /* when sbatch was last called, with an answer that told nothing; 0: never */
  int64_t retry_ms; /* earlier it is not called again */
  int refusals;
  size_t count, open; /* tasks, and those that are not over */
  struct slurm_task *task;
  struct timespec begun_seen, ended_seen; /* when the folders changed last */
  int begun_again, ended_again;           /* looks that are made all the same */
};

/* An outcome on its way to the store. */
struct slurm_end {
  struct slurm_member *member;
  struct outcome outcome;
  char directory[ENDING_DIRECTORY_SIZE];
};

/* What a kind of jobs takes. */
struct slurm_kind {
  char name[40];
  double mean_s;
};

enum { SLURM_KINDS_MAX = 24 };

/* Counters for people. */
struct slurm_figures {
  uint64_t polls, poll_failures, submissions;
  double poll_s, command_cpu_s, look_cpu_s;
};

struct slurm {
  struct slurm_settings settings;
  char data[PATH_MAX], solver[PATH_MAX], script[PATH_MAX]; /* as the nodes know them */
  struct slurm_client client;
  struct ending ending;
  pthread_t thread;
  bool started;
  char **environment;

  pthread_mutex_t mutex; /* guards what follows up to `first`, and what says so above */
  pthread_cond_t news;
  bool woken, cancels, recall, draining, stopping, planning;
  bool reachable, asked; /* whether the cluster answered last, and was asked at all */
  char trouble[300];     /* why jobs wait: the cluster does not answer, or refuses; "" for none */
  void *index;           /* search tree of members by job */
  unsigned tasks_waiting, tasks_running;
  size_t members;
  struct slurm_figures figures;

  struct slurm_batch *first; /* from here on of the thread alone */
  struct slurm_end end[ENDS_MAX];
  size_t ends;
  unsigned troubles; /* of the disk, when ends were stored last */
  int64_t poll_at_ms, polled_ms, plan_at_ms, cores_at_ms, look_at_ms, progress_at_ms;
  double poll_cpu_s; /* of one poll, on average */
  unsigned cores;
  struct slurm_kind kind[SLURM_KINDS_MAX];
  size_t kinds;
};

/* ---- task.c: one task and its files ------------------------------------------------------- */

/* Reads what a running task has written since. */
void task_read(struct slurm_task *task);

/* Looks after the member that is being solved: notes that it runs, its progress, its limits. */
void task_watch(struct slurm_task *task, bool progress);

/* The task has written its end: settles what is left. end: of its solver. */
void task_ended(struct slurm_task *task, const struct process_end *end);

/* The task is gone without a word: settles what is left by what the cluster says of it. */
void task_lost(struct slurm_task *task, enum slurm_state state, const char *node);

/* Starts to follow a task that has begun. */
void task_begun(struct slurm_task *task);

/* Settles a member that is cancelled before its turn: the solver does not find its job. */
void task_leave_out(struct slurm_task *task, size_t index);

/* The files of a member's attempt; false when their names are too long. */
bool member_paths(const struct slurm *slurm, const struct slurm_member *member,
                  struct run_paths *paths);

/* ---- ends.c ------------------------------------------------------------------------------- */

/* Takes over an outcome of a member, which is settled by it; of one that is gone it is dropped. */
void ends_add(struct slurm *slurm, struct slurm_member *member, struct outcome *outcome);

/* Stores all of them. */
void ends_flush(struct slurm *slurm);

/* ---- batch.c: an array and its folder ----------------------------------------------------- */

enum status batch_create(struct slurm *slurm, size_t tasks, struct slurm_batch **batch,
                         struct error *error);

/* Gives a task its members, all zero. */
enum status task_create(struct slurm_task *task, size_t count, struct error *error);

/* Makes members known by their jobs, and the batch one of the list. */
void batch_enlist(struct slurm_batch *batch);

/* Reads the folders of marks, and all lines of tasks that run; true when there was something new.
 */
bool batch_look(struct slurm_batch *batch, bool progress);

/* Forgets a batch that is over, with its folder. */
void batch_drop(struct slurm_batch *batch);
void batch_free(struct slurm_batch *batch);

/* Takes the end of a task if it has told one; looks for its very mark. */
void batch_look_end(struct slurm_task *task);

/* The number of the array as a task of it has noted it, 0 when none has begun. */
int64_t batch_noted_job(const struct slurm_batch *batch);

/* Puts back all members that are not settled, and forgets the batch. */
void batch_give_up(struct slurm_batch *batch, const char *reason, const char *message);

/* ---- files.c: what the nodes find on the shared disk -------------------------------------- */

/* Writes the folders of the attempts and of the task. */
enum status files_write_task(const struct slurm_task *task, const struct draft *draft,
                             struct error *error);

/* The folder of a batch with the folders of marks. */
enum status files_write_batch(const struct slurm_batch *batch, struct error *error);

/* The script that every task runs. */
enum status files_write_script(struct slurm *slurm, struct error *error);

/* ---- adopt.c, plan.c, submit.c, poll.c, cancel.c ------------------------------------------ */

/* Takes over what an earlier daemon has handed to the cluster. */
enum status slurm_adopt(struct slurm *slurm, struct error *error);

/* Learns from an outcome what jobs of its kind take. */
void kinds_learn(struct slurm *slurm, const struct slurm_member *member,
                 const struct outcome *outcome);

/* Claims jobs while the cluster has too few tasks that wait, and hands them over. */
void slurm_plan(struct slurm *slurm);

/* Submits batches that are not submitted yet, as far as that is safe. */
void slurm_submit_batches(struct slurm *slurm);

/* Asks the cluster for all tasks, when that is due. */
void slurm_poll(struct slurm *slurm);

/* Wants the next poll at the latest in so many ms. */
void slurm_poll_soon(struct slurm *slurm, int64_t ms);

/* Looks for attempts that the store has taken back: they are to end, too. */
void slurm_recall(struct slurm *slurm);

/* Lets requests to end reach their tasks. */
void slurm_cancels(struct slurm *slurm);

/* Whether the cluster has answered last. */
bool slurm_answers(struct slurm *slurm);

/* Notes whether the cluster answers; NULL: it does. */
void slurm_note_answer(struct slurm *slurm, const struct error *error);

/* Notes what jobs wait for that are not handed over, "" for nothing. */
void slurm_note_trouble(struct slurm *slurm, const char *text);

#endif
