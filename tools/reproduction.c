/* Runs the jobs of the published studies and writes docs/REPRODUCTION.md with their results beside
 * the published values.
 *
 * usage: reproduction [--only NAME] [--jobs N] [--no-runs] --solver FILE --source DIR --build DIR
 *                     [--document FILE] [--figures DIR]
 * Of SOURCE: jobs/, docs/REPRODUCTION.in.md and docs/reproduction.json with the published values;
 * the document and its figures go there, too, unless told otherwise. Results go to
 * BUILD/FOLDER/JOB/, from which an interrupted run goes on. --only runs one folder or job; what the
 * document and its figures have of other folders then stays as it is. Lines of the template:
 *   @VALUES paper@ @TRENDS paper@ @FIGURES paper@ @RANKING@ @RUNS@ */
#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/plot/plot.h"
#include "solver/base/clock.h"
#include "tools/figure.h"
#include "tools/reproduction.h"
#include "tools/template.h"

enum { FIGURE_WIDTH = 760, FIGURE_HEIGHT = 520, FIGURE_JOBS = 8 };

struct arguments {
  const char *only, *solver, *source, *build, *document, *figures;
  int processes;
  bool no_runs;
};

/* What the sections are printed from. */
struct content {
  const struct works *works;
  const json_t *data;
  const char *figures; /* directory of the pictures */
  const char *only;
  const char *kept; /* the document so far, or NULL */
};

/* ---- pictures ----------------------------------------------------------------------------- */

static const struct work *work_of(const struct works *works, const char *from) {
  size_t length = strcspn(from, "#");
  for (int w = 0; w < works->count; w++) {
    const struct work *work = &works->item[w];
    if (strlen(work->name) == length && strncmp(work->name, from, length) == 0) {
      return work;
    }
  }
  return NULL;
}

/* Index of the member called `name`, or -1. */
static int member_index(const json_t *result, const char *name) {
  size_t index;
  const json_t *member;
  json_array_foreach(json_object_get(result, "members"), index, member) {
    const char *its = json_string_value(json_object_get(member, "name"));
    if (its && strcmp(its, name) == 0) {
      return (int)index;
    }
  }
  return -1;
}

/* The result with the published values of its metrics beside it, or, of a study, of those of its
 * members, as plots show them. A new reference. */
static json_t *with_published(const json_t *result, const char *name, const json_t *data) {
  json_t *copy = json_copy((json_t *)result), *published = json_array();
  size_t index;
  const json_t *entry;
  json_array_foreach(json_object_get(data, "values"), index, entry) {
    const json_t *ours = json_object_get(entry, "ours");
    const json_t *value = json_object_get(entry, "published");
    const char *from = json_string_value(json_object_get(ours, "from"));
    const char *pointer = json_string_value(json_object_get(ours, "value"));
    size_t length = strlen(name);
    if (!from || strncmp(from, name, length) != 0 || !pointer ||
        strncmp(pointer, "/metrics/", 9) != 0 || !json_is_number(value)) {
      continue;
    }
    if (from[length] == '\0') {
      json_array_append_new(published,
                            json_pack("{s:s, s:O}", "metric", pointer + 9, "value", value));
    }
    if (from[length] != '#') {
      continue;
    }
    int member = member_index(result, from + length + 1);
    if (member >= 0) {
      json_array_append_new(published, json_pack("{s:i, s:s, s:O}", "member", member, "metric",
                                                 pointer + 9, "value", value));
    }
  }
  json_object_set_new(copy, "published", published);
  return copy;
}

/* The jobs that a figure shows: "from" is the name of one, or a list of names. Gives how many have
 * a result, and these. */
static size_t read_sources(const struct works *works, const json_t *from, const char *metric,
                           struct plot_input inputs[FIGURE_JOBS], const char **first) {
  json_t *list = json_is_array(from) ? json_incref((json_t *)from) : json_pack("[O]", from);
  size_t count = 0, index;
  const json_t *entry;
  json_array_foreach(list, index, entry) {
    const char *name = json_string_value(entry);
    const struct work *work = name ? work_of(works, name) : NULL;
    const json_t *result = work ? works_result(works, name) : NULL;
    if (result && count < FIGURE_JOBS) {
      *first = count ? *first : name;
      inputs[count++] =
          (struct plot_input){.result = result,
                              .artifacts_dir = work->directory,
                              .title = json_string_value(json_object_get(result, "name")),
                              .spec_hash = work->hash,
                              .metric = metric};
    }
  }
  json_decref(list);
  return count;
}

static bool write_figure(const struct works *works, const json_t *data, const json_t *entry,
                         const char *directory) {
  const char *plot = json_string_value(json_object_get(entry, "plot"));
  const char *name = json_string_value(json_object_get(entry, "file"));
  const char *metric = json_string_value(json_object_get(entry, "metric")), *first = "";
  struct plot_input inputs[FIGURE_JOBS];
  char path[WORK_PATH];
  if (!plot || !name) {
    return true;
  }
  snprintf(path, sizeof path, "%s/%s.png", directory, name);
  unlink(path);
  size_t count = read_sources(works, json_object_get(entry, "from"), metric, inputs, &first);
  if (count == 0) {
    return true; /* the document says that it is missing */
  }
  json_t *shown = with_published(inputs[0].result, first, data);
  inputs[0].result = shown;
  bool good = figure_write("reproduction", plot, inputs, count, FIGURE_WIDTH, FIGURE_HEIGHT, path);
  json_decref(shown);
  return good;
}

/* Draws all that a result has. */
static bool write_own_plots(const struct works *works, const struct work *work) {
  const char *names[PLOT_NAMES] = {NULL}, *first = "";
  json_t *from = json_string(work->name);
  struct plot_input input[FIGURE_JOBS];
  bool good = true;
  size_t count = read_sources(works, from, NULL, input, &first);
  if (count > 0) {
    plot_names_for(json_string_value(json_object_get(work->result, "kind")), work->result, names);
  }
  for (size_t n = 0; n < PLOT_NAMES && names[n]; n++) {
    char path[WORK_PATH + 64];
    snprintf(path, sizeof path, "%s/%s.png", work->directory, names[n]);
    good =
        figure_write("reproduction", names[n], input, 1, FIGURE_WIDTH, FIGURE_HEIGHT, path) && good;
  }
  json_decref(from);
  return good;
}

bool write_plots(const struct works *works, const json_t *data, const char *only,
                 const char *figures) {
  bool good = true;
  size_t index;
  json_t *entry;
  for (int w = 0; w < works->count; w++) {
    if (work_is_wanted(&works->item[w], only)) {
      good = write_own_plots(works, &works->item[w]) && good;
    }
  }
  json_array_foreach(json_object_get(data, "figures"), index, entry) {
    const char *paper = json_string_value(json_object_get(entry, "paper"));
    if (paper && paper_is_wanted(works, paper, only)) {
      good = write_figure(works, data, entry, figures) && good;
    }
  }
  return good;
}

/* ---- the document ------------------------------------------------------------------------- */

/* The section that a line "@SECTION paper@" stands for, and its paper: that of the ranking, which
 * names none, is fixed, and the table of runs has none. False for another line. */
static bool read_section(const char *line, char section[64], char paper[64]) {
  static const char *const known[] = {"VALUES", "TRENDS", "FIGURES", "RANKING", "RUNS"};
  if (sscanf(line, "@%63[A-Z] %63[a-z-]@", section, paper) != 2) {
    snprintf(paper, 64, "%s", strncmp(line, "@RANKING@", 9) == 0 ? "multicurvature" : "");
    if (sscanf(line, "@%63[A-Z]@", section) != 1) {
      return false;
    }
  }
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    if (strcmp(section, known[i]) == 0) {
      return true;
    }
  }
  return false;
}

static bool print_section(FILE *out, const char *line, const void *context) {
  const struct content *content = context;
  const struct works *works = content->works;
  char section[64], paper[64], mark[140];
  if (!read_section(line, section, paper)) {
    return false;
  }
  snprintf(mark, sizeof mark, "%s%s%s", section, *paper ? " " : "", paper);
  kept_begin(out, mark);
  if (*paper && !paper_is_wanted(works, paper, content->only) &&
      kept_print(out, content->kept, mark)) {
    kept_end(out);
    return true;
  }
  if (strcmp(section, "VALUES") == 0) {
    print_values(out, works, content->data, paper);
  } else if (strcmp(section, "TRENDS") == 0) {
    print_trends(out, works, content->data, paper);
  } else if (strcmp(section, "FIGURES") == 0) {
    print_figures(out, content->data, paper, content->figures);
  } else if (strcmp(section, "RANKING") == 0) {
    print_ranking(out, works, content->data);
  } else if (strcmp(section, "RUNS") == 0) {
    print_runs(out, works, content->only ? content->kept : NULL);
  }
  kept_end(out);
  return true;
}

static bool write_document(const struct arguments *a, const struct works *works) {
  char path[WORK_PATH], template[WORK_PATH], document[WORK_PATH], figures[WORK_PATH];
  snprintf(path, sizeof path, "%s/docs/reproduction.json", a->source);
  snprintf(template, sizeof template, "%s/docs/REPRODUCTION.in.md", a->source);
  snprintf(document, sizeof document, "%s/docs/REPRODUCTION.md", a->source);
  snprintf(figures, sizeof figures, "%s/docs/figures/reproduction", a->source);
  json_error_t error;
  json_t *data = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
  if (!data) {
    fprintf(stderr, "reproduction: %s:%d: %s\n", path, error.line, error.text);
    return false;
  }
  const char *pictures = a->figures ? a->figures : figures;
  char *kept = kept_read(document);
  struct content content = {works, data, pictures, a->only, kept};
  mkdir(pictures, 0777);
  bool drawn = write_plots(works, data, a->only, pictures);
  bool good =
      template_fill(template, a->document ? a->document : document, print_section, &content);
  free(kept);
  json_decref(data);
  return good && drawn;
}

/* ---- the program -------------------------------------------------------------------------- */

static bool parse(int argc, char **argv, struct arguments *a) {
  static const struct option options[] = {{"only", required_argument, NULL, 'o'},
                                          {"jobs", required_argument, NULL, 'j'},
                                          {"no-runs", no_argument, NULL, 'n'},
                                          {"solver", required_argument, NULL, 's'},
                                          {"source", required_argument, NULL, 'S'},
                                          {"build", required_argument, NULL, 'b'},
                                          {"document", required_argument, NULL, 'd'},
                                          {"figures", required_argument, NULL, 'f'},
                                          {0}};
  int option;
  while ((option = getopt_long(argc, argv, "", options, NULL)) != -1) {
    const char **place = option == 'o'   ? &a->only
                         : option == 's' ? &a->solver
                         : option == 'S' ? &a->source
                         : option == 'b' ? &a->build
                         : option == 'd' ? &a->document
                         : option == 'f' ? &a->figures
                                         : NULL;
    if (place) {
      *place = optarg;
    } else if (option == 'j') {
      a->processes = atoi(optarg);
    } else if (option == 'n') {
      a->no_runs = true;
    } else {
      return false;
    }
  }
  return optind == argc && a->solver && a->source && a->build && a->processes >= 1;
}

/* Whether --only names anything. */
static bool names_something(const struct works *works, const char *only) {
  for (int w = 0; w < works->count; w++) {
    if (work_is_wanted(&works->item[w], only)) {
      return true;
    }
  }
  fprintf(stderr, "reproduction: there is no job and no folder \"%s\"\n", only ? only : "");
  return false;
}

int main(int argc, char **argv) {
  long cores = sysconf(_SC_NPROCESSORS_ONLN);
  struct arguments a = {.processes = cores > 0 ? (int)cores : 1};
  struct works works;
  double start_s = clock_wall_s();
  if (!parse(argc, argv, &a)) {
    fputs("usage: reproduction [--only NAME] [--jobs N] [--no-runs] --solver FILE --source DIR\n"
          "                    --build DIR [--document FILE] [--figures DIR]\n",
          stderr);
    return EXIT_FAILURE;
  }
  bool good = works_find(&works, a.source, a.build) && names_something(&works, a.only) &&
              (a.no_runs || works_run(&works, a.only, a.solver, a.processes)) &&
              write_document(&a, &works);
  fprintf(stderr, "reproduction: %.1f min\n", (clock_wall_s() - start_s) / 60);
  works_release(&works);
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
