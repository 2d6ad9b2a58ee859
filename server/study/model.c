#include "server/study/model.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "server/study/criteria.h"
#include "solver/explore/random.h"

enum { SLOTS = 16 }; /* 3 MB each at most */

static const uint64_t seed = 1;

struct models {
  pthread_mutex_t mutex;
  pthread_mutex_t fitting; /* one fit at a time: they take memory and a core each */
  uint64_t clock;
  struct {
    uint64_t tag, used;
    struct model *model;
  } slots[SLOTS];
};

enum status models_create(struct models **models, struct error *error) {
  struct models *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for surrogates.");
  }
  gsl_set_error_handler_off();
  pthread_mutex_init(&made->mutex, NULL);
  pthread_mutex_init(&made->fitting, NULL);
  *models = made;
  return STATUS_OK;
}

void models_destroy(struct models *models) {
  if (!models) {
    return;
  }
  for (size_t i = 0; i < SLOTS; i++) {
    model_release(models->slots[i].model);
  }
  pthread_mutex_destroy(&models->mutex);
  pthread_mutex_destroy(&models->fitting);
  free(models);
}

void model_release(struct model *model) {
  if (!model || atomic_fetch_sub(&model->uses, 1) != 1) {
    return;
  }
  surrogate_destroy(model->surrogate);
  free(model->row);
  free(model->known);
  free(model->left_out);
  free(model->deviation);
  free(model);
}

/* ---- fitting ------------------------------------------------------------------------------ */

/* The rows that can be used, in a random order when they are too many. NULL without memory. */
static size_t *choose_rows(const struct study_table *table, size_t metric, struct model *model) {
  double x[SURROGATE_PARAMETERS_MAX];
  uint64_t random = random_mix(seed);
  size_t *rows = malloc((table->members + 1) * sizeof *rows);
  model->members = table->members;
  for (size_t i = 0; rows && i < table->members; i++) {
    bool counts = row_counts(table, i);
    model->succeeded += counts;
    if (counts && isfinite(table->result[i * table->metrics + metric]) &&
        space_encode(&model->space, table->value + i * table->parameters, x)) {
      rows[model->complete++] = i;
    }
  }
  model->points = model->complete < MODEL_POINTS_MAX ? model->complete : MODEL_POINTS_MAX;
  for (size_t i = 0; rows && model->points < model->complete && i < model->points; i++) {
    size_t other = i + (size_t)random_below(&random, model->complete - i), kept = rows[i];
    rows[i] = rows[other];
    rows[other] = kept;
  }
  return rows;
}

static bool make_room(struct model *model) {
  size_t n = model->points + 1;
  model->known = malloc(n * sizeof *model->known);
  model->left_out = malloc(n * sizeof *model->left_out);
  model->deviation = malloc(n * sizeof *model->deviation);
  return model->known && model->left_out && model->deviation;
}

static enum status fit(const struct study_table *table, size_t metric, struct model *model,
                       struct error *error) {
  enum status status = space_make(table, &model->space, error);
  if (status != STATUS_OK) {
    return status;
  }
  model->row = choose_rows(table, metric, model);
  size_t width = (size_t)model->space.width;
  double *x = malloc((model->points + 1) * width * sizeof *x);
  if (!model->row || !x || !make_room(model)) {
    free(x);
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a surrogate.");
  }
  for (size_t i = 0; i < model->points; i++) {
    size_t row = model->row[i];
    space_encode(&model->space, table->value + row * table->parameters, x + i * width);
    model->known[i] = table->result[row * table->metrics + metric];
  }
  if (model->points < 4) {
    status = error_set(error, STATUS_INVALID, NULL,
                       "%zu of the %zu members so far have succeeded with a value of %s\nat least "
                       "4 for a surrogate",
                       model->complete, model->members, table->metric[metric].key);
  } else {
    status = surrogate_create(x, model->known, (int)model->points, (int)width, seed,
                              &model->surrogate, error);
  }
  if (status == STATUS_OK) {
    surrogate_leave_one_out(model->surrogate, model->left_out, model->deviation);
  }
  free(x);
  return status;
}

/* ---- keeping ------------------------------------------------------------------------------ */

static uint64_t add(uint64_t tag, const void *data, size_t size) {
  const unsigned char *bytes = data;
  for (size_t i = 0; i < size; i++) {
    tag = (tag ^ bytes[i]) * UINT64_C(0x100000001b3);
  }
  return tag;
}

/* Of all that a surrogate follows from (FNV-1a). */
static uint64_t tag_of(const struct study_table *table, size_t metric) {
  uint64_t tag = UINT64_C(0xcbf29ce484222325);
  const char *key = table->metric[metric].key;
  tag = add(tag, &table->study_id, sizeof table->study_id);
  tag = add(tag, key, strlen(key) + 1);
  tag = add(tag, table->state, table->members * sizeof *table->state);
  tag = add(tag, table->value, table->members * table->parameters * sizeof *table->value);
  for (size_t i = 0; i < table->members; i++) {
    tag = add(tag, &table->result[i * table->metrics + metric], sizeof *table->result);
  }
  return tag;
}

/* A use of the kept surrogate, or NULL. */
static struct model *find(struct models *models, uint64_t tag) {
  struct model *found = NULL;
  pthread_mutex_lock(&models->mutex);
  for (size_t i = 0; i < SLOTS && !found; i++) {
    if (models->slots[i].model && models->slots[i].tag == tag) {
      found = models->slots[i].model;
      models->slots[i].used = ++models->clock;
      atomic_fetch_add(&found->uses, 1);
    }
  }
  pthread_mutex_unlock(&models->mutex);
  return found;
}

/* Keeps another use of it in the place of the one that was not asked for the longest. */
static void keep(struct models *models, uint64_t tag, struct model *model) {
  size_t oldest = 0;
  pthread_mutex_lock(&models->mutex);
  for (size_t i = 1; i < SLOTS; i++) {
    oldest = models->slots[i].used < models->slots[oldest].used ? i : oldest;
  }
  struct model *before = models->slots[oldest].model;
  atomic_fetch_add(&model->uses, 1);
  models->slots[oldest].tag = tag;
  models->slots[oldest].used = ++models->clock;
  models->slots[oldest].model = model;
  pthread_mutex_unlock(&models->mutex);
  model_release(before);
}

enum status models_get(struct models *models, const struct study_table *table, size_t metric,
                       struct model **model, struct error *error) {
  uint64_t tag = tag_of(table, metric);
  *model = find(models, tag);
  if (*model) {
    return STATUS_OK;
  }
  struct model *made = NULL;
  enum status status = STATUS_OK;
  pthread_mutex_lock(&models->fitting);
  *model = find(models, tag); /* another request may have fitted it meanwhile */
  if (!*model) {
    made = calloc(1, sizeof *made);
    status = made ? fit(table, metric, made, error)
                  : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a surrogate.");
  }
  if (made) {
    atomic_init(&made->uses, 1);
    if (status == STATUS_OK) {
      keep(models, tag, made);
      *model = made;
    } else {
      model_release(made);
    }
  }
  pthread_mutex_unlock(&models->fitting);
  return status;
}

/* ---- use ---------------------------------------------------------------------------------- */

void model_predict(const struct model *model, const double *design, double *mean,
                   double *deviation) {
  double x[SURROGATE_PARAMETERS_MAX];
  if (!space_encode(&model->space, design, x)) {
    *mean = NAN;
    if (deviation) {
      *deviation = NAN;
    }
    return;
  }
  surrogate_predict(model->surrogate, x, mean, deviation);
  if (deviation) {
    *deviation = hypot(*deviation, surrogate_fit(model->surrogate)->noise);
  }
}

json_t *model_view(const struct model *model) {
  const struct surrogate_fit *fitted = surrogate_fit(model->surrogate);
  return json_pack("{s:s, s:I, s:I, s:I, s:I, s:f, s:f}", "method", "Gaussian process, Matern 5/2",
                   "points", (json_int_t)model->points, "complete", (json_int_t)model->complete,
                   "succeeded", (json_int_t)model->succeeded, "members", (json_int_t)model->members,
                   "r2", fitted->left_out_r2, "within_95", fitted->left_out_within);
}
