#include "solver/job/study_optimise.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/explore/sequence.h"
#include "solver/job/study_search.h"

/* Points that are tried for a start before it is given up. */
enum { TRIES_PER_START = 200 };

bool study_is_search(const json_t *document) {
  return strcmp(json_string_value(json_object_get(document, "sampling")), "optimise") == 0;
}

static enum status no_memory(struct error *error) {
  return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the search");
}

/* ---- one start: its search is repeated with what is known ----------------------------------- */

struct replay {
  struct study_search *search;
  struct search_line *line;
  size_t next; /* design of the line */
  bool asked;  /* for one beyond those known, at x */
  double x[OPTIMISE_PARAMETERS_MAX];
};

static enum optimise_reply answer(void *context, const double *x, double *value, double *gradient) {
  struct replay *replay = context;
  const struct study_search *search = replay->search;
  size_t functions = study_objective_functions(&search->objective);
  if (replay->next == replay->line->count) {
    replay->asked = true;
    memcpy(replay->x, x, search->parameters * sizeof *x);
    return OPTIMISE_HALT;
  }
  const struct search_design *design = &replay->line->design[replay->next++];
  if (design->state == SEARCH_SOLVED) {
    memcpy(value, design->value, functions * sizeof *value);
    memcpy(gradient, design->gradient, functions * search->parameters * sizeof *gradient);
  }
  return design->state == SEARCH_SOLVED ? OPTIMISE_SOLVED
         : design->state == SEARCH_OPEN ? OPTIMISE_HALT
                                        : OPTIMISE_FAILED;
}

static double side(void *context, size_t which, const double *x, double *gradient) {
  const struct replay *replay = context;
  return search_side_value(replay->search, which, x, gradient);
}

static enum status repeat(struct study_search *search, struct search_line *line,
                          struct replay *replay, struct error *error) {
  *replay = (struct replay){.search = search, .line = line};
  struct optimise_problem problem = {.method = search->method,
                                     .parameters = search->parameters,
                                     .residuals = study_objective_residuals(&search->objective),
                                     .limits = search->objective.limit_count,
                                     .sides = search->sides,
                                     .budget = line->budget,
                                     .tolerance = search->tolerance,
                                     .target = search->tolerance,
                                     .evaluate = answer,
                                     .side = side,
                                     .context = replay};
  return optimise_run(&problem, line->x, &line->outcome, error);
}

/* Takes note of a design at x: as the next member, or as one that cannot be built. */
static enum status add_design(struct study_search *search, struct search_line *line,
                              const double *x, bool *refused, struct error *error) {
  struct error why = {0};
  struct search_design *design = &line->design[line->count];
  size_t member = search->members;
  enum status status = search_append(search, x, refused, &why);
  if (status != STATUS_OK) {
    return no_memory(error);
  }
  *design =
      (struct search_design){.state = *refused ? SEARCH_REFUSED : SEARCH_OPEN, .member = member};
  memcpy(design->x, x, search->parameters * sizeof *x);
  line->count++;
  return STATUS_OK;
}

/* Repeats the search of a start until it asks for a member or ends. */
static enum status advance(struct study_search *search, struct search_line *line,
                           struct error *error) {
  bool refused = true;
  while (refused && !line->ended) {
    struct replay replay;
    enum status status = repeat(search, line, &replay, error);
    if (status != STATUS_OK) {
      return status;
    }
    if (!replay.asked) {
      line->ended = line->outcome.ending != OPTIMISE_HALTED;
      return STATUS_OK;
    }
    status = add_design(search, line, replay.x, &refused, error);
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

/* ---- the first round ------------------------------------------------------------------------ */

static bool meets_sides(struct study_search *search, const double *x) {
  for (size_t i = 0; i < search->sides; i++) {
    if (search_side_value(search, i, x, NULL) > 0) {
      return false;
    }
  }
  return true;
}

/* Starts after the first are points of Sobol's sequence that can be built and meet the constraints.
 * Where hardly any does, there are fewer. */
static enum status place_starts(struct study_search *search, struct error *error) {
  uint64_t seed = (uint64_t)json_integer_value(json_object_get(search->document, "seed"));
  struct sequence *sequence = NULL;
  double x[OPTIMISE_PARAMETERS_MAX];
  bool refused;
  enum status status = add_design(search, &search->line[0], search->line[0].x, &refused, error);
  if (status == STATUS_OK) {
    status = sequence_create(SEQUENCE_SOBOL, (int)search->parameters, true, seed, &sequence, error);
  }
  size_t placed = 1;
  for (int tried = 0; status == STATUS_OK && placed < search->starts &&
                      tried < TRIES_PER_START * (int)search->starts;
       tried++) {
    struct search_line *line = &search->line[placed];
    sequence_next(sequence, x);
    if (!meets_sides(search, x)) {
      continue;
    }
    memcpy(line->x, x, sizeof x);
    status = add_design(search, line, x, &refused, error);
    line->count = refused ? 0 : line->count;
    placed += !refused;
  }
  sequence_destroy(sequence);
  search->starts = placed;
  return status;
}

enum status study_search_create(const struct job_reader *reader, json_t *document,
                                struct study_search **out, struct error *error) {
  struct study_search *search = calloc(1, sizeof *search);
  *out = NULL;
  if (!search) {
    return no_memory(error);
  }
  search->reader = reader;
  search->document = document;
  enum status status = search_read(search, error);
  for (size_t s = 0; s < search->starts && status == STATUS_OK; s++) {
    struct search_line *line = &search->line[s];
    line->design = calloc(line->budget, sizeof *line->design);
    status = line->design ? STATUS_OK : no_memory(error);
  }
  if (status == STATUS_OK) {
    status = place_starts(search, error);
  }
  if (status != STATUS_OK) {
    study_search_destroy(search);
    return status;
  }
  *out = search;
  return STATUS_OK;
}

void study_search_destroy(struct study_search *search) {
  for (size_t s = 0; search && s < SEARCH_STARTS_MAX; s++) {
    struct search_line *line = &search->line[s];
    for (size_t i = 0; i < line->count; i++) {
      free(line->design[i].value);
    }
    free(line->design);
  }
  free(search);
}

enum status study_search_begin(const struct job_reader *reader, json_t *document,
                               struct error *error) {
  struct study_search *search;
  enum status status = study_search_create(reader, document, &search, error);
  study_search_destroy(search);
  return status;
}

/* ---- results ------------------------------------------------------------------------------ */

const struct search_design *search_member(const struct study_search *search, size_t member,
                                          size_t *line) {
  for (size_t s = 0; s < search->starts; s++) {
    for (size_t i = 0; i < search->line[s].count; i++) {
      const struct search_design *design = &search->line[s].design[i];
      if (design->state != SEARCH_REFUSED && design->member == member) {
        *line = s;
        return design;
      }
    }
  }
  return NULL;
}

enum status study_search_tell(struct study_search *search, size_t member, const json_t *result,
                              struct error *error) {
  size_t s, n = search->parameters, functions = study_objective_functions(&search->objective);
  const struct search_design *found = search_member(search, member, &s);
  if (!found || found->state != SEARCH_OPEN) {
    return STATUS_OK;
  }
  struct search_design *design = &search->line[s].design[found - search->line[s].design];
  double factor[OPTIMISE_PARAMETERS_MAX];
  for (size_t k = 0; k < n; k++) {
    factor[k] = search->factor[k] * search_slope(&search->range[k], design->x[k]);
  }
  design->value = calloc(functions * (1 + n), sizeof *design->value);
  if (!design->value) {
    return no_memory(error);
  }
  design->gradient = design->value + functions;
  const char *lack =
      result ? study_objective_evaluate(&search->objective, result, n, factor, design->value,
                                        search->derivatives ? design->gradient : NULL)
             : "the member has no result";
  design->state = lack ? SEARCH_FAILED : SEARCH_SOLVED;
  snprintf(design->reason, sizeof design->reason, "%s", lack ? lack : "");
  search->told++;
  return STATUS_OK;
}

enum status study_search_next(struct study_search *search, bool *more, struct error *error) {
  size_t before = search->members;
  enum status status = STATUS_OK;
  *more = false;
  if (search->told < search->members) {
    return STATUS_OK;
  }
  for (size_t s = 0; s < search->starts && status == STATUS_OK; s++) {
    status = advance(search, &search->line[s], error);
  }
  *more = search->members > before;
  return status;
}

size_t study_search_budget(const struct study_search *search) {
  size_t sum = 0;
  for (size_t s = 0; s < search->starts; s++) {
    sum += search->line[s].budget;
  }
  return sum;
}

size_t study_search_members(const struct study_search *search) {
  return search->members;
}
