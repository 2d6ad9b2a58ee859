#include "server/http/page_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/plot/quantity.h"

enum { MINUTE_MS = 60000, HOUR_MS = 60 * MINUTE_MS, DAY_MS = 24 * HOUR_MS };

/* ---- numbers ----------------------------------------------------------------------------- */

/* Copies digits with narrow spaces between thousands when there are five or more of them. */
static void group_digits(const char *digits, char *to) {
  size_t whole = strcspn(digits, ".");
  for (size_t i = 0; digits[i]; i++) {
    if (whole > 4 && i > 0 && i < whole && (whole - i) % 3 == 0) {
      to = stpcpy(to, "\u202f");
    }
    *to++ = digits[i];
  }
  *to = '\0';
}

/* 7.085·10⁻⁵ */
static void write_power(double size, char *to) {
  static const char *const raised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  char digits[40];
  snprintf(digits, sizeof digits, "%.3e", size);
  size_t mantissa = strcspn(digits, "e");
  int exponent = atoi(digits + mantissa + 1);
  to += sprintf(to, "%.*s·10%s", (int)mantissa, digits, exponent < 0 ? "⁻" : "");
  snprintf(digits, sizeof digits, "%d", abs(exponent));
  for (const char *c = digits; *c; c++) {
    to = stpcpy(to, raised[*c - '0']);
  }
}

void page_number(double value, char text[PAGE_TEXT]) {
  double size = fabs(value);
  char digits[40];
  char *to = text;
  if (!isfinite(value)) {
    strcpy(text, "–");
    return;
  }
  if (value < 0) {
    to = stpcpy(to, "−");
  }
  if (size == floor(size) && size < 1e12) {
    snprintf(digits, sizeof digits, "%.0f", size);
    group_digits(digits, to);
  } else if (size >= 1e7 || size < 1e-4) {
    write_power(size, to);
  } else {
    int decimals = 3 - (int)floor(log10(size));
    snprintf(digits, sizeof digits, "%.*f", decimals > 0 ? decimals : 0, size);
    group_digits(digits, to);
  }
}

/* ---- names ------------------------------------------------------------------------------- */

/* In the order in which people look for them. */
static const struct {
  const char *key, *label; /* NULL: as of every quantity */
} known[] = {
    {"grasp_force_peak_N", "Grasp force, peak"},
    {"grasp_force_mean_N", "Grasp force, mean in contact"},
    {"blocked_force_N", NULL},
    {"held", "Held (1 yes, 0 no)"},
    {"object_weight_N", "Weight of the object"},
    {"weight_carried_N", "Of it carried"},
    {"object_displacement_mm", "Moved when let go"},
    {"grasp_force_peak_at_mm", "Peak after"},
    {"slip_onset_mm", "Slips from"},
    {"released_at_mm", "Lets go at"},
    {"normal_force_N", "Sum of the normal forces"},
    {"contact_area_mm2", NULL},
    {"contact_pressure_max_kPa", "Largest contact pressure"},
    {"contact_pressure_uniformity", "Evenness of the contact pressure"},
    {"wrap_angle_deg", "Angle wrapped around the object"},
    {"curvature_match", "Match of body and object in curvature"},
    {"bending_angle_deg", NULL},
    {"sensitivity_deg_per_kPa", "Sensitivity"},
    {"r_squared", "R² of the straight line"},
    {"intercept_deg", "Intercept of the straight line"},
    {"cai_rad_per_m_kPa", "Curvature per pressure"},
    {"tip_deflection_mm", NULL},
    {"end_face_angle_deg", NULL},
    {"chord_angle_deg", "Angle of the base-to-tip line"},
    {"twist_angle_deg", NULL},
    {"side_bending_angle_deg", "Sideways bending"},
    {"turn_angle_deg", "Bending in any plane"},
    {"end_bending_angle_deg", "Tilt of the end section"},
    {"end_twist_angle_deg", "Twist of the end section"},
    {"contact_onset_kPa", "Chambers touch from"},
    {"max_stretch", "Largest stretch"},
    {"min_gap_mm", "Smallest gap"},
    {"max_penetration_mm", "Largest penetration"},
    {"cavity_volume_mm3", NULL},
    {"mass_g", NULL},
};

/* In the order of the alphabet behind those. */
static const struct {
  const char *key, *label;
} named[] = {
    {"friction_work_mJ", "Work of friction"},
    {"pull_work_mJ", "Work of the pull"},
    {"energy_error_pct", "Error of the energy balance"},
    {"dynamic_share_pct", "Share followed in motion"},
    {"displacement_mm", "Displacement of the object"},
    {"slip_share", "Share that slips"},
    {"reach_mm", "Distance from base to tip"},
    {"contraction_pct", "Loss of reach"},
    {"max_von_mises_kPa", "Largest von Mises stress"},
    {"max_principal_stress_kPa", "Largest principal stress"},
    {"wall_s", "Elapsed time"},
    {"cpu_s", "Processor time"},
    {"peak_memory_MB", "Peak memory"},
};

enum { KNOWN = sizeof known / sizeof *known, NAMED = sizeof named / sizeof *named };

void page_unit(const char *key, char text[PAGE_TEXT]) {
  static const char *const rest[][2] = {{"_MB", "MB"}, {"_ms", "ms"}, {"_Pa", "Pa"}};
  size_t length = strlen(key);
  quantity_unit(key, text, PAGE_TEXT);
  for (size_t i = 0; text[0] == '\0' && i < sizeof rest / sizeof *rest; i++) {
    size_t end = strlen(rest[i][0]);
    if (length > end && strcmp(key + length - end, rest[i][0]) == 0) {
      strcpy(text, rest[i][1]);
    }
  }
}

void page_label(const char *key, char text[PAGE_TEXT]) {
  for (size_t i = 0; i < KNOWN; i++) {
    if (known[i].label && strcmp(known[i].key, key) == 0) {
      strcpy(text, known[i].label);
      return;
    }
  }
  for (size_t i = 0; i < NAMED; i++) {
    if (strcmp(named[i].key, key) == 0) {
      strcpy(text, named[i].label);
      return;
    }
  }
  quantity_name(key, text, PAGE_TEXT);
}

void page_quantity(const char *key, double value, char text[PAGE_TEXT]) {
  char number[PAGE_TEXT], unit[PAGE_TEXT];
  page_number(value, number);
  page_unit(key, unit);
  bool close = unit[0] == '\0' || strcmp(unit, "°") == 0;
  snprintf(text, PAGE_TEXT, "%.90s%s%.20s", number, close ? "" : "\u00a0", unit);
}

void page_word(const char *word, char text[PAGE_TEXT]) {
  snprintf(text, PAGE_TEXT, "%s", word);
  for (char *c = text; *c; c++) {
    *c = *c == '_' ? ' ' : *c;
  }
}

/* ---- times and states -------------------------------------------------------------------- */

static void write_ago(int64_t since_ms, char text[PAGE_TEXT]) {
  if (since_ms < MINUTE_MS) {
    strcpy(text, "just now");
  } else if (since_ms < HOUR_MS) {
    snprintf(text, PAGE_TEXT, "%d min ago", (int)(since_ms / MINUTE_MS));
  } else if (since_ms < DAY_MS) {
    snprintf(text, PAGE_TEXT, "%d h ago", (int)(since_ms / HOUR_MS));
  } else {
    snprintf(text, PAGE_TEXT, "%lld d ago", (long long)(since_ms / DAY_MS));
  }
}

void page_time(struct html *html, int64_t unix_ms, int64_t now) {
  char iso[CLOCK_TEXT_SIZE], utc[PAGE_TEXT], text[PAGE_TEXT];
  if (unix_ms == 0) {
    html_text(html, "–");
    return;
  }
  clock_format(unix_ms, iso);
  snprintf(utc, sizeof utc, "%.10s %.8s UTC", iso, iso + 11);
  if (now == 0) {
    html_leaf(html, "time", utc, "datetime", iso, NULL);
  } else {
    write_ago(now - unix_ms, text);
    html_leaf(html, "time", text, "datetime", iso, "title", utc, NULL);
  }
}

void page_state(struct html *html, enum job_state state, const char *id) {
  char class[PAGE_TEXT], word[PAGE_TEXT];
  snprintf(class, sizeof class, "state %s", job_state_word(state));
  page_word(job_state_word(state), word);
  html_leaf(html, "span", word, "class", class, "id", id, NULL);
}

void page_picture(struct html *html, const char *url, const char *caption, int width, int height) {
  char light[600], dark[640], across[20], down[20];
  snprintf(light, sizeof light, "%.500s%cwidth=%d&height=%d", url, strchr(url, '?') ? '&' : '?',
           width, height);
  snprintf(dark, sizeof dark, "%s&theme=dark", light);
  snprintf(across, sizeof across, "%d", width);
  snprintf(down, sizeof down, "%d", height);
  html_open(html, "picture", NULL);
  html_void(html, "source", "srcset", dark, "media", "screen and (prefers-color-scheme: dark)",
            NULL);
  html_void(html, "img", "src", light, "alt", caption, "width", across, "height", down, NULL);
  html_close(html);
}

/* ---- metrics ----------------------------------------------------------------------------- */

static size_t rank(const char *key) {
  for (size_t i = 0; i < KNOWN; i++) {
    if (strcmp(known[i].key, key) == 0) {
      return i;
    }
  }
  return KNOWN;
}

static int by_importance(const void *left, const void *right) {
  const char *a = *(const char *const *)left, *b = *(const char *const *)right;
  size_t first = rank(a), second = rank(b);
  return first != second ? (first < second ? -1 : 1) : strcmp(a, b);
}

/* Whether a key is that of the error estimate of another metric. */
static bool is_error(const json_t *metrics, const char *key) {
  char base[PAGE_TEXT];
  size_t length = strlen(key);
  if (length <= 6 || length - 6 >= sizeof base || strcmp(key + length - 6, "_error") != 0) {
    return false;
  }
  snprintf(base, sizeof base, "%.*s", (int)(length - 6), key);
  return json_object_get(metrics, base) != NULL;
}

const char **page_metric_order(json_t *metrics) {
  size_t count = 0;
  const char *key;
  json_t *value;
  const char **keys = malloc((json_object_size(metrics) + 1) * sizeof *keys);
  if (!keys) {
    return NULL;
  }
  json_object_foreach(metrics, key, value) {
    if (!is_error(metrics, key)) {
      keys[count++] = key;
    }
  }
  qsort(keys, count, sizeof *keys, by_importance);
  keys[count] = NULL;
  return keys;
}

double page_metric_error(const json_t *metrics, const char *key) {
  char name[PAGE_TEXT];
  snprintf(name, sizeof name, "%s_error", key);
  const json_t *value = json_object_get(metrics, name);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

/* ---- advice ------------------------------------------------------------------------------ */

const char *page_advice(const char *reason_code) {
  static const char *const advice[][2] = {
      {"limit_point", "The body cannot carry more than this pressure: lower the pressure, thicken "
                      "the walls, or take a stiffer material."},
      {"loss_of_stability", "The body would snap sideways or wrinkle here: lower the pressure, or "
                            "thicken the walls that buckle."},
      {"material_instability", "The material law is not stable at these stretches: lower the "
                               "pressure, or take a law that was fitted further."},
      {"contact_cycling", "Contact did not settle: try more steps, or accuracy \"standard\" where "
                          "it was \"fast\"."},
      {"inverted_element", "The mesh folded over: try more steps, or a finer mesh."},
      {"step_below_minimum", "The load steps became too short: try more steps, or a lower "
                             "pressure."},
      {"timeout", "The time was over: give it a longer \"timeout\", or a lower accuracy."},
      {"memory_limit", "Give it more with \"memory\", or lower the accuracy."},
      {"no_memory", "Give it more with \"memory\", or lower the accuracy."},
      {"files_limit", "Record fewer steps, or let the daemon keep more with --files-limit."},
      {"invalid_job", "Edit the job and submit it again."},
      {"impossible_geometry", "Edit the dimensions and submit it again."},
      {"disk_failed", "Make room on the disk of the daemon; the job goes on by itself."},
      {"worker_killed", "Something ended the worker from outside, often the system for want of "
                        "memory. Retry it; if it happens again, look at the log."},
      {"worker_failed", "The worker broke off. Look at the log, then retry it."},
      {"too_many_attempts", "The daemon ended ten times while it ran. Retry it."},
      {"cancel_requested", "It was cancelled on request; retry it to solve it after all."},
  };
  for (size_t i = 0; i < sizeof advice / sizeof *advice; i++) {
    if (strcmp(advice[i][0], reason_code) == 0) {
      return advice[i][1];
    }
  }
  return NULL;
}
