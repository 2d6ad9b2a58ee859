-- Indexes of ends have finished jobs only: a submission writes six fewer. Lists take jobs that have
-- not ended in the order of their ids, for which there are others.

DROP INDEX job_by_finished;
DROP INDEX job_by_kind_finished;
DROP INDEX job_single_by_finished;
DROP INDEX job_single_by_kind_finished;
DROP INDEX job_member_by_finished;
DROP INDEX job_label_by_finished;

CREATE INDEX job_by_finished ON job (state, finished_ms) WHERE finished_ms IS NOT NULL;
CREATE INDEX job_by_kind_finished ON job (kind, state, finished_ms) WHERE finished_ms IS NOT NULL;
CREATE INDEX job_single_by_finished ON job (state, finished_ms)
  WHERE study_id IS NULL AND finished_ms IS NOT NULL;
CREATE INDEX job_single_by_kind_finished ON job (kind, state, finished_ms)
  WHERE study_id IS NULL AND finished_ms IS NOT NULL;
CREATE INDEX job_member_by_finished ON job (study_id, state, finished_ms)
  WHERE study_id IS NOT NULL AND finished_ms IS NOT NULL;
CREATE INDEX job_label_by_finished ON job_label (name, value, kind, state, finished_ms, job_id)
  WHERE finished_ms IS NOT NULL;
