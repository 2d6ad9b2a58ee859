-- Jobs, their attempts and what came out of them.
-- Conventions: times are milliseconds since 1970-01-01 UTC; values are SI unless the name of a
-- metric or sample ends in another unit.

-- The states of a job. A terminal job never changes again.
CREATE TABLE job_state (
  state    TEXT PRIMARY KEY,
  terminal INTEGER NOT NULL CHECK (terminal IN (0, 1))
) WITHOUT ROWID;

INSERT INTO job_state (state, terminal) VALUES
  ('queued', 0), ('held', 0), ('starting', 0), ('running', 0), ('cancelling', 0),
  ('retry_wait', 0),
  ('succeeded', 1), ('failed', 1), ('timed_out', 1), ('cancelled', 1);

-- Every legal change of state; the trigger job_state_machine refuses all others.
CREATE TABLE job_transition (
  from_state TEXT NOT NULL REFERENCES job_state (state),
  to_state   TEXT NOT NULL REFERENCES job_state (state),
  PRIMARY KEY (from_state, to_state)
) WITHOUT ROWID;

INSERT INTO job_transition (from_state, to_state) VALUES
  ('queued', 'starting'), ('queued', 'held'), ('queued', 'cancelled'),
  ('held', 'queued'), ('held', 'cancelled'),
  ('starting', 'running'), ('starting', 'cancelling'), ('starting', 'queued'),
  ('starting', 'retry_wait'), ('starting', 'failed'),
  ('running', 'succeeded'), ('running', 'failed'), ('running', 'timed_out'),
  ('running', 'cancelling'), ('running', 'retry_wait'), ('running', 'queued'),
  ('cancelling', 'cancelled'),
  ('retry_wait', 'starting'), ('retry_wait', 'cancelled');

CREATE TABLE job (
  id              INTEGER PRIMARY KEY AUTOINCREMENT, -- never used again after a deletion
  state           TEXT NOT NULL DEFAULT 'queued' REFERENCES job_state (state),
  reason_code     TEXT NOT NULL DEFAULT '',  -- stable word for why the state was reached
  message         TEXT NOT NULL DEFAULT '',  -- the same in a sentence, for people
  kind            TEXT NOT NULL,             -- 'response', ...
  name            TEXT NOT NULL,             -- the job's own name, '' when it gave none
  document        TEXT NOT NULL,             -- the job document as it was submitted
  spec_hash       TEXT NOT NULL,             -- SHA-256 of the canonical job (no name, no labels)
  timeout_s       REAL NOT NULL DEFAULT 0,   -- the job's own time limit, 0: none
  attempt         INTEGER NOT NULL DEFAULT 0, -- number of the latest attempt; fences late writers
  failures        INTEGER NOT NULL DEFAULT 0, -- attempts whose worker died or broke the contract
  not_before_ms   INTEGER NOT NULL DEFAULT 0, -- in retry_wait: when the next attempt may start
  retry_of        INTEGER,                   -- the job that this one repeats on request
  idempotency_key TEXT UNIQUE,               -- the client's Idempotency-Key
  created_ms      INTEGER NOT NULL,
  started_ms      INTEGER,                   -- start of the latest attempt
  finished_ms     INTEGER                    -- when a terminal state was reached
);

CREATE INDEX job_by_state ON job (state, id);
CREATE INDEX job_by_kind ON job (kind, id);
CREATE INDEX job_by_hash ON job (spec_hash);

CREATE TABLE job_label (
  job_id INTEGER NOT NULL REFERENCES job (id) ON DELETE CASCADE,
  name   TEXT NOT NULL,
  value  TEXT NOT NULL,
  PRIMARY KEY (job_id, name)
) WITHOUT ROWID;

CREATE INDEX job_label_by_value ON job_label (name, value, job_id);

CREATE TABLE attempt (
  job_id         INTEGER NOT NULL REFERENCES job (id) ON DELETE CASCADE,
  number         INTEGER NOT NULL,           -- 1, 2, ... within the job
  outcome        TEXT NOT NULL DEFAULT '',   -- '' while it runs; succeeded, failed, timed_out,
                                             -- cancelled, worker_lost, requeued, lost
  reason_code    TEXT NOT NULL DEFAULT '',
  pid            INTEGER,                    -- process id of the worker
  exit_code      INTEGER,                    -- NULL when a signal ended the worker
  signal         INTEGER,                    -- the signal that ended it, or NULL
  created_ms     INTEGER NOT NULL,
  finished_ms    INTEGER,
  cpu_s          REAL,                       -- user + system time of the worker
  peak_memory_MB REAL,                       -- its largest resident set
  PRIMARY KEY (job_id, number)
) WITHOUT ROWID;

-- At most one row a job: its primary key is what makes a second result impossible.
CREATE TABLE result (
  job_id      INTEGER PRIMARY KEY REFERENCES job (id) ON DELETE CASCADE,
  attempt     INTEGER NOT NULL,              -- the attempt that produced it
  document    TEXT NOT NULL,                 -- the result document as the solver printed it
  directory   TEXT NOT NULL,                 -- of its artifacts, relative to the data directory
  created_ms  INTEGER NOT NULL,
  FOREIGN KEY (job_id, attempt) REFERENCES attempt (job_id, number)
);

CREATE TABLE metric (
  job_id INTEGER NOT NULL REFERENCES job (id) ON DELETE CASCADE,
  name   TEXT NOT NULL,                      -- ends in its unit: bending_angle_deg
  value  REAL NOT NULL,
  PRIMARY KEY (job_id, name)
) WITHOUT ROWID;

CREATE INDEX metric_by_value ON metric (name, value);

-- One row a value of a load step; the view sample_row puts the usual ones into columns.
CREATE TABLE sample (
  job_id INTEGER NOT NULL REFERENCES job (id) ON DELETE CASCADE,
  step   INTEGER NOT NULL,                   -- 0, 1, ... in the order of the result
  name   TEXT NOT NULL,                      -- ends in its unit: pressure_kPa
  value  REAL NOT NULL,
  PRIMARY KEY (job_id, step, name)
) WITHOUT ROWID;

-- The job document flattened: one row a leaf.
CREATE TABLE design_parameter (
  job_id  INTEGER NOT NULL REFERENCES job (id) ON DELETE CASCADE,
  pointer TEXT NOT NULL,                     -- JSON pointer of the leaf
  value   REAL,                              -- number, SI for quantities; 0 or 1 for flags
  text    TEXT NOT NULL,                     -- the leaf as it was written
  unit    TEXT NOT NULL DEFAULT '',          -- SI unit of value; '' for plain numbers and words
  PRIMARY KEY (job_id, pointer)
) WITHOUT ROWID;

CREATE INDEX design_parameter_by_pointer ON design_parameter (pointer, value);

CREATE TABLE artifact (
  job_id INTEGER NOT NULL REFERENCES job (id) ON DELETE CASCADE,
  name   TEXT NOT NULL,                      -- file name inside result.directory
  size   INTEGER NOT NULL,                   -- bytes
  PRIMARY KEY (job_id, name)
) WITHOUT ROWID;

-- What happened to jobs, in order: written by triggers, so no change of state is left out.
CREATE TABLE event (
  id          INTEGER PRIMARY KEY AUTOINCREMENT,
  at_ms       INTEGER NOT NULL,
  job_id      INTEGER NOT NULL,              -- no reference: the history outlives the job
  state       TEXT NOT NULL,                 -- the state reached, or 'deleted'
  reason_code TEXT NOT NULL DEFAULT '',
  attempt     INTEGER NOT NULL DEFAULT 0
);

CREATE INDEX event_by_job ON event (job_id, id);

CREATE TRIGGER job_state_machine BEFORE UPDATE OF state ON job
WHEN NEW.state <> OLD.state AND NOT EXISTS
  (SELECT 1 FROM job_transition WHERE from_state = OLD.state AND to_state = NEW.state)
BEGIN
  SELECT RAISE(ABORT, 'illegal change of job state');
END;

CREATE TRIGGER job_delete_terminal BEFORE DELETE ON job
WHEN (SELECT terminal FROM job_state WHERE state = OLD.state) = 0
BEGIN
  SELECT RAISE(ABORT, 'only a finished job can be deleted');
END;

CREATE TRIGGER job_event_insert AFTER INSERT ON job
BEGIN
  INSERT INTO event (at_ms, job_id, state) VALUES (NEW.created_ms, NEW.id, NEW.state);
END;

CREATE TRIGGER job_event_update AFTER UPDATE OF state ON job WHEN NEW.state <> OLD.state
BEGIN
  INSERT INTO event (at_ms, job_id, state, reason_code, attempt)
  VALUES (CAST(round((julianday('now') - 2440587.5) * 86400000.0) AS INTEGER), NEW.id, NEW.state, NEW.reason_code,
          NEW.attempt);
END;

CREATE TRIGGER job_event_delete AFTER DELETE ON job
BEGIN
  INSERT INTO event (at_ms, job_id, state)
  VALUES (CAST(round((julianday('now') - 2440587.5) * 86400000.0) AS INTEGER), OLD.id, 'deleted');
END;

CREATE VIEW sample_row AS
SELECT job_id, step,
  max(value) FILTER (WHERE name = 'pressure_kPa')       AS pressure_kPa,
  max(value) FILTER (WHERE name = 'bending_angle_deg')  AS bending_angle_deg,
  max(value) FILTER (WHERE name = 'chord_angle_deg')    AS chord_angle_deg,
  max(value) FILTER (WHERE name = 'end_face_angle_deg') AS end_face_angle_deg,
  max(value) FILTER (WHERE name = 'tip_x_mm')           AS tip_x_mm,
  max(value) FILTER (WHERE name = 'tip_y_mm')           AS tip_y_mm,
  max(value) FILTER (WHERE name = 'tip_z_mm')           AS tip_z_mm,
  max(value) FILTER (WHERE name = 'cavity_volume_mm3')  AS cavity_volume_mm3,
  max(value) FILTER (WHERE name = 'min_gap_mm')         AS min_gap_mm,
  max(value) FILTER (WHERE name = 'max_stretch')        AS max_stretch
FROM sample GROUP BY job_id, step;

-- One row a finished job: what was asked and what came out, without a join. A parameter that
-- the job left to its default is NULL here.
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
  (SELECT max(text) FROM design_parameter WHERE job_id = job.id
     AND pointer IN ('/material', '/material/model')) AS material,
  (SELECT 1e-3 * value FROM design_parameter WHERE job_id = job.id
     AND pointer = '/load/pressure/to') AS pressure_to_kPa,
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
  (SELECT value FROM metric WHERE job_id = job.id AND name = 'min_gap_mm')
     AS min_gap_mm,
  job.attempt AS attempts,
  (job.finished_ms - job.started_ms) / 1000.0 AS run_s,
  strftime('%Y-%m-%dT%H:%M:%SZ', job.finished_ms / 1000, 'unixepoch') AS finished,
  job.spec_hash
FROM job
JOIN job_state USING (state)
WHERE job_state.terminal = 1;
