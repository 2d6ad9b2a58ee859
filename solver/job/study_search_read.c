/* What the search of a study reads from its document. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/job/study.h"
#include "solver/job/study_search.h"
#include "solver/job/study_size.h"

/* Digits of the values of members: more than derivatives are good for. */
enum { VALUE_DIGITS = 10 };

double search_value(const struct study_range *range, double x) {
  return range->logarithmic ? range->from * pow(range->to / range->from, x)
                            : range->from + x * (range->to - range->from);
}

double search_slope(const struct study_range *range, double x) {
  return range->logarithmic ? search_value(range, x) * log(range->to / range->from)
                            : range->to - range->from;
}

/* ---- side conditions ---------------------------------------------------------------------- */

double search_side_value(void *context, size_t which, const double *x, double *gradient) {
  const struct study_search *search = context;
  const struct search_side *side = &search->side[which];
  double sum = 0;
  for (size_t k = 0; k < search->parameters; k++) {
    double factor = side->constraint->factor[k] * search->si[k];
    sum += factor * search_value(&search->range[k], x[k]);
    if (gradient) {
      gradient[k] = side->sign * factor * search_slope(&search->range[k], x[k]) / side->scale;
    }
  }
  return side->sign * (sum - side->bound) / side->scale;
}

static void add_sides(struct study_search *search, const struct study_constraint *constraint) {
  double scale = 0;
  for (size_t k = 0; k < search->parameters; k++) {
    const struct study_range *range = &search->range[k];
    scale += fabs(constraint->factor[k]) * search->si[k] * (range->to - range->from);
  }
  scale = scale > 0 ? scale : 1;
  if (isfinite(constraint->high)) {
    search->side[search->sides++] = (struct search_side){constraint, 1, constraint->high, scale};
  }
  if (isfinite(constraint->low)) {
    search->side[search->sides++] = (struct search_side){constraint, -1, constraint->low, scale};
  }
}

/* Constraints on sums. The dimension of each parameter in one is checked with its lower end. */
static enum status read_sides(const struct reader *reader, struct study_search *search) {
  json_t *lists[OPTIMISE_PARAMETERS_MAX] = {NULL};
  const json_t *parameters = json_object_get(search->document, "parameters");
  bool met, room = true;
  enum status status = study_constraints_read(reader, search->document, &search->constraints);
  for (size_t k = 0; k < search->parameters; k++) {
    lists[k] = json_pack("[O]", json_object_get(json_array_get(parameters, k), "from"));
    room = room && lists[k];
  }
  if (status == STATUS_OK && room) {
    struct study_constraints wide = search->constraints; /* all are met: all are looked at */
    for (size_t i = 0; i < wide.count; i++) {
      wide.constraint[i].low = -INFINITY;
      wide.constraint[i].high = INFINITY;
    }
    status = study_constraints_check(&wide, reader, lists, &met);
  }
  for (size_t i = 0; status == STATUS_OK && i < search->constraints.count; i++) {
    add_sides(search, &search->constraints.constraint[i]);
  }
  for (size_t k = 0; k < search->parameters; k++) {
    json_decref(lists[k]);
  }
  return room ? status
              : error_set(reader->error, STATUS_NO_MEMORY, NULL, "no memory for the search");
}

/* ---- designs ------------------------------------------------------------------------------ */

static json_t *values_of(const struct study_search *search, size_t parameter) {
  return json_object_get(json_array_get(json_object_get(search->document, "parameters"), parameter),
                         "values");
}

static void take_back(const struct study_search *search) {
  for (size_t k = 0; k < search->parameters; k++) {
    json_array_remove(values_of(search, k), search->members);
  }
}

enum status search_append(struct study_search *search, const double *x, bool *refused,
                          struct error *error) {
  struct job_spec spec;
  for (size_t k = 0; k < search->parameters; k++) {
    json_t *value = study_range_value(&search->range[k], x[k], VALUE_DIGITS);
    if (json_array_append_new(values_of(search, k), value) != 0) {
      return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the search");
    }
  }
  enum status status =
      study_read_member(search->reader, search->document, search->members, NULL, &spec, error);
  *refused = status != STATUS_OK;
  if (status == STATUS_OK) {
    job_spec_release(&spec);
    search->members++;
  } else {
    take_back(search);
  }
  return status == STATUS_NO_MEMORY ? status : STATUS_OK;
}

/* ---- derivatives -------------------------------------------------------------------------- */

/* Lets every member have derivatives to the parameters. */
static enum status ask_for_derivatives(const struct study_search *search, struct error *error) {
  json_t *list = json_array();
  for (size_t k = 0; k < search->parameters; k++) {
    json_array_append_new(list, json_string(search->pointer[k]));
  }
  json_t *value = json_pack("{s:o, s:b}", "parameters", list, "midline",
                            search->objective.kind == OBJECTIVE_PROFILE);
  json_t *set = json_object_get(search->document, "set");
  return value && json_object_set_new(set, "/sensitivity", value) == 0
             ? STATUS_OK
             : error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the search");
}

/* One of the range's unit in that of derivatives. */
static enum status set_factors(const struct reader *reader, struct study_search *search,
                               const struct job_spec *spec) {
  for (size_t k = 0; k < search->parameters; k++) {
    const struct job_parameter *parameter = &spec->sensitivity.parameter[k];
    const char *unit = search->range[k].unit;
    char one[96];
    double si = 1;
    snprintf(one, sizeof one, "1%s", unit);
    enum status status =
        unit[0] ? units_read(reader->units, one, parameter->unit, &si, reader->error) : STATUS_OK;
    if (status != STATUS_OK) {
      return status;
    }
    search->factor[k] = si / parameter->unit_si;
  }
  return STATUS_OK;
}

/* Reads the first design of the first start, which tells whether there are derivatives to all
 * parameters and up to which pressure the load goes. */
static enum status read_first(const struct reader *reader, struct study_search *search,
                              struct job_spec *spec) {
  bool body = strcmp(study_base_kind(search->document), "response") == 0;
  json_t *set = json_object_get(search->document, "set");
  enum status status = body ? ask_for_derivatives(search, reader->error) : STATUS_OK;
  if (status != STATUS_OK) {
    return status;
  }
  status = study_read_member(search->reader, search->document, 0, NULL, spec, reader->error);
  search->derivatives = body && status == STATUS_OK;
  if (body && status == STATUS_INVALID &&
      strncmp(reader->error->pointer, "/sensitivity", sizeof "/sensitivity" - 1) == 0) {
    json_object_del(set, "/sensitivity");
    status = study_read_member(search->reader, search->document, 0, NULL, spec, reader->error);
  }
  if (status != STATUS_OK && status != STATUS_NO_MEMORY) {
    char inner[sizeof reader->error->pointer];
    reader_copy(inner, sizeof inner, reader->error->pointer);
    error_carry(reader->error, "/parameters", "the first start%s%s: ", inner[0] ? ", " : "", inner);
  }
  return status;
}

/* ---- all of it ---------------------------------------------------------------------------- */

static enum status read_start(const struct reader *reader, struct study_search *search,
                              size_t parameter, const json_t *object) {
  const struct study_range *range = &search->range[parameter];
  const json_t *start = json_object_get(object, "start");
  const char *unit;
  double value;
  search->line[0].x[parameter] = 0.5;
  if (!start) {
    return STATUS_OK;
  }
  if (!study_range_split(start, &value, &unit) || strcmp(unit, range->unit) != 0 ||
      value < range->from || value > range->to) {
    return study_range_refuse(reader, parameter, "start",
                              "this is no place within the range\nbetween \"from\" and \"to\", "
                              "with the same unit");
  }
  search->line[0].x[parameter] = range->logarithmic
                                     ? log(value / range->from) / log(range->to / range->from)
                                     : (value - range->from) / (range->to - range->from);
  return STATUS_OK;
}

static enum status read_parameters(const struct reader *reader, struct study_search *search) {
  const json_t *parameters = json_object_get(search->document, "parameters");
  enum status status = STATUS_OK;
  search->parameters = json_array_size(parameters);
  for (size_t k = 0; k < search->parameters && status == STATUS_OK; k++) {
    json_t *parameter = json_array_get(parameters, k);
    search->pointer[k] = json_string_value(json_object_get(parameter, "pointer"));
    json_object_del(parameter, "values");
    status = study_range_read(reader, k, parameter, &search->range[k]);
    search->range[k].whole = false;
    if (status == STATUS_OK) {
      status = read_start(reader, search, k, parameter);
    }
    if (status == STATUS_OK &&
        json_object_set_new(
            parameter, "values",
            json_pack("[o]", study_range_value(&search->range[k], search->line[0].x[k],
                                               VALUE_DIGITS))) != 0) {
      status = error_set(reader->error, STATUS_NO_MEMORY, NULL, "no memory for the search");
    }
  }
  return status;
}

/* The units of parameters in sums: what a sum adds up has one dimension, that of its limits. */
static enum status set_si(const struct reader *reader, struct study_search *search) {
  const json_t *list = json_object_get(search->document, "constraints"), *item, *factor;
  size_t index, k;
  const char *pointer;
  for (k = 0; k < search->parameters; k++) {
    search->si[k] = 1;
  }
  json_array_foreach(list, index, item) {
    const json_t *bound = json_object_get(item, "at_most");
    const char *text, *unit = "";
    double value;
    bound = bound ? bound : json_object_get(item, "at_least");
    if (!study_range_split(bound, &value, &unit) || !unit[0]) {
      continue;
    }
    json_object_foreach(json_object_get(item, "sum"), pointer, factor) {
      for (k = 0; k < search->parameters; k++) {
        char one[96];
        text = search->range[k].unit;
        snprintf(one, sizeof one, "1%s", text);
        if (strcmp(search->pointer[k], pointer) == 0 && text[0] &&
            units_read(reader->units, one, unit + strspn(unit, " "), &search->si[k],
                       reader->error) != STATUS_OK) {
          return study_range_refuse(reader, k, "from",
                                    "its dimension is another one than that of a constraint on "
                                    "it\none dimension in each constraint");
        }
      }
    }
  }
  return STATUS_OK;
}

static enum status choose_method(const struct reader *reader, struct study_search *search) {
  static const char *const words[] = {"gauss-newton", "slsqp", "mma", "cobyla"};
  static const enum optimise_method methods[] = {OPTIMISE_GAUSS_NEWTON, OPTIMISE_SLSQP,
                                                 OPTIMISE_MMA, OPTIMISE_COBYLA};
  const char *given = json_string_value(json_object_get(search->document, "method"));
  bool squares = study_objective_residuals(&search->objective) > 0;
  bool smooth = search->derivatives && study_objective_differentiable(&search->objective);
  bool plain = squares && search->objective.limit_count == 0;
  search->method = !smooth ? OPTIMISE_COBYLA : plain ? OPTIMISE_GAUSS_NEWTON : OPTIMISE_SLSQP;
  for (size_t i = 0; given && i < sizeof words / sizeof *words; i++) {
    if (strcmp(given, words[i]) == 0) {
      search->method = methods[i];
    }
  }
  if (search->method != OPTIMISE_COBYLA && !smooth) {
    return error_set(reader->error, STATUS_INVALID, "/method",
                     "%s takes derivatives, which a metric of the objective or a parameter does "
                     "not have\ncobyla, or nothing\n\"cobyla\"",
                     given);
  }
  if (search->method == OPTIMISE_GAUSS_NEWTON && !plain) {
    return error_set(reader->error, STATUS_INVALID, "/method",
                     "gauss-newton is for targets and profiles without limits on metrics\nslsqp or "
                     "mma\n\"slsqp\"");
  }
  search->derivatives = search->method != OPTIMISE_COBYLA;
  if (!search->derivatives) {
    json_object_del(json_object_get(search->document, "set"), "/sensitivity");
  }
  return STATUS_OK;
}

static void divide_budget(struct study_search *search) {
  const json_t *document = search->document;
  const json_t *starts = json_object_get(document, "starts");
  const json_t *tolerance = json_object_get(document, "tolerance");
  const json_t *budget = json_object_get(document, "budget");
  size_t all = budget ? (size_t)json_integer_value(budget) : SEARCH_BUDGET;
  search->starts = starts ? (size_t)json_integer_value(starts) : 1;
  search->starts = search->starts > all ? all : search->starts;
  search->tolerance = tolerance ? json_number_value(tolerance) : 1e-3;
  for (size_t s = 0; s < search->starts; s++) {
    search->line[s].budget = all / search->starts + (s < all % search->starts);
  }
}

enum status search_read(struct study_search *search, struct error *error) {
  struct reader reader = {job_reader_units(search->reader), error};
  struct job_spec spec = {.kind = JOB_RESPONSE};
  divide_budget(search);
  enum status status = read_parameters(&reader, search);
  if (status == STATUS_OK) { /* so much of it as the derivatives depend on */
    status = study_objective_read(&reader, search->document, INFINITY, &search->objective);
  }
  if (status == STATUS_OK) {
    status = read_first(&reader, search, &spec);
  }
  if (status != STATUS_OK) {
    return status;
  }
  status = search->derivatives ? set_factors(&reader, search, &spec) : STATUS_OK;
  double to = spec.kind == JOB_RESPONSE ? 1e-3 * spec.load.pressure_to : NAN;
  if (status == STATUS_OK) {
    status = study_objective_read(&reader, search->document, to, &search->objective);
  }
  if (status == STATUS_OK) {
    status = set_si(&reader, search);
  }
  if (status == STATUS_OK) {
    status = read_sides(&reader, search);
  }
  if (status == STATUS_OK) {
    status = choose_method(&reader, search);
  }
  for (size_t k = 0; k < search->parameters; k++) {
    json_array_clear(values_of(search, k));
  }
  job_spec_release(&spec);
  return status;
}
