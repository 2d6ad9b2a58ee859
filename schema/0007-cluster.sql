-- Jobs that a cluster solves: batches of tasks, each of which solves one or more attempts.

-- ---- who solves a job ---------------------------------------------------------------------

ALTER TABLE job ADD COLUMN engine INTEGER NOT NULL DEFAULT 0;  -- that its label 'executor' asks for:
                                                               -- 1 local, 2 slurm; 0: the daemon's

-- The jobs that may start, now also by engine, so that each finds its next one at once.
DROP TABLE submitter_queue;
DROP INDEX job_ready;
DROP TRIGGER job_enters_queue_insert;
DROP TRIGGER job_enters_queue;
DROP TRIGGER job_leaves_queue;

CREATE INDEX job_ready ON job (submitter, priority, engine, study_id IS NOT NULL)
  WHERE ready = 1;

CREATE TABLE submitter_queue (
  submitter TEXT NOT NULL,
  priority  INTEGER NOT NULL,
  engine    INTEGER NOT NULL,          -- as in job
  ready     INTEGER NOT NULL,          -- jobs, at least one
  running   INTEGER NOT NULL,          -- as in submitter
  charge    REAL NOT NULL,             -- as in submitter
  job_id    INTEGER NOT NULL,          -- the first of the jobs
  PRIMARY KEY (submitter, priority, engine)
) WITHOUT ROWID;
CREATE INDEX submitter_queue_order
  ON submitter_queue (engine, priority DESC, running, charge, job_id);

INSERT INTO submitter_queue (submitter, priority, engine, ready, running, charge, job_id)
  SELECT submitter.name, job.priority, job.engine, count(*), submitter.running, submitter.charge,
    coalesce(min(iif(job.study_id IS NULL, job.id, NULL)), min(job.id))
  FROM job JOIN submitter ON submitter.name = job.submitter WHERE job.ready
  GROUP BY submitter.name, job.priority, job.engine;

CREATE TRIGGER job_enters_queue_insert AFTER INSERT ON job WHEN NEW.ready
BEGIN
  INSERT INTO submitter (name, ready, charge)
    VALUES (NEW.submitter, 1, NEW.created_ms / 60000 / 10.0 - 3.3219)
    ON CONFLICT DO UPDATE SET ready = ready + 1,
      charge = iif(ready = 0 AND running = 0, max(charge, excluded.charge), charge);
  INSERT INTO submitter_queue (submitter, priority, engine, ready, running, charge, job_id)
    SELECT name, NEW.priority, NEW.engine, 1, running, charge, NEW.id FROM submitter
    WHERE name = NEW.submitter
    ON CONFLICT DO UPDATE SET ready = ready + 1, job_id = (SELECT id FROM job
      WHERE ready = 1 AND submitter = NEW.submitter AND priority = NEW.priority
      AND engine = NEW.engine ORDER BY study_id IS NOT NULL, id LIMIT 1);
END;

CREATE TRIGGER job_enters_queue AFTER UPDATE OF state, waits_for, retry_due, priority, engine ON job
WHEN NEW.ready AND (NOT OLD.ready OR NEW.priority <> OLD.priority OR NEW.engine <> OLD.engine)
BEGIN
  INSERT INTO submitter (name, ready, charge)
    VALUES (NEW.submitter, 1, CAST((julianday('now') - 2440587.5) * 1440.0 AS INTEGER) / 10.0 - 3.3219)
    ON CONFLICT DO UPDATE SET ready = ready + 1,
      charge = iif(ready = 0 AND running = 0, max(charge, excluded.charge), charge);
  INSERT INTO submitter_queue (submitter, priority, engine, ready, running, charge, job_id)
    SELECT name, NEW.priority, NEW.engine, 1, running, charge, NEW.id FROM submitter
    WHERE name = NEW.submitter
    ON CONFLICT DO UPDATE SET ready = ready + 1, job_id = (SELECT id FROM job
      WHERE ready = 1 AND submitter = NEW.submitter AND priority = NEW.priority
      AND engine = NEW.engine ORDER BY study_id IS NOT NULL, id LIMIT 1);
END;

CREATE TRIGGER job_leaves_queue AFTER UPDATE OF state, waits_for, retry_due, priority, engine ON job
WHEN OLD.ready AND (NOT NEW.ready OR NEW.priority <> OLD.priority OR NEW.engine <> OLD.engine)
BEGIN
  UPDATE submitter SET ready = ready - 1 WHERE name = OLD.submitter;
  DELETE FROM submitter_queue
    WHERE submitter = OLD.submitter AND priority = OLD.priority AND engine = OLD.engine
    AND ready = 1;
  UPDATE submitter_queue SET ready = ready - 1, job_id = (SELECT id FROM job
      WHERE ready = 1 AND submitter = OLD.submitter AND priority = OLD.priority
      AND engine = OLD.engine ORDER BY study_id IS NOT NULL, id LIMIT 1)
    WHERE submitter = OLD.submitter AND priority = OLD.priority AND engine = OLD.engine;
END;

-- ---- batches ------------------------------------------------------------------------------

-- One row: what the names of our jobs on a cluster begin with, so that a daemon knows its own.
CREATE TABLE cluster_identity (
  id   INTEGER PRIMARY KEY CHECK (id = 1),
  name TEXT NOT NULL
);
INSERT INTO cluster_identity (id, name) VALUES (1, 'pneulab-' || lower(hex(randomblob(6))));

-- A job array of the cluster. It is written before the cluster is asked, so that after a crash in
-- between the array is found by its name.
CREATE TABLE cluster_batch (
  id           INTEGER PRIMARY KEY AUTOINCREMENT,
  name         TEXT NOT NULL UNIQUE,         -- of the array on the cluster, and of its folder here
  cluster_job  INTEGER,                      -- its number there; NULL: not known to be submitted
  partition    TEXT NOT NULL DEFAULT '',     -- asked for; '': the cluster's default
  created_ms   INTEGER NOT NULL,
  submitted_ms INTEGER,
  ended_ms     INTEGER                       -- when the last of its tasks was taken in, or it was
                                             -- given up
);
CREATE INDEX cluster_batch_open ON cluster_batch (id) WHERE ended_ms IS NULL;

CREATE TABLE cluster_task (
  batch_id INTEGER NOT NULL REFERENCES cluster_batch (id) ON DELETE CASCADE,
  task     INTEGER NOT NULL,                 -- its index in the array: 0, 1, ...
  state    TEXT NOT NULL DEFAULT 'waiting',  -- 'waiting' to be submitted, then as the cluster calls
                                             -- it: 'pending', 'running', 'completed', ...
  reason   TEXT NOT NULL DEFAULT '',         -- why it is pending, in the cluster's words
  node     TEXT NOT NULL DEFAULT '',
  PRIMARY KEY (batch_id, task)
) WITHOUT ROWID;

ALTER TABLE attempt ADD COLUMN batch_id INTEGER; -- the batch that solves it; NULL: this machine
ALTER TABLE attempt ADD COLUMN task INTEGER;     -- in the batch
ALTER TABLE attempt ADD COLUMN place INTEGER;    -- among the attempts of the task: 0, 1, ...

CREATE INDEX attempt_of_batch ON attempt (batch_id, task, place)
  WHERE batch_id IS NOT NULL AND outcome = '';
