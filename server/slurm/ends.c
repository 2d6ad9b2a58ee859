/* Outcomes on their way to the store, several in one transaction. */
#include <string.h>

#include "server/slurm/index.h"
#include "server/slurm/slurm_internal.h"

void ends_add(struct slurm *slurm, struct slurm_member *member, struct outcome *outcome) {
  if (slurm->ends == ENDS_MAX) {
    ends_flush(slurm);
  }
  pthread_mutex_lock(&slurm->mutex);
  member->settled = true;
  index_remove(&slurm->index, member);
  slurm->members--;
  member->task->open--;
  pthread_mutex_unlock(&slurm->mutex);
  if (member->gone) {
    outcome_clear(outcome);
    return;
  }
  struct slurm_end *end = &slurm->end[slurm->ends++];
  end->member = member;
  end->outcome = *outcome;
  end->outcome.attempt.reason_code = end->outcome.reason_code; /* the texts have moved with it */
  end->outcome.attempt.message = end->outcome.message;
  ending_fill(&slurm->ending, member->job_id, member->attempt, slurm->troubles, end->directory,
              &end->outcome);
}

void ends_flush(struct slurm *slurm) {
  const struct engine_settings *settings = &slurm->settings.engine;
  const struct ending_job *jobs[ENDS_MAX] = {NULL};
  struct outcome *outcomes[ENDS_MAX] = {NULL};
  size_t count = slurm->ends;
  if (count == 0) {
    return;
  }
  for (size_t i = 0; i < count; i++) {
    jobs[i] = &slurm->end[i].member->job;
    outcomes[i] = &slurm->end[i].outcome;
    kinds_learn(slurm, slurm->end[i].member, &slurm->end[i].outcome);
  }
  ending_store(&slurm->ending, jobs, outcomes, count);
  for (size_t i = 0; i < count; i++) {
    settings->changed(settings->context, slurm->end[i].outcome.attempt.job_id);
    outcome_clear(&slurm->end[i].outcome);
  }
  slurm->ends = 0;
  slurm->troubles = disk_troubles(settings->disk);
}
