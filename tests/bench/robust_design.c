#include "tests/bench/robust_design.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/job/spec.h"

/* Ranges of the factors; those of choices count the choices. */
static const struct range {
  double from, to;
} ranges[ROBUST_FACTORS] = {
    [ROBUST_HEIGHT] = {12, 24},   [ROBUST_WIDTH] = {22, 36},      [ROBUST_SIDE_WALL] = {1, 3},
    [ROBUST_TOP_WALL] = {1, 2.5}, [ROBUST_BOTTOM_LAYER] = {4, 8}, [ROBUST_GAP] = {1, 3},
    [ROBUST_GAP_WALL] = {1, 2.5}, [ROBUST_CAVITY] = {3, 6},       [ROBUST_TAPER_TOP] = {0, 4},
    [ROBUST_TAPER_SIDE] = {0, 4}, [ROBUST_CHAMBERS] = {4, 15},    [ROBUST_TYPE_BASE] = {0, 3},
    [ROBUST_TYPE_TIP] = {0, 3},   [ROBUST_SPLIT] = {0, 1},        [ROBUST_MATERIAL] = {0, 5}};

static const char *const materials[] = {"dragon-skin-20", "dragon-skin-30", "elastosil-m4601",
                                        "elastic-50a", "elastic-50a-sorotoki"};
static const char *const types[] = {"A", "B", "C"};

/* Least cavity at the tip, mm, and largest number of trades per design. */
static const double least_width = 4, least_height = 2;
enum { TRADES = 2000 };

/* Numbers of SplitMix64 (Steele, Lea, Flood 2014). */
static uint64_t random_next(uint64_t *state) {
  uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
  z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
  return z ^ z >> 31;
}

static double random_unit(uint64_t *state) {
  return (double)(random_next(state) >> 11) * 0x1p-53;
}

static int random_below(uint64_t *state, int limit) {
  return (int)(random_unit(state) * limit);
}

static double value(const double place[ROBUST_FACTORS], enum robust_factor factor) {
  return ranges[factor].from + (ranges[factor].to - ranges[factor].from) * place[factor];
}

static json_t *quantity(const double place[ROBUST_FACTORS], enum robust_factor factor,
                        const char *unit) {
  return json_sprintf("%.4f %s", value(place, factor), unit);
}

static json_t *chambers(const double place[ROBUST_FACTORS]) {
  int count = (int)value(place, ROBUST_CHAMBERS);
  int base = (int)lround(value(place, ROBUST_SPLIT) * count);
  const char *first = types[(int)value(place, ROBUST_TYPE_BASE)];
  const char *second = types[(int)value(place, ROBUST_TYPE_TIP)];
  if (base == 0 || base == count) {
    return json_pack("[{s:s, s:i}]", "config", base > 0 ? first : second, "count", count);
  }
  return json_pack("[{s:s, s:i}, {s:s, s:i}]", "config", first, "count", base, "config", second,
                   "count", count - base);
}

json_t *robust_job(const struct robust_options *options, int index,
                   const double place[ROBUST_FACTORS]) {
  double cavity = value(place, ROBUST_CAVITY), wall = value(place, ROBUST_GAP_WALL);
  json_t *taper = json_pack("{s:o, s:o, s:o}", "top", quantity(place, ROBUST_TAPER_TOP, "deg"),
                            "left", quantity(place, ROBUST_TAPER_SIDE, "deg"), "right",
                            quantity(place, ROBUST_TAPER_SIDE, "deg"));
  json_t *actuator = json_pack(
      "{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "family", "pneunet",
      "chamber_length", json_sprintf("%.4f mm", cavity + 2 * wall), "width",
      quantity(place, ROBUST_WIDTH, "mm"), "height", quantity(place, ROBUST_HEIGHT, "mm"),
      "chambers", chambers(place), "chamber_gap", quantity(place, ROBUST_GAP, "mm"), "side_wall",
      quantity(place, ROBUST_SIDE_WALL, "mm"), "gap_wall", quantity(place, ROBUST_GAP_WALL, "mm"),
      "top_wall", quantity(place, ROBUST_TOP_WALL, "mm"), "bottom_layer",
      quantity(place, ROBUST_BOTTOM_LAYER, "mm"), "taper", taper);
  return json_pack("{s:s, s:o, s:{s:s}, s:o, s:s, s:{s:{s:s, s:i}}, s:b, s:s, s:b}", "kind",
                   "response", "name", json_sprintf("robustness %d", index), "labels", "study",
                   "robustness", "actuator", actuator, "material",
                   materials[(int)value(place, ROBUST_MATERIAL)], "load", "pressure", "to",
                   "60 kPa", "steps", options->steps, "contact", 1, "accuracy", options->accuracy,
                   "error_estimate", options->estimate);
}

/* Whether the body exists and leaves a cavity worth the name at the tip. */
static bool can_be_built(const struct job_reader *reader, const struct robust_options *options,
                         const double place[ROBUST_FACTORS]) {
  struct job_spec spec;
  struct error error;
  json_t *job = robust_job(options, 0, place);
  char *text = json_dumps(job, 0);
  bool good = text && job_reader_read(reader, text, strlen(text), &spec, &error) == STATUS_OK;
  free(text);
  json_decref(job);
  if (!good) {
    return false;
  }
  const struct pneunet_spec *p = &spec.pneunet;
  double side = tan(p->taper_left) * p->length, top = tan(p->taper_top) * p->length;
  double floor = p->bottom_layer;
  for (int r = 0; r < p->run_count; r++) {
    if (p->runs[r].config == CHAMBER_C) {
      floor = p->bottom_layer + p->slit + p->slit_floor;
    }
  }
  return 1e3 * (p->width - 2 * p->side_wall - 2 * side) >= least_width &&
         1e3 * (p->height_base - floor - p->top_wall - top) >= least_height;
}

static void fill_strata(int count, uint64_t *state, double (*place)[ROBUST_FACTORS]) {
  for (int f = 0; f < ROBUST_FACTORS; f++) {
    for (int i = 0; i < count; i++) {
      place[i][f] = (i + random_unit(state)) / count;
    }
    for (int i = count - 1; i > 0; i--) { /* Fisher, Yates */
      int j = random_below(state, i + 1);
      double kept = place[i][f];
      place[i][f] = place[j][f];
      place[j][f] = kept;
    }
  }
}

static void trade(double a[ROBUST_FACTORS], double b[ROBUST_FACTORS], int factor) {
  double kept = a[factor];
  a[factor] = b[factor];
  b[factor] = kept;
}

/* Trades strata of design i with random others, never at the price of one that can be built. */
static bool repair(const struct job_reader *reader, const struct robust_options *options,
                   uint64_t *state, double (*place)[ROBUST_FACTORS], bool *good, int i) {
  for (int t = 0; t < TRADES && !good[i]; t++) {
    int j = random_below(state, options->count), factor = random_below(state, ROBUST_FACTORS);
    if (j == i) {
      continue;
    }
    trade(place[i], place[j], factor);
    bool now = can_be_built(reader, options, place[i]);
    bool other = can_be_built(reader, options, place[j]);
    if (now + other > good[i] + good[j] || (now + other == good[i] + good[j] && !good[j])) {
      good[i] = now;
      good[j] = other;
    } else {
      trade(place[i], place[j], factor);
    }
  }
  return good[i];
}

bool robust_sample(const struct robust_options *options, double (*place)[ROBUST_FACTORS]) {
  struct job_reader *reader = NULL;
  struct error error = {0};
  uint64_t state = options->seed;
  bool *good = calloc((size_t)options->count + 1, sizeof *good), complete = good != NULL;
  if (!good || job_reader_create(&reader, &error) != STATUS_OK) {
    fprintf(stderr, "no designs: %s\n", good ? error.message : "out of memory");
    free(good);
    return false;
  }
  fill_strata(options->count, &state, place);
  for (int i = 0; i < options->count; i++) {
    good[i] = can_be_built(reader, options, place[i]);
  }
  /* Trades between two that cannot be built may mend either, so a second round may help. */
  for (int round = 0; round < 3; round++) {
    complete = true;
    for (int i = 0; i < options->count; i++) {
      complete = repair(reader, options, &state, place, good, i) && complete;
    }
  }
  if (!complete) {
    fprintf(stderr, "some designs cannot be built: take another seed or count\n");
  }
  job_reader_destroy(reader);
  free(good);
  return complete;
}
