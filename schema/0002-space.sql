-- Bodies that bend and twist, with a pressure for each row: their columns in the two views.
DROP VIEW sample_row;
DROP VIEW comparison;

CREATE VIEW sample_row AS
SELECT job_id, step,
  max(value) FILTER (WHERE name = 'pressure_kPa')       AS pressure_kPa,
  max(value) FILTER (WHERE name = 'bending_angle_deg')  AS bending_angle_deg,
  max(value) FILTER (WHERE name = 'chord_angle_deg')    AS chord_angle_deg,
  max(value) FILTER (WHERE name = 'end_face_angle_deg') AS end_face_angle_deg,
  max(value) FILTER (WHERE name = 'tip_x_mm')           AS tip_x_mm,
  max(value) FILTER (WHERE name = 'tip_y_mm')           AS tip_y_mm,
  max(value) FILTER (WHERE name = 'tip_z_mm')           AS tip_z_mm,
  max(value) FILTER (WHERE name = 'twist_angle_deg')    AS twist_angle_deg,
  max(value) FILTER (WHERE name = 'reach_mm')           AS reach_mm,
  max(value) FILTER (WHERE name = 'contraction_pct')    AS contraction_pct,
  max(value) FILTER (WHERE name = 'cavity_volume_mm3')  AS cavity_volume_mm3,
  max(value) FILTER (WHERE name = 'min_gap_mm')         AS min_gap_mm,
  max(value) FILTER (WHERE name = 'max_stretch')        AS max_stretch
FROM sample GROUP BY job_id, step;

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
  job.spec_hash
FROM job
JOIN job_state USING (state)
WHERE job_state.terminal = 1;
