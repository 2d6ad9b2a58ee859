/* The page of a job: pictures, files, and commands for them. */
#include <stdio.h>
#include <string.h>

#include "server/http/access.h"
#include "server/http/page_job.h"
#include "server/http/page_text.h"

enum { PATH = 200 };

static const char *caption_of(const char *plot) {
  static const char *const captions[][2] = {
      {"angle", "Bending angle against pressure"},
      {"midline", "Centreline at the recorded pressures"},
      {"tip", "Path of the tip"},
      {"midline3d", "Centreline in three views"},
      {"tip3d", "Path of the tip in three views"},
      {"measured", "Simulation against measurement"},
      {"surface", "Deformed body, coloured by the largest stretch"},
      {"convergence", "Error against element size"},
      {"curve", "Computed values on the curve of the reference"},
      {"curves", "Every member against pressure"},
      {"metric", "A metric of the members"},
      {"ranking", "The best designs"},
      {"workspace", "Positions of the tip in three views"},
      {"twist", "Twist angle of every member against pressure"},
      {"contraction", "Contraction of every member against pressure"},
      {"mesh", "Convergence with the mesh"},
      {"fit", "Stress against strain, measured and fitted"},
      {"stress", "Stress of the material against stretch"},
      {"time", "Elongation, speed and pressure over time"},
      {"phase", "Speed against elongation"},
      {"steady", "Elongation at the end of each held set-point"},
      {"control", "Elongation under position control"},
      {"coefficients", "Identified coefficients with their polynomials"},
      {"fitted", "Trials, measured and simulated"},
      {"snap", "The fastest snap"},
      {"motion", "Elongation of plate and cells, speed and pressure over time"},
      {"snap-path", "Equilibrium under pressure and under axial force"},
      {"shapes", "Meridian in its states"},
      {"held", "Force at the natural length against pressure"},
      {"stability", "Loss of axisymmetry by harmonic"},
      {"suction", "Suction and bending against the number of suckers"},
      {"force", "Grasp force against displacement"},
      {"pressure", "Force on the object against pressure"},
      {"snapshots", "The grasp at its moments, coloured by contact pressure"},
      {"contact", "Contact pressure on the unrolled body"},
      {"stages", "Force, pressure and contact area from stage to stage"},
  };
  for (size_t i = 0; i < sizeof captions / sizeof *captions; i++) {
    if (strcmp(captions[i][0], plot) == 0) {
      return captions[i][1];
    }
  }
  return plot;
}

static bool has_artifact(const struct job_page *page, const char *name) {
  for (size_t i = 0; i < json_array_size(page->record.artifacts); i++) {
    if (strcmp(json_string_value(json_array_get(page->record.artifacts, i)), name) == 0) {
      return true;
    }
  }
  return false;
}

/* What the view on a page is made from, and the picture in its place where there is none. */
struct view {
  const char *artifact, *attribute; /* the file, and what tells the page of it */
  const char *plot, *title;
};

/* NULL: there is nothing to view. */
static const struct view *view_of(const struct job_page *page) {
  static const struct view views[] = {
      {"grasp.bin", "data-frames", "snapshots", "Grasp"},
      {"surface.bin", "data-surface", "surface", "Deformed body"},
  };
  for (size_t i = 0; i < sizeof views / sizeof *views && page->result; i++) {
    if (has_artifact(page, views[i].artifact)) {
      return &views[i];
    }
  }
  return NULL;
}

void job_page_shape(struct html *html, const struct job_page *page) {
  char plot[PATH], data[PATH];
  const struct view *view = view_of(page);
  if (!view) {
    return;
  }
  snprintf(plot, sizeof plot, "/api/v1/jobs/%lld/plots/%s.png", (long long)page->record.id,
           view->plot);
  snprintf(data, sizeof data, "/api/v1/jobs/%lld/artifacts/%s", (long long)page->record.id,
           view->artifact);
  html_open(html, "section", "class", "card", "id", "shape", "aria-labelledby", "shape-title",
            view->attribute, data, NULL);
  html_leaf(html, "h2", view->title, "id", "shape-title", NULL);
  html_open(html, "figure", "class", "shape plot", NULL);
  page_picture(html, plot, caption_of(view->plot), 800, 600);
  html_close(html);
  html_leaf(html, "div", "", "class", "shape-tools scripted", NULL);
  html_close(html);
}

void job_page_plots(struct html *html, const struct job_page *page) {
  json_t *plots = json_object_get(json_object_get(page->view, "links"), "plots"), *link;
  const struct view *view = view_of(page);
  size_t index, shown = 0;
  char name[PATH];
  json_array_foreach(plots, index, link) {
    const char *url = json_string_value(link), *last = strrchr(url, '/');
    snprintf(name, sizeof name, "%.*s", (int)strcspn(last + 1, "."), last + 1);
    if (view && strcmp(name, "surface") == 0) {
      continue;
    }
    if (shown++ == 0) {
      html_open(html, "section", "class", "card", "id", "plots", "aria-labelledby", "plots-title",
                NULL);
      html_leaf(html, "h2", "Plots", "id", "plots-title", NULL);
      html_open(html, "div", "class", "plots", "id", "plot-list", NULL);
    }
    html_open(html, "figure", "class", "plot", "data-plot", name, NULL);
    html_open(html, "a", "href", url, "title", "Open in full size", NULL);
    page_picture(html, url, caption_of(name), 800, 600);
    html_close(html);
    html_close(html);
  }
  if (shown > 0) {
    html_close(html);
    html_close(html);
  }
}

/* ---- files ------------------------------------------------------------------------------- */

static void file_write(struct html *html, const char *text, const char *url) {
  html_open(html, "li", NULL);
  html_leaf(html, "a", text, "href", url, NULL);
  html_close(html);
}

/* Fields of one recorded pressure: surface-0007.vtu. */
static bool is_state(const char *name) {
  size_t length = strlen(name);
  return length > 9 && name[length - 9] == '-' && strcmp(name + length - 4, ".vtu") == 0;
}

static void artifacts_write(struct html *html, const struct job_page *page, bool states) {
  char url[PATH + 300];
  for (size_t i = 0; i < json_array_size(page->record.artifacts); i++) {
    const char *name = json_string_value(json_array_get(page->record.artifacts, i));
    if (is_state(name) == states) {
      snprintf(url, sizeof url, "/api/v1/jobs/%lld/artifacts/%.280s", (long long)page->record.id,
               name);
      file_write(html, name, url);
    }
  }
}

static size_t states_count(const struct job_page *page) {
  size_t count = 0;
  for (size_t i = 0; i < json_array_size(page->record.artifacts); i++) {
    count += is_state(json_string_value(json_array_get(page->record.artifacts, i)));
  }
  return count;
}

void job_page_files(struct html *html, const struct job_page *page) {
  static const char *const results[][2] = {{"Result (JSON)", "result"},
                                           {"Samples (CSV)", "samples.csv"}};
  long long id = page->record.id;
  size_t states = states_count(page);
  char url[PATH];
  html_open(html, "section", "class", "card", "id", "files", "aria-labelledby", "files-title",
            NULL);
  html_leaf(html, "h2", "Files", "id", "files-title", NULL);
  html_open(html, "ul", "id", "file-list", "class", "plain", NULL);
  snprintf(url, sizeof url, "/api/v1/jobs/%lld/document", id);
  file_write(html, "Job document (JSON)", url);
  for (size_t i = 0; i < 2 && page->result; i++) {
    snprintf(url, sizeof url, "/api/v1/jobs/%lld/%s", id, results[i][1]);
    file_write(html, results[i][0], url);
  }
  if (page->record.started_ms) {
    snprintf(url, sizeof url, "/api/v1/jobs/%lld/log", id);
    file_write(html, "Log", url);
  }
  artifacts_write(html, page, false);
  html_close(html);
  if (states > 0) {
    html_open(html, "details", NULL);
    html_open(html, "summary", NULL);
    html_format(html, "%zu VTU files, one pressure each", states);
    html_close(html);
    html_open(html, "ul", "class", "plain", NULL);
    artifacts_write(html, page, true);
    html_close(html);
    html_close(html);
  }
  html_close(html);
}

/* ---- commands ---------------------------------------------------------------------------- */

static void command_write(struct html *html, const char *what, const char *command) {
  html_open(html, "div", "class", "command", NULL);
  html_leaf(html, "p", what, NULL);
  html_open(html, "pre", "tabindex", "0", "role", "region", "aria-label", what, NULL);
  html_leaf(html, "code", command, NULL);
  html_close(html);
  html_close(html);
}

void job_page_commands(struct html *html, const struct job_page *page) {
  const struct request *request = page->request;
  const char *host = request_header(request, "Host");
  const char *token = request->caller.name[0] ? " -H \"Authorization: Bearer $TOKEN\"" : "";
  long long id = page->record.id;
  char base[300], command[1000];
  snprintf(base, sizeof base, "%s://%.200s/api/v1/jobs",
           access_is_secure(request) ? "https" : "http", host ? host : "localhost");
  html_open(html, "section", "class", "card", "id", "commands", "aria-labelledby", "commands-title",
            NULL);
  html_leaf(html, "h2", "The same by curl", "id", "commands-title", NULL);
  snprintf(command, sizeof command,
           "curl -s%s %s/%lld/document |\n  curl%s -H 'Content-Type: application/json' "
           "--data-binary @- %s",
           token, base, id, token, base);
  command_write(html, "Submit this job once more", command);
  if (page->result) {
    snprintf(command, sizeof command, "curl -s%s %s/%lld/result > job-%lld.json", token, base, id,
             id);
    command_write(html, "Get the result", command);
    snprintf(command, sizeof command, "curl -s%s %s/%lld/samples.csv > job-%lld.csv", token, base,
             id, id);
    command_write(html, "Get the recorded states as a table", command);
  }
  html_close(html);
}
