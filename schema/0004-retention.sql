-- Files of finished jobs are removed when they are old or too many; what the database knows stays.

-- 'PNLB' in the header of the file tells our databases from those of other programs.
PRAGMA application_id = 1347308610;

ALTER TABLE job ADD COLUMN files_bytes INTEGER;        -- on the disk, of all its attempts; NULL: not
                                                       -- measured yet
ALTER TABLE job ADD COLUMN files_removed_ms INTEGER;   -- since then its files are gone, or going
ALTER TABLE job ADD COLUMN files_removed_why TEXT NOT NULL DEFAULT ''; -- 'age' or 'size'

-- The finished jobs with files, oldest first.
CREATE INDEX job_with_files ON job (finished_ms, id, files_bytes, attempt)
  WHERE finished_ms IS NOT NULL AND files_removed_ms IS NULL AND attempt > 0;

-- One row, written to see whether writing works again.
CREATE TABLE write_probe (
  id    INTEGER PRIMARY KEY CHECK (id = 1),
  at_ms INTEGER NOT NULL
);
