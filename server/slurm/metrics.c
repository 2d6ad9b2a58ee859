#include "server/slurm/metrics.h"

#include "server/base/meter.h"
#include "server/slurm/slurm_internal.h"

static void number(FILE *out, const char *name, const char *type, const char *help, double value) {
  meter_head(out, name, type, help);
  fprintf(out, "%s %.15g\n", name, value);
}

void slurm_metrics(void *engine, FILE *out) {
  struct slurm *slurm = engine;
  pthread_mutex_lock(&slurm->mutex);
  struct slurm_figures figures = slurm->figures;
  unsigned waiting = slurm->tasks_waiting, running = slurm->tasks_running;
  size_t members = slurm->members;
  bool reachable = slurm->reachable;
  pthread_mutex_unlock(&slurm->mutex);
  number(out, "pneulab_cluster_reachable", "gauge", "Whether the cluster answered last.",
         reachable);
  meter_head(out, "pneulab_cluster_tasks", "gauge", "Tasks with the cluster, by state.");
  fprintf(out, "pneulab_cluster_tasks{state=\"pending\"} %u\n", waiting);
  fprintf(out, "pneulab_cluster_tasks{state=\"running\"} %u\n", running);
  number(out, "pneulab_cluster_jobs", "gauge", "Jobs that have been handed to the cluster.",
         (double)members);
  number(out, "pneulab_cluster_batches_total", "counter", "Job arrays submitted.",
         (double)figures.submissions);
  number(out, "pneulab_cluster_polls_total", "counter", "Questions for all tasks.",
         (double)figures.polls);
  number(out, "pneulab_cluster_poll_failures_total", "counter", "Those without an answer.",
         (double)figures.poll_failures);
  number(out, "pneulab_cluster_poll_seconds_total", "counter", "Time that they took.",
         figures.poll_s);
  meter_head(
      out, "pneulab_cluster_cpu_seconds_total", "counter",
      "Processor time for the cluster: its programs, and looks at files where nothing is new.");
  fprintf(out, "pneulab_cluster_cpu_seconds_total{for=\"commands\"} %.6f\n", figures.command_cpu_s);
  fprintf(out, "pneulab_cluster_cpu_seconds_total{for=\"files\"} %.6f\n", figures.look_cpu_s);
}
