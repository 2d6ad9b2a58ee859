#include "solver/grasp/gripper.h"

#include <math.h>
#include <string.h>
#include "solver/base/vec3.h"
#include "solver/job/json.h"

/* Share of the normal force beyond which the body slips as a whole. */
static const double slipping = 0.5;

/* The frame of a finger in that of the gripper: what grasp_of_finger undoes. */
static void frame_of(const struct grasp_fingers *f, int number, struct gripper_finger *finger) {
  static const double same[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (f->count < 2) {
    memcpy(finger->rotation, same, sizeof same);
    return;
  }
  double a = 2 * M_PI * number / f->count, c = cos(a), s = sin(a);
  double ct = cos(f->tilt), st = sin(f->tilt);
  double rotation[3][3] = {{ct, 0, -st}, {-s * st, c, -s * ct}, {c * st, s, c * ct}};
  memcpy(finger->rotation, rotation, sizeof rotation);
  finger->place[1] = -s * f->radius;
  finger->place[2] = c * f->radius;
}

void gripper_init(struct gripper *g, const struct job_spec *spec) {
  *g = (struct gripper){.spec = spec, .count = spec->grasp->fingers.count};
  struct grasp_spec seen[GRASP_FINGERS_MAX];
  for (int k = 0; k < g->count; k++) {
    struct gripper_finger *finger = &g->finger[k];
    seen[k] = grasp_of_finger(spec->grasp, k);
    *finger = (struct gripper_finger){.solved = true, .like = k};
    for (int j = 0; j < k && finger->solved && !spec->whole_model; j++) {
      if (g->finger[j].solved && grasp_same(&seen[j], &seen[k])) {
        finger->solved = false;
        finger->like = j;
      }
    }
    g->solved += finger->solved;
    finger->half = finger_symmetric(spec, k);
    frame_of(&spec->grasp->fingers, k, finger);
  }
}

void gripper_release(struct gripper *g) {
  for (int k = 0; k < g->count; k++) {
    course_report_release(&g->finger[k].report);
  }
  grasp_series_release(&g->sum);
}

enum status gripper_sum(struct gripper *g) {
  struct grasp_share share[GRASP_FINGERS_MAX];
  for (int k = 0; k < g->count; k++) {
    share[k].series = &g->finger[g->finger[k].like].report.series;
    memcpy(share[k].rotation, g->finger[k].rotation, sizeof share[k].rotation);
  }
  return grasp_series_sum(share, g->count, &g->sum);
}

/* ---- figures ------------------------------------------------------------------------------ */

static const struct grasp_sample *last_of(const struct grasp_series *s, enum grasp_stage stage) {
  const struct grasp_sample *last = NULL;
  for (size_t i = 0; i < s->count; i++) {
    last = s->sample[i].stage == stage ? &s->sample[i] : last;
  }
  return last;
}

static bool touches(const struct grasp_sample *sample) {
  return sample && sample->value[GRASP_AREA] > 0;
}

const char *gripper_outcome(const struct gripper *g) {
  const struct grasp_series *s = &g->sum;
  const struct grasp_sample *let_go = last_of(s, STAGE_LETTING_GO);
  bool touched = false;
  for (size_t i = 0; i < s->count; i++) {
    touched = touched || s->sample[i].value[GRASP_AREA] > 0;
  }
  const struct grasp_sample *end = last_of(s, STAGE_PULL);
  end = end ? end : let_go ? let_go : s->count > 0 ? &s->sample[s->count - 1] : NULL;
  return let_go && !touches(let_go) ? "fell"
         : !touched                 ? "never touched"
         : touches(end)             ? "held"
                                    : "released";
}

/* Force over the pull: peak, mean while there is contact, where it begins to slip and comes free.
 */
static void set_pull(const struct gripper *g, json_t *metrics) {
  const struct grasp_series *s = &g->sum;
  const struct grasp_sample *last = NULL;
  double peak = -INFINITY, peak_at = 0, work = 0, twist = 0, way = 0, slip = NAN, free_at = NAN;
  for (size_t i = 0; i < s->count; i++) {
    const struct grasp_sample *now = &s->sample[i];
    const double *v = now->value;
    if (now->stage != STAGE_PULL) {
      continue;
    }
    if (v[GRASP_HOLD] > peak) {
      peak = v[GRASP_HOLD];
      peak_at = v[GRASP_SHIFT];
    }
    bool slips = v[GRASP_SLIP] > slipping && v[GRASP_SHIFT] > 0;
    slip = isnan(slip) && slips ? v[GRASP_SHIFT] : slip;
    if (last && (last->value[GRASP_AREA] > 0 || v[GRASP_AREA] > 0)) {
      double step = v[GRASP_SHIFT] - last->value[GRASP_SHIFT];
      double turn = v[GRASP_TURNED] - last->value[GRASP_TURNED];
      work += 0.5 * step * (v[GRASP_HOLD] + last->value[GRASP_HOLD]);
      twist += 0.5 * turn * (v[GRASP_TWIST] + last->value[GRASP_TWIST]);
      way += step;
    }
    free_at = v[GRASP_AREA] > 0 ? NAN : isnan(free_at) ? v[GRASP_SHIFT] : free_at;
    last = now;
  }
  if (!last) {
    return;
  }
  json_set_finite(metrics, "grasp_force_peak_N", fmax(peak, 0));
  json_set_finite(metrics, "grasp_force_peak_at_mm", 1e3 * peak_at);
  json_set_finite(metrics, "grasp_force_mean_N", way > 0 ? work / way : 0);
  json_set_finite(metrics, "pull_work_mJ", 1e3 * (work + twist));
  json_set_finite(metrics, "slip_onset_mm", 1e3 * slip);
  json_set_finite(metrics, "released_at_mm", 1e3 * free_at);
}

/* How the object is held at full pressure, before it is pulled. */
static void set_hold(const struct gripper *g, json_t *metrics) {
  static const char *const keys[] = {"normal_force_N",           "contact_area_mm2",
                                     "contact_pressure_max_kPa", "contact_pressure_uniformity",
                                     "wrap_angle_deg",           "curvature_match",
                                     "bending_angle_deg"};
  const struct grasp_sample *hold = last_of(&g->sum, STAGE_INFLATION);
  const struct grasp_sample *drawn = last_of(&g->sum, STAGE_SUCTION);
  json_t *object = hold ? grasp_sample_object(hold) : NULL;
  for (size_t i = 0; object && i < sizeof keys / sizeof *keys; i++) {
    json_object_set(metrics, keys[i], json_object_get(object, keys[i]));
  }
  if (object && g->spec->family == FAMILY_PNEUNET && g->spec->pneunet.sucker_count > 0) {
    json_set_finite(metrics, "suction_force_N", (drawn ? drawn : hold)->value[GRASP_SUCTION]);
  }
  if (object && g->spec->grasp->blocked) {
    json_object_set(metrics, "blocked_force_N", json_object_get(object, "grasp_force_N"));
  }
  json_decref(object);
}

/* How a free object is held when it has been let go. */
static void set_free(const struct gripper *g, json_t *metrics) {
  const struct grasp_series *s = &g->sum;
  const struct grasp_spec *spec = g->spec->grasp;
  const struct grasp_sample *end = last_of(s, STAGE_LETTING_GO);
  double weight = spec->object.mass * vec3_norm(spec->gravity), most = 0;
  if (!end) {
    return;
  }
  for (size_t i = 0; i < s->count; i++) {
    const struct grasp_sample *now = &s->sample[i];
    if (now->stage == STAGE_LETTING_GO) { /* all at rest, but for one that has fallen */
      most = fmax(most, now->value[GRASP_HOLD]);
    }
  }
  if (!touches(end) || end->along == 1) { /* else it is not known */
    json_set_finite(metrics, "held", touches(end));
  }
  json_set_finite(metrics, "object_displacement_mm", 1e3 * end->value[GRASP_SHIFT]);
  if (weight > 0) {
    json_set_finite(metrics, "object_weight_N", weight);
    json_set_finite(metrics, "weight_carried_N", most);
  }
}

/* What resists a pull that turns the object. */
static void set_twist(const struct gripper *g, json_t *metrics) {
  const struct grasp_series *s = &g->sum;
  double most = 0;
  bool turned = false;
  for (size_t i = 0; i < s->count; i++) {
    turned = turned || s->sample[i].value[GRASP_TURNED] > 0;
    most = fmax(most, s->sample[i].value[GRASP_TWIST]);
  }
  if (turned) {
    json_set_finite(metrics, "grasp_moment_peak_N_mm", 1e3 * most);
  }
}

json_t *gripper_metrics(const struct gripper *g) {
  json_t *metrics = json_object();
  double energy = 0, motion = 0;
  int carried = 0;
  for (int k = 0; k < g->count; k++) {
    const struct course_report *report = &g->finger[g->finger[k].like].report;
    energy = fmax(energy, report->energy_error);
    motion += report->in_motion / g->count;
    carried += report->carried;
  }
  if (!metrics || g->sum.count == 0) {
    return metrics;
  }
  const double *end = g->sum.sample[g->sum.count - 1].value;
  set_pull(g, metrics);
  set_twist(g, metrics);
  set_hold(g, metrics);
  set_free(g, metrics);
  json_set_finite(metrics, "friction_work_mJ", 1e3 * end[GRASP_RUBBED]);
  json_set_finite(metrics, "energy_error_pct", 100 * energy);
  json_set_finite(metrics, "dynamic_share_pct", 100 * motion);
  json_set_finite(metrics, "jumps", carried);
  return metrics;
}
