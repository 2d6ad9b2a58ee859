-- The queue: priorities, fair shares between submitters, answers that are used again; counts and
-- indices with which no list and no start reads more rows than it shows.

-- ---- jobs ---------------------------------------------------------------------------------

ALTER TABLE job ADD COLUMN priority INTEGER NOT NULL DEFAULT 0;      -- -100 .. 100, high ones first
ALTER TABLE job ADD COLUMN submitter TEXT NOT NULL DEFAULT '';       -- whose share of the workers it
                                                                     -- uses: the caller's name, else
                                                                     -- the label 'user', else ''
ALTER TABLE job ADD COLUMN memory_bytes INTEGER NOT NULL DEFAULT 0;  -- its own limit, 0: none
ALTER TABLE job ADD COLUMN reuse INTEGER NOT NULL DEFAULT 0;         -- 1: an equal job's result will do
ALTER TABLE job ADD COLUMN reused_from INTEGER;                      -- the job whose result it has
ALTER TABLE job ADD COLUMN waits_for INTEGER;                        -- queued until this equal job ends
ALTER TABLE job ADD COLUMN retry_reason TEXT NOT NULL DEFAULT '';    -- why it was asked for again
ALTER TABLE job ADD COLUMN retry_due INTEGER NOT NULL DEFAULT 0;     -- 1: the wait of retry_wait is over
ALTER TABLE job ADD COLUMN solver_version TEXT NOT NULL DEFAULT '';  -- that made the result
ALTER TABLE job ADD COLUMN ready INTEGER GENERATED ALWAYS AS         -- 1: may start now
  ((state = 'queued' AND waits_for IS NULL) OR (state = 'retry_wait' AND retry_due = 1)) VIRTUAL;

ALTER TABLE attempt ADD COLUMN message TEXT NOT NULL DEFAULT '';     -- reason_code in a sentence

-- An equal job that waits may be answered with a result that has arrived meanwhile.
INSERT INTO job_transition (from_state, to_state) VALUES ('queued', 'succeeded');

UPDATE job SET submitter = coalesce((SELECT value FROM job_label
  WHERE job_label.job_id = job.id AND job_label.name = 'user'), '');
UPDATE job SET solver_version = coalesce((SELECT json_extract(document, '$.provenance.version')
  FROM result WHERE result.job_id = job.id AND json_valid(document)), '');
UPDATE job SET finished_ms = coalesce(started_ms, created_ms)
  WHERE finished_ms IS NULL AND state IN ('succeeded', 'failed', 'timed_out', 'cancelled');

-- From here on jobs are as old as their ids say, also where the clock was once set back: a list by
-- age needs no index of its own.
UPDATE job SET created_ms = ordered.created_ms
  FROM (SELECT id, max(created_ms) OVER (ORDER BY id) AS created_ms FROM job) AS ordered
  WHERE ordered.id = job.id AND ordered.created_ms > job.created_ms;

-- ---- lists --------------------------------------------------------------------------------
-- A page is put together from one range of an index for each state (and kind): in each of them the
-- jobs stand in the order wanted, equals by their id, which every index ends with. finished_ms is
-- NULL exactly in the states that are not terminal.

DROP INDEX job_by_kind;
DROP INDEX job_by_hash;
CREATE INDEX job_by_kind ON job (kind, state);
CREATE INDEX job_by_finished ON job (state, finished_ms);
CREATE INDEX job_by_name ON job (state, name);
CREATE INDEX job_by_kind_finished ON job (kind, state, finished_ms);
CREATE INDEX job_by_kind_name ON job (kind, state, name);
CREATE INDEX job_by_hash ON job (spec_hash, state, solver_version);

-- What lists are filtered and sorted by beside the label, as in the job itself.
ALTER TABLE job_label ADD COLUMN kind TEXT NOT NULL DEFAULT '';
ALTER TABLE job_label ADD COLUMN state TEXT NOT NULL DEFAULT '';
ALTER TABLE job_label ADD COLUMN finished_ms INTEGER;
ALTER TABLE job_label ADD COLUMN job_name TEXT NOT NULL DEFAULT '';
UPDATE job_label SET kind = job.kind, state = job.state, finished_ms = job.finished_ms,
  job_name = job.name FROM job WHERE job.id = job_label.job_id;
DROP INDEX job_label_by_value;
CREATE INDEX job_label_by_value ON job_label (name, value, kind, state, job_id);
CREATE INDEX job_label_by_finished ON job_label (name, value, kind, state, finished_ms, job_id);
CREATE INDEX job_label_by_name ON job_label (name, value, kind, state, job_name, job_id);

CREATE TRIGGER job_label_follows AFTER UPDATE OF state, finished_ms, name ON job
BEGIN
  UPDATE job_label SET state = NEW.state, finished_ms = NEW.finished_ms, job_name = NEW.name
    WHERE job_id = NEW.id;
END;

-- Number of jobs in each state.
CREATE TABLE job_count (
  state TEXT PRIMARY KEY REFERENCES job_state (state),
  jobs  INTEGER NOT NULL
) WITHOUT ROWID;
INSERT INTO job_count (state, jobs)
  SELECT state, (SELECT count(*) FROM job WHERE job.state = job_state.state) FROM job_state;

CREATE TRIGGER job_count_insert AFTER INSERT ON job
BEGIN
  UPDATE job_count SET jobs = jobs + 1 WHERE state = NEW.state;
END;
CREATE TRIGGER job_count_update AFTER UPDATE OF state ON job WHEN NEW.state <> OLD.state
BEGIN
  UPDATE job_count SET jobs = jobs - 1 WHERE state = OLD.state;
  UPDATE job_count SET jobs = jobs + 1 WHERE state = NEW.state;
END;
CREATE TRIGGER job_count_delete AFTER DELETE ON job
BEGIN
  UPDATE job_count SET jobs = jobs - 1 WHERE state = OLD.state;
END;

-- ---- who is next --------------------------------------------------------------------------
-- Of the jobs with the highest priority, those of the submitter with the fewest running jobs; of
-- equals, of the one who has used the workers least of late; of equals again the oldest job.

-- Everybody with a job that waits or runs, and who has used workers of late.
-- charge: the logarithm (base 2) of the seconds of worker time used, of which each counts half as
-- much every ten minutes. It is kept as what it would be at time zero, so that it changes only
-- where time is added: log2(sum of seconds * 2 ^ (end of the attempt in ms / 600000)). Who comes
-- with nothing to his account starts at a tenth of a second (log2 0.1 = -3.3219), used in the minute
-- in which he comes: thereby somebody whose use has faded goes before those who come later, however
-- many they are.
CREATE TABLE submitter (
  name    TEXT PRIMARY KEY,
  ready   INTEGER NOT NULL DEFAULT 0,  -- jobs that may start
  running INTEGER NOT NULL DEFAULT 0,  -- jobs that occupy a worker
  charge  REAL NOT NULL
) WITHOUT ROWID;
CREATE INDEX submitter_idle ON submitter (charge) WHERE ready = 0 AND running = 0;

-- The jobs that may start, counted by priority and submitter; the order of the index is the order
-- in which they are served.
CREATE TABLE submitter_queue (
  submitter TEXT NOT NULL,
  priority  INTEGER NOT NULL,
  ready     INTEGER NOT NULL,          -- jobs, at least one
  running   INTEGER NOT NULL,          -- as in submitter
  charge    REAL NOT NULL,             -- as in submitter
  job_id    INTEGER NOT NULL,          -- the oldest of the jobs
  PRIMARY KEY (submitter, priority)
) WITHOUT ROWID;
CREATE INDEX submitter_queue_order ON submitter_queue (priority DESC, running, charge, job_id);

CREATE INDEX job_ready ON job (submitter, priority) WHERE ready = 1;
CREATE INDEX job_retry ON job (not_before_ms) WHERE state = 'retry_wait' AND retry_due = 0;
CREATE INDEX job_waits_for ON job (waits_for) WHERE waits_for IS NOT NULL;
CREATE INDEX attempt_open ON attempt (job_id) WHERE outcome = '';

INSERT INTO submitter (name, ready, running, charge)
  SELECT submitter, sum(ready), sum(state IN ('starting', 'running', 'cancelling')),
    min(created_ms) / 60000 / 10.0 - 3.3219
  FROM job WHERE ready OR state IN ('starting', 'running', 'cancelling') GROUP BY submitter;
INSERT INTO submitter_queue (submitter, priority, ready, running, charge, job_id)
  SELECT submitter.name, job.priority, count(*), submitter.running, submitter.charge, min(job.id)
  FROM job JOIN submitter ON submitter.name = job.submitter WHERE job.ready
  GROUP BY submitter.name, job.priority;

CREATE TRIGGER job_enters_queue_insert AFTER INSERT ON job WHEN NEW.ready
BEGIN
  INSERT INTO submitter (name, ready, charge)
    VALUES (NEW.submitter, 1, NEW.created_ms / 60000 / 10.0 - 3.3219)
    ON CONFLICT DO UPDATE SET ready = ready + 1,
      charge = iif(ready = 0 AND running = 0, max(charge, excluded.charge), charge);
  INSERT INTO submitter_queue (submitter, priority, ready, running, charge, job_id)
    SELECT name, NEW.priority, 1, running, charge, NEW.id FROM submitter
    WHERE name = NEW.submitter
    ON CONFLICT DO UPDATE SET ready = ready + 1, job_id = min(job_id, excluded.job_id);
END;

CREATE TRIGGER job_enters_queue AFTER UPDATE OF state, waits_for, retry_due, priority ON job
WHEN NEW.ready AND (NOT OLD.ready OR NEW.priority <> OLD.priority)
BEGIN
  INSERT INTO submitter (name, ready, charge)
    VALUES (NEW.submitter, 1, CAST((julianday('now') - 2440587.5) * 1440.0 AS INTEGER) / 10.0 - 3.3219)
    ON CONFLICT DO UPDATE SET ready = ready + 1,
      charge = iif(ready = 0 AND running = 0, max(charge, excluded.charge), charge);
  INSERT INTO submitter_queue (submitter, priority, ready, running, charge, job_id)
    SELECT name, NEW.priority, 1, running, charge, NEW.id FROM submitter
    WHERE name = NEW.submitter
    ON CONFLICT DO UPDATE SET ready = ready + 1, job_id = min(job_id, excluded.job_id);
END;

CREATE TRIGGER job_leaves_queue AFTER UPDATE OF state, waits_for, retry_due, priority ON job
WHEN OLD.ready AND (NOT NEW.ready OR NEW.priority <> OLD.priority)
BEGIN
  UPDATE submitter SET ready = ready - 1 WHERE name = OLD.submitter;
  DELETE FROM submitter_queue
    WHERE submitter = OLD.submitter AND priority = OLD.priority AND ready = 1;
  UPDATE submitter_queue SET ready = ready - 1, job_id = (SELECT min(id) FROM job
      WHERE ready = 1 AND submitter = OLD.submitter AND priority = OLD.priority)
    WHERE submitter = OLD.submitter AND priority = OLD.priority;
END;

CREATE TRIGGER job_takes_worker AFTER UPDATE OF state ON job
WHEN NEW.state IN ('starting', 'running', 'cancelling')
  AND OLD.state NOT IN ('starting', 'running', 'cancelling')
BEGIN
  UPDATE submitter SET running = running + 1 WHERE name = NEW.submitter;
END;
CREATE TRIGGER job_frees_worker AFTER UPDATE OF state ON job
WHEN OLD.state IN ('starting', 'running', 'cancelling')
  AND NEW.state NOT IN ('starting', 'running', 'cancelling')
BEGIN
  UPDATE submitter SET running = running - 1 WHERE name = OLD.submitter;
END;

-- Who waits for the answer of an equal job goes on when that one ends or will have none.
CREATE TRIGGER job_answers AFTER UPDATE OF state ON job
WHEN OLD.state IN ('starting', 'running', 'retry_wait')
  AND NEW.state NOT IN ('starting', 'running', 'retry_wait')
BEGIN
  UPDATE job SET waits_for = NULL WHERE waits_for = NEW.id;
END;

-- The queue is in the order of what the submitters have and use.
CREATE TRIGGER submitter_share AFTER UPDATE OF running, charge ON submitter
BEGIN
  UPDATE submitter_queue SET running = NEW.running, charge = NEW.charge
    WHERE submitter = NEW.name;
END;
