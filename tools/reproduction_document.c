/* The sections of docs/REPRODUCTION.md. */
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "tools/figure.h"
#include "tools/reproduction.h"

static bool is_of(const json_t *entry, const char *paper) {
  return strcmp(figure_text(entry, "paper"), paper) == 0;
}

static const char *space_before(const char *unit) {
  return *unit ? " " : "";
}

/* ---- values ------------------------------------------------------------------------------- */

/* How far a found value is from the published one, or whether it keeps to a published bound. */
static void print_difference(FILE *out, const json_t *entry, const struct finding *ours) {
  const json_t *number = json_object_get(entry, "published");
  const char *relation = figure_text(entry, "relation"), *unit = figure_text(entry, "unit");
  double published = json_number_value(number), difference = ours->value - published;
  if (!json_is_number(number)) {
    fputs("-", out);
  } else if (strcmp(relation, "below") == 0 || strcmp(relation, "above") == 0) {
    bool holds = *relation == 'b' ? difference <= 0 : difference >= 0;
    fputs(holds ? "holds" : "does not hold", out);
  } else if (published != 0) {
    fprintf(out, "%+.3g%s%s (%+.1f %%)", difference, space_before(unit), unit,
            100 * difference / fabs(published));
  } else {
    fprintf(out, "%+.3g%s%s", difference, space_before(unit), unit);
  }
}

static void print_published(FILE *out, const json_t *entry) {
  const json_t *number = json_object_get(entry, "published");
  const char *relation = figure_text(entry, "relation"), *unit = figure_text(entry, "unit");
  if (json_is_string(number)) {
    fputs(json_string_value(number), out);
  } else {
    fprintf(out, "%s%s%.6g%s%s", relation, space_before(relation), json_number_value(number),
            space_before(unit), unit);
  }
}

static void print_value(FILE *out, const struct works *works, const json_t *entry) {
  struct finding ours = finding_from(works, json_object_get(entry, "ours"));
  const char *unit = figure_text(entry, "unit");
  fprintf(out, "| %s | ", figure_text(entry, "what"));
  print_published(out, entry);
  if (!ours.found) {
    fprintf(out, " | %s | | |\n", ours.missing);
    return;
  }
  fprintf(out, " | %.4g%s%s | ", ours.value, space_before(unit), unit);
  print_difference(out, entry, &ours);
  if (ours.error >= 0) {
    fprintf(out, " | %.2g%s%s |\n", ours.error, space_before(unit), unit);
  } else {
    fputs(" | not estimated |\n", out);
  }
}

void print_values(FILE *out, const struct works *works, const json_t *data, const char *paper) {
  size_t index;
  json_t *entry;
  fputs("| what | published | ours | difference | numerical error |\n|---|---|---|---|---|\n", out);
  json_array_foreach(json_object_get(data, "values"), index, entry) {
    if (is_of(entry, paper)) {
      print_value(out, works, entry);
    }
  }
}

/* ---- trends ------------------------------------------------------------------------------- */

/* Values of the steps of one rank: for a plain sequence each step is a group of its own. */
struct group {
  double low, high;
};

/* Whether the groups go on as "rising" or "falling": every value beyond every one before. */
static bool goes_as(const char *direction, struct group before, struct group after) {
  return strcmp(direction, "rising") == 0 ? after.low > before.high : after.high < before.low;
}

/* Prints the values of one group; false when one is missing. */
static bool print_group(FILE *out, const struct works *works, const json_t *steps, bool first,
                        struct group *group) {
  bool complete = true;
  size_t index;
  json_t *step;
  *group = (struct group){INFINITY, -INFINITY};
  json_array_foreach(steps, index, step) {
    struct finding ours = finding_from(works, step);
    fprintf(out, "%s%s: ", first && index == 0 ? "" : ", ", figure_text(step, "label"));
    if (ours.found) {
      fprintf(out, "%.4g", ours.value);
      *group = (struct group){fmin(group->low, ours.value), fmax(group->high, ours.value)};
    } else {
      fputs("missing", out);
      complete = false;
    }
  }
  return complete;
}

/* "steps" are in the published order; "groups" are lists of steps without an order among them. */
static void print_trend(FILE *out, const struct works *works, const json_t *entry) {
  const json_t *steps = json_object_get(entry, "steps"), *groups = json_object_get(entry, "groups");
  const char *direction = figure_text(entry, "direction");
  struct group before = {0, 0}, group;
  bool as_published = true, complete = true;
  fprintf(out, "| %s | %s | ", figure_text(entry, "what"), direction);
  for (size_t g = 0; g < json_array_size(groups ? groups : steps); g++) {
    json_t *one = groups ? json_incref(json_array_get(groups, g))
                         : json_pack("[O]", json_array_get(steps, g));
    complete = print_group(out, works, one, g == 0, &group) && complete;
    as_published = as_published && (g == 0 || goes_as(direction, before, group));
    before = group;
    json_decref(one);
  }
  fprintf(out, " | %s |\n", !complete ? "missing" : as_published ? "yes" : "**no**");
}

void print_trends(FILE *out, const struct works *works, const json_t *data, const char *paper) {
  size_t index;
  json_t *entry;
  fputs("| what | published | ours | sign as published |\n|---|---|---|---|\n", out);
  json_array_foreach(json_object_get(data, "trends"), index, entry) {
    if (is_of(entry, paper)) {
      print_trend(out, works, entry);
    }
  }
}

/* ---- the ranking of the tapers ------------------------------------------------------------ */

static const json_t *ranked(const json_t *designs, const char *name) {
  size_t index;
  json_t *design;
  json_array_foreach(designs, index, design) {
    if (strcmp(figure_text(design, "name"), name) == 0) {
      return design;
    }
  }
  return NULL;
}

static double number(const json_t *object, const char *key) {
  return json_number_value(json_object_get(object, key));
}

/* The printed rows, what the printed formula makes of them, and ours of the same designs. */
static void print_printed_rows(FILE *out, const json_t *rows, const json_t *designs,
                               double mean_weight) {
  size_t index;
  json_t *row;
  fputs("| published rank | design | mean | variance | final as printed | by the printed formula | "
        "our rank | mean | variance | final |\n|---|---|---|---|---|---|---|---|---|---|\n",
        out);
  json_array_foreach(rows, index, row) {
    double mean = number(row, "mean"), variance = number(row, "variance");
    const json_t *ours = ranked(designs, figure_text(row, "name"));
    fprintf(out, "| %.0f | %s | %.3f | %.3f | %.4f | %.4f | ", number(row, "rank"),
            figure_text(row, "name"), mean, variance, number(row, "final"),
            mean_weight * mean + (1 - mean_weight) * (1 - variance));
    if (ours) {
      fprintf(out, "%.0f | %.3f | %.3f | %.4f |\n", number(ours, "rank"),
              number(ours, "mean_weighted"), number(ours, "normalised_variance"),
              number(ours, "final"));
    } else {
      fputs("missing | | | |\n", out);
    }
  }
}

static void print_best(FILE *out, const json_t *designs, size_t most) {
  fputs("| our rank | design | mean | variance | final | rank by station "
        "|\n|---|---|---|---|---|---|\n",
        out);
  for (size_t i = 0; i < json_array_size(designs) && i < most; i++) {
    const json_t *row = json_array_get(designs, i);
    fprintf(out, "| %.0f | %s | %.3f | %.3f | %.4f | %.0f |\n", number(row, "rank"),
            figure_text(row, "name"), number(row, "mean_weighted"),
            number(row, "normalised_variance"), number(row, "final"), number(row, "other_rank"));
  }
}

void print_ranking(FILE *out, const struct works *works, const json_t *data) {
  const json_t *section = json_object_get(data, "ranking");
  const json_t *result = works_result(works, figure_text(section, "from"));
  const json_t *ranking = json_object_get(result, "ranking");
  const json_t *metrics = json_object_get(result, "metrics");
  const json_t *designs = json_object_get(ranking, "designs");
  if (result) {
    fprintf(out,
            "%.0f designs, %.0f of them distinct but for mirror images; %.0f reached their load "
            "and are ranked.\n\n",
            number(metrics, "designs"), number(metrics, "distinct"), number(metrics, "solved"));
  } else {
    fprintf(out, "Missing: %s has not been run.\n\n", figure_text(section, "from"));
  }
  print_printed_rows(out, json_object_get(section, "published"), designs,
                     number(section, "mean_weight"));
  fputs("\n", out);
  print_best(out, designs, (size_t)number(section, "best"));
}

/* ---- figures and runs --------------------------------------------------------------------- */

void print_figures(FILE *out, const json_t *data, const char *paper, const char *figures) {
  size_t index;
  json_t *entry;
  json_array_foreach(json_object_get(data, "figures"), index, entry) {
    if (!is_of(entry, paper)) {
      continue;
    }
    char path[WORK_PATH];
    snprintf(path, sizeof path, "%s/%s.png", figures, figure_text(entry, "file"));
    if (access(path, R_OK) == 0) {
      fprintf(out, "![%s](figures/reproduction/%s.png)\n\n*%s*\n\n", figure_text(entry, "caption"),
              figure_text(entry, "file"), figure_text(entry, "caption"));
    } else {
      fprintf(out, "*%s*: missing, %s could not be drawn.\n\n", figure_text(entry, "caption"),
              figure_text(entry, "from"));
    }
  }
}

static void print_outcome(FILE *out, const json_t *result) {
  const json_t *metrics = json_object_get(result, "metrics");
  const char *reason = figure_text(result, "reason");
  fprintf(out, "%s%s%s", figure_text(result, "status"), *reason ? ", " : "", reason);
  if (json_object_get(metrics, "designs")) {
    fprintf(out, "; %.0f of %.0f members reached their load, %.0f computed",
            number(metrics, "solved"), number(metrics, "designs"), number(metrics, "distinct"));
  }
}

void print_runs(FILE *out, const struct works *works, const char *kept) {
  double total = 0;
  fputs("| job | outcome | processor time |\n|---|---|---|\n", out);
  for (int w = 0; w < works->count; w++) {
    const struct work *work = &works->item[w];
    double kept_s = 0;
    if (!work->result && kept_print_row(out, kept, work->name, &kept_s)) {
      total += kept_s;
      continue;
    }
    fprintf(out, "| [`%s`](../jobs/%s.json) | ", work->name, work->name);
    if (!work->result) {
      fputs("missing | |\n", out);
      continue;
    }
    print_outcome(out, work->result);
    const json_t *statistics = json_object_get(work->result, "statistics");
    double cpu = number(statistics, work->study ? "members_cpu_s" : "cpu_s");
    total += cpu;
    fprintf(out, " | %.0f s |\n", cpu);
  }
  fprintf(out, "\nTogether %.0f minutes of processor time.\n", total / 60);
}
