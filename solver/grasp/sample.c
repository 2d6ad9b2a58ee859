#include "solver/grasp/sample.h"

#include <math.h>
#include <stdlib.h>
#include "solver/job/json.h"

/* What the number of a gripper is, from those of its fingers. */
enum together { TOGETHER_SAME, TOGETHER_SUM, TOGETHER_MOST, TOGETHER_BY_FORCE };

static const struct {
  const char *key;
  double unit; /* one of the number's SI unit in that of the key */
  enum together together;
} numbers[GRASP_NUMBERS] = {
    [GRASP_TIME] = {"time_s", 1, TOGETHER_MOST},
    [GRASP_PRESSURE] = {"pressure_kPa", 1e-3, TOGETHER_SAME},
    [GRASP_SHIFT] = {"displacement_mm", 1e3, TOGETHER_SAME},
    [GRASP_TURNED] = {"turned_deg", 180 / M_PI, TOGETHER_SAME},
    [GRASP_FORCE_X] = {"force_x_N", 1, TOGETHER_SUM},
    [GRASP_FORCE_Y] = {"force_y_N", 1, TOGETHER_SUM},
    [GRASP_FORCE_Z] = {"force_z_N", 1, TOGETHER_SUM},
    [GRASP_MOMENT_X] = {"moment_x_N_mm", 1e3, TOGETHER_SUM},
    [GRASP_MOMENT_Y] = {"moment_y_N_mm", 1e3, TOGETHER_SUM},
    [GRASP_MOMENT_Z] = {"moment_z_N_mm", 1e3, TOGETHER_SUM},
    [GRASP_HOLD] = {"grasp_force_N", 1, TOGETHER_SUM},
    [GRASP_TWIST] = {"grasp_moment_N_mm", 1e3, TOGETHER_SUM},
    [GRASP_NORMAL] = {"normal_force_N", 1, TOGETHER_SUM},
    [GRASP_FRICTION] = {"friction_force_N", 1, TOGETHER_SUM},
    [GRASP_AREA] = {"contact_area_mm2", 1e6, TOGETHER_SUM},
    [GRASP_PEAK] = {"contact_pressure_max_kPa", 1e-3, TOGETHER_MOST},
    [GRASP_UNIFORMITY] = {"contact_pressure_uniformity", 1, TOGETHER_BY_FORCE},
    [GRASP_SLIP] = {"slip_share", 1, TOGETHER_BY_FORCE},
    [GRASP_WRAP] = {"wrap_angle_deg", 180 / M_PI, TOGETHER_MOST},
    [GRASP_MATCH] = {"curvature_match", 1, TOGETHER_BY_FORCE},
    [GRASP_SUCTION] = {"suction_force_N", 1, TOGETHER_SUM},
    [GRASP_RUBBED] = {"friction_work_mJ", 1e3, TOGETHER_SUM},
    [GRASP_BENDING] = {"bending_angle_deg", 180 / M_PI, TOGETHER_MOST},
};

const char *grasp_stage_word(enum grasp_stage stage) {
  static const char *const words[STAGE_COUNT] = {"gravity",    "approach", "inflation", "suction",
                                                 "letting go", "pull",     "release"};
  return words[stage];
}

json_t *grasp_sample_object(const struct grasp_sample *sample) {
  json_t *object = json_pack("{s:s}", "stage", grasp_stage_word(sample->stage));
  for (int k = 0; object && k < GRASP_NUMBERS; k++) {
    json_set_finite(object, numbers[k].key, numbers[k].unit * sample->value[k]);
  }
  if (object) {
    json_object_set_new(object, "dynamic", json_boolean(sample->dynamic));
    json_object_set_new(object, "recorded", json_boolean(sample->recorded));
  }
  return object;
}

enum status grasp_series_add(struct grasp_series *series, const struct grasp_sample *sample) {
  if (series->count == series->room) {
    size_t room = 2 * series->room + 64;
    struct grasp_sample *grown = realloc(series->sample, room * sizeof *grown);
    if (!grown) {
      return STATUS_NO_MEMORY;
    }
    series->sample = grown;
    series->room = room;
  }
  series->sample[series->count++] = *sample;
  return STATUS_OK;
}

void grasp_series_release(struct grasp_series *series) {
  free(series->sample);
  *series = (struct grasp_series){0};
}

/* ---- fingers together --------------------------------------------------------------------- */

static int order(const struct grasp_sample *a, const struct grasp_sample *b) {
  return a->stage != b->stage ? (a->stage > b->stage) - (a->stage < b->stage)
                              : (a->along > b->along) - (a->along < b->along);
}

/* The finger's state where it has come as far as *at, from the last state that is not beyond it (of
 * number `before`) and the one after it. */
static struct grasp_sample interpolated(const struct grasp_series *series, size_t before,
                                        const struct grasp_sample *at) {
  const struct grasp_sample *a = &series->sample[before];
  bool more = before + 1 < series->count && series->sample[before + 1].stage == at->stage &&
              a->stage == at->stage;
  const struct grasp_sample *b = more ? a + 1 : a;
  double t = b->along > a->along ? (at->along - a->along) / (b->along - a->along) : 0;
  struct grasp_sample sample = *a;
  for (int k = 0; k < GRASP_NUMBERS; k++) {
    sample.value[k] += t * (b->value[k] - a->value[k]);
  }
  sample.dynamic = t > 0 ? b->dynamic : a->dynamic;
  return sample;
}

static void turn(const double rotation[3][3], double *v) {
  double x = v[0], y = v[1], z = v[2];
  for (int i = 0; i < 3; i++) {
    v[i] = rotation[i][0] * x + rotation[i][1] * y + rotation[i][2] * z;
  }
}

static void add_finger(struct grasp_sample *sum, const struct grasp_sample *finger) {
  double weight = finger->value[GRASP_NORMAL];
  for (int k = 0; k < GRASP_NUMBERS; k++) {
    double *to = &sum->value[k], value = finger->value[k];
    switch (numbers[k].together) {
    case TOGETHER_SAME:
      *to = value;
      break;
    case TOGETHER_SUM:
      *to += value;
      break;
    case TOGETHER_MOST:
      *to = fmax(*to, value);
      break;
    case TOGETHER_BY_FORCE:
      *to += weight * value;
      break;
    }
  }
  sum->dynamic = sum->dynamic || finger->dynamic;
}

static struct grasp_sample sum_at(const struct grasp_share *share, int count, const size_t *before,
                                  const struct grasp_sample *at) {
  struct grasp_sample sum = {.stage = at->stage, .along = at->along, .recorded = at->recorded};
  for (int f = 0; f < count; f++) {
    struct grasp_sample finger = interpolated(share[f].series, before[f], at);
    turn(share[f].rotation, &finger.value[GRASP_FORCE_X]);
    turn(share[f].rotation, &finger.value[GRASP_MOMENT_X]);
    add_finger(&sum, &finger);
  }
  for (int k = 0; k < GRASP_NUMBERS; k++) {
    if (numbers[k].together == TOGETHER_BY_FORCE) {
      double force = sum.value[GRASP_NORMAL];
      sum.value[k] = force > 0 ? sum.value[k] / force : 0;
    }
  }
  return sum;
}

/* The next place after *last that one of the fingers has a state at; NULL when a finger has come
 * to its end. */
static const struct grasp_sample *next_place(const struct grasp_share *share, int count,
                                             size_t *before, const struct grasp_sample *last) {
  const struct grasp_sample *next = NULL;
  for (int f = 0; f < count; f++) {
    const struct grasp_series *series = share[f].series;
    size_t k = last ? before[f] + 1 : 0;
    if (k >= series->count) {
      return NULL;
    }
    next = !next || order(&series->sample[k], next) < 0 ? &series->sample[k] : next;
  }
  for (int f = 0; f < count; f++) {
    const struct grasp_series *series = share[f].series;
    size_t k = last ? before[f] + 1 : 0;
    before[f] = order(&series->sample[k], next) == 0 ? k : before[f];
  }
  return next;
}

enum status grasp_series_sum(const struct grasp_share *share, int count, struct grasp_series *sum) {
  enum { FINGERS = 16 };
  size_t before[FINGERS] = {0};
  enum status status = count <= FINGERS ? STATUS_OK : STATUS_INTERNAL;
  const struct grasp_sample *at = NULL;
  while (status == STATUS_OK && (at = next_place(share, count, before, at))) {
    struct grasp_sample sample = sum_at(share, count, before, at);
    status = grasp_series_add(sum, &sample);
  }
  return status;
}
