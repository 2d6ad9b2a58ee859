-- Studies: jobs whose members are jobs of their own.

-- ---- jobs ---------------------------------------------------------------------------------

ALTER TABLE job ADD COLUMN study_id INTEGER;       -- the study that the job is a member of
ALTER TABLE job ADD COLUMN member INTEGER;         -- its place in the study: 0, 1, ...
ALTER TABLE job ADD COLUMN chain INTEGER;          -- members solved one after the other, each from
ALTER TABLE job ADD COLUMN chain_position INTEGER; -- the state of the one before: 0, 1, ...
ALTER TABLE job ADD COLUMN extends INTEGER;        -- of a study: the shorter one that it continues

CREATE UNIQUE INDEX job_member ON job (study_id, member) WHERE study_id IS NOT NULL;
CREATE UNIQUE INDEX job_chain ON job (study_id, chain, chain_position) WHERE chain IS NOT NULL;

-- A study occupies no worker and waits for none: its members do.
DROP TRIGGER job_enters_queue_insert;
DROP TRIGGER job_enters_queue;
DROP TRIGGER job_leaves_queue;
DROP TRIGGER job_takes_worker;
DROP TRIGGER job_frees_worker;
DROP INDEX job_ready;
ALTER TABLE job DROP COLUMN ready;
ALTER TABLE job ADD COLUMN ready INTEGER GENERATED ALWAYS AS         -- 1: a worker may start it now
  (kind <> 'study' AND
   ((state = 'queued' AND waits_for IS NULL) OR (state = 'retry_wait' AND retry_due = 1))) VIRTUAL;

-- Of a submitter's jobs of one priority those of no study go first, then the oldest: one job need
-- not wait for ten thousand.
CREATE INDEX job_ready ON job (submitter, priority, study_id IS NOT NULL) WHERE ready = 1;

DELETE FROM submitter_queue;
DELETE FROM submitter;
INSERT INTO submitter (name, ready, running, charge)
  SELECT submitter, sum(ready),
    sum(kind <> 'study' AND state IN ('starting', 'running', 'cancelling')),
    min(created_ms) / 60000 / 10.0 - 3.3219
  FROM job WHERE ready OR (kind <> 'study' AND state IN ('starting', 'running', 'cancelling'))
  GROUP BY submitter;
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
    ON CONFLICT DO UPDATE SET ready = ready + 1, job_id = (SELECT id FROM job
      WHERE ready = 1 AND submitter = NEW.submitter AND priority = NEW.priority
      ORDER BY study_id IS NOT NULL, id LIMIT 1);
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
    ON CONFLICT DO UPDATE SET ready = ready + 1, job_id = (SELECT id FROM job
      WHERE ready = 1 AND submitter = NEW.submitter AND priority = NEW.priority
      ORDER BY study_id IS NOT NULL, id LIMIT 1);
END;

CREATE TRIGGER job_leaves_queue AFTER UPDATE OF state, waits_for, retry_due, priority ON job
WHEN OLD.ready AND (NOT NEW.ready OR NEW.priority <> OLD.priority)
BEGIN
  UPDATE submitter SET ready = ready - 1 WHERE name = OLD.submitter;
  DELETE FROM submitter_queue
    WHERE submitter = OLD.submitter AND priority = OLD.priority AND ready = 1;
  UPDATE submitter_queue SET ready = ready - 1, job_id = (SELECT id FROM job
      WHERE ready = 1 AND submitter = OLD.submitter AND priority = OLD.priority
      ORDER BY study_id IS NOT NULL, id LIMIT 1)
    WHERE submitter = OLD.submitter AND priority = OLD.priority;
END;

CREATE TRIGGER job_takes_worker AFTER UPDATE OF state ON job
WHEN NEW.state IN ('starting', 'running', 'cancelling')
  AND NEW.kind <> 'study' AND OLD.state NOT IN ('starting', 'running', 'cancelling')
BEGIN
  UPDATE submitter SET running = running + 1 WHERE name = NEW.submitter;
END;
CREATE TRIGGER job_frees_worker AFTER UPDATE OF state ON job
WHEN OLD.state IN ('starting', 'running', 'cancelling')
  AND NEW.kind <> 'study' AND NEW.state NOT IN ('starting', 'running', 'cancelling')
BEGIN
  UPDATE submitter SET running = running - 1 WHERE name = OLD.submitter;
END;

-- A study may be held while it runs, and ends in steps when it is cancelled while it waits.
INSERT INTO job_transition (from_state, to_state) VALUES
  ('running', 'held'), ('queued', 'cancelling'), ('held', 'cancelling');

CREATE TRIGGER job_state_of_studies BEFORE UPDATE OF state ON job
WHEN NEW.kind <> 'study' AND ((OLD.state = 'running' AND NEW.state = 'held')
  OR (OLD.state IN ('queued', 'held') AND NEW.state = 'cancelling'))
BEGIN
  SELECT RAISE(ABORT, 'illegal change of job state');
END;

CREATE TRIGGER job_delete_member BEFORE DELETE ON job WHEN OLD.study_id IS NOT NULL
  AND EXISTS (SELECT 1 FROM job JOIN job_state USING (state)
    WHERE job.id = OLD.study_id AND job_state.terminal = 0)
BEGIN
  SELECT RAISE(ABORT, 'a member of a study that has not ended cannot be deleted');
END;

-- The members of a deleted study go after it, a few at a time.
CREATE TABLE study_deleted (
  study_id INTEGER PRIMARY KEY        -- no reference: the study is gone
);

CREATE TRIGGER job_delete_study AFTER DELETE ON job WHEN OLD.kind = 'study'
BEGIN
  INSERT INTO study_deleted (study_id) SELECT OLD.id
    WHERE EXISTS (SELECT 1 FROM job WHERE study_id = OLD.id);
END;

-- ---- studies ------------------------------------------------------------------------------

CREATE TABLE study (
  study_id INTEGER PRIMARY KEY REFERENCES job (id) ON DELETE CASCADE,
  sampling TEXT NOT NULL,             -- 'grid', 'sobol', ...
  members  INTEGER NOT NULL,          -- in all; of an optimisation: so far
  light    INTEGER NOT NULL,          -- 1: members take milliseconds
  stored   INTEGER NOT NULL DEFAULT 0 -- 1: all members are jobs
);

-- What the members differ in. Numbers are in `unit`, in which people are shown them.
CREATE TABLE study_parameter (
  study_id    INTEGER NOT NULL REFERENCES job (id) ON DELETE CASCADE,
  position    INTEGER NOT NULL,          -- 0, 1, ... in the order of the study
  pointer     TEXT NOT NULL,             -- into the member's job
  name        TEXT NOT NULL,             -- for people
  unit        TEXT NOT NULL,             -- 'mm', 'deg'; '' for plain numbers and words
  categorical INTEGER NOT NULL,          -- 1: words, not numbers
  logarithmic INTEGER NOT NULL,          -- 1: spread evenly in the logarithm
  low         REAL,                      -- of the range, or of the values; NULL for words
  high        REAL,
  PRIMARY KEY (study_id, position)
) WITHOUT ROWID;

-- The value of each parameter in each member; no row where a member has none.
CREATE TABLE study_value (
  study_id INTEGER NOT NULL REFERENCES job (id) ON DELETE CASCADE,
  member   INTEGER NOT NULL,
  position INTEGER NOT NULL,
  number   REAL,                         -- in the parameter's unit; NULL for words
  text     TEXT NOT NULL,                -- as the study gives it
  PRIMARY KEY (study_id, member, position)
) WITHOUT ROWID;

-- ---- lists --------------------------------------------------------------------------------
-- As those of all jobs: of the members of a study, and of jobs that belong to none.
CREATE INDEX job_member_by_state ON job (study_id, state) WHERE study_id IS NOT NULL;
CREATE INDEX job_member_by_finished ON job (study_id, state, finished_ms)
  WHERE study_id IS NOT NULL;
CREATE INDEX job_member_by_name ON job (study_id, state, name) WHERE study_id IS NOT NULL;
CREATE INDEX job_single_by_state ON job (state) WHERE study_id IS NULL;
CREATE INDEX job_single_by_finished ON job (state, finished_ms) WHERE study_id IS NULL;
CREATE INDEX job_single_by_name ON job (state, name) WHERE study_id IS NULL;
CREATE INDEX job_single_by_kind ON job (kind, state) WHERE study_id IS NULL;
CREATE INDEX job_single_by_kind_finished ON job (kind, state, finished_ms)
  WHERE study_id IS NULL;
CREATE INDEX job_single_by_kind_name ON job (kind, state, name) WHERE study_id IS NULL;

DROP VIEW comparison;

-- One row a finished job: what was asked and what came out, without a join. A parameter that
-- the job left to its default is NULL here, and so is a metric that its kind does not have.
CREATE VIEW comparison AS
SELECT job.id, job.name, job.kind, job.state, job.reason_code,
  (SELECT text FROM design_parameter WHERE job_id = job.id
     AND pointer = '/actuator/family') AS family,
  (SELECT 1e3 * value FROM design_parameter WHERE job_id = job.id
     AND pointer = '/actuator/length') AS length_mm,
  (SELECT 1e3 * value FROM design_parameter WHERE job_id = job.id
     AND pointer = '/actuator/width') AS width_mm,
  (SELECT 1e3 * max(value) FROM design_parameter WHERE job_id = job.id
     AND pointer IN ('/actuator/height', '/actuator/height/base')) AS height_mm,
  (SELECT sum(value) FROM design_parameter WHERE job_id = job.id
     AND pointer GLOB '/actuator/chambers/[0-9]*/count') AS chambers,
  (SELECT 1e3 * value FROM design_parameter WHERE job_id = job.id
     AND pointer = '/actuator/chamber_gap') AS chamber_gap_mm,
  (SELECT 1e3 * value FROM design_parameter WHERE job_id = job.id
     AND pointer = '/actuator/side_wall') AS side_wall_mm,
  (SELECT 1e3 * value FROM design_parameter WHERE job_id = job.id
     AND pointer = '/actuator/gap_wall') AS gap_wall_mm,
  (SELECT 1e3 * value FROM design_parameter WHERE job_id = job.id
     AND pointer = '/actuator/top_wall') AS top_wall_mm,
  (SELECT 1e3 * value FROM design_parameter WHERE job_id = job.id
     AND pointer = '/actuator/bottom_layer') AS bottom_layer_mm,
  (SELECT text FROM design_parameter WHERE job_id = job.id
     AND pointer = '/actuator/gap_shape') AS gap_shape,
  (SELECT 57.29577951308232 * value FROM design_parameter WHERE job_id = job.id
     AND pointer = '/actuator/chamber_angle') AS chamber_angle_deg,
  (SELECT max(text) FROM design_parameter WHERE job_id = job.id
     AND pointer IN ('/material', '/material/model')) AS material,
  (SELECT 1e-3 * value FROM design_parameter WHERE job_id = job.id
     AND pointer = '/load/pressure/to') AS pressure_to_kPa,
  (SELECT 1e-3 * value FROM design_parameter WHERE job_id = job.id
     AND pointer = '/load/pressure/left') AS pressure_left_kPa,
  (SELECT 1e-3 * value FROM design_parameter WHERE job_id = job.id
     AND pointer = '/load/pressure/right') AS pressure_right_kPa,
  (SELECT text FROM design_parameter WHERE job_id = job.id
     AND pointer = '/contact') AS contact,
  (SELECT text FROM design_parameter WHERE job_id = job.id
     AND pointer = '/accuracy') AS accuracy,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'bending_angle_deg')
     AS bending_angle_deg,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'chord_angle_deg')
     AS chord_angle_deg,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'end_face_angle_deg')
     AS end_face_angle_deg,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'twist_angle_deg')
     AS twist_angle_deg,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'contraction_pct')
     AS contraction_pct,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'sensitivity_deg_per_kPa')
     AS sensitivity_deg_per_kPa,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'r_squared')
     AS r_squared,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'cai_rad_per_m_kPa')
     AS cai_rad_per_m_kPa,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'tip_deflection_mm')
     AS tip_deflection_mm,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'contact_onset_kPa')
     AS contact_onset_kPa,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'cavity_volume_mm3')
     AS cavity_volume_mm3,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'mass_g')
     AS mass_g,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'max_stretch')
     AS max_stretch,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'suction_force_N')
     AS suction_force_N,
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'min_gap_mm')
     AS min_gap_mm,
  job.attempt AS attempts,
  (job.finished_ms - job.started_ms) / 1000.0 AS run_s,
  strftime('%Y-%m-%dT%H:%M:%SZ', job.finished_ms / 1000, 'unixepoch') AS finished,
  job.spec_hash, job.study_id, job.member
FROM job
JOIN job_state USING (state)
WHERE job_state.terminal = 1;
