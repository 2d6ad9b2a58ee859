#include "server/plot/quantity.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct suffix {
  const char *end, *unit;
};

/* longer ends first: "_mm" is the end of "_N_mm", "_kPa" that of "_deg_per_kPa" */
static const struct suffix suffixes[] = {
    {"_rad_per_m_kPa", "rad/(m kPa)"},
    {"_deg_per_kPa", "°/kPa"},
    {"_m_s", "m/s"},
    {"_kPa", "kPa"},
    {"_MPa", "MPa"},
    {"_deg", "°"},
    {"_pct", "%"},
    {"_percent", "%"},
    {"_mm3", "mm³"},
    {"_mm2", "mm²"},
    {"_N_mm", "N mm"},
    {"_mm", "mm"},
    {"_mJ", "mJ"},
    {"_N", "N"},
    {"_g", "g"},
    {"_s", "s"},
};

static const struct suffix *find_suffix(const char *key) {
  size_t length = strlen(key);
  for (size_t i = 0; i < sizeof suffixes / sizeof *suffixes; i++) {
    size_t end = strlen(suffixes[i].end);
    if (length > end && strcmp(key + length - end, suffixes[i].end) == 0) {
      return &suffixes[i];
    }
  }
  return NULL;
}

void quantity_unit(const char *key, char *text, size_t size) {
  const struct suffix *suffix = find_suffix(key);
  snprintf(text, size, "%s", suffix ? suffix->unit : "");
}

void quantity_name(const char *key, char *text, size_t size) {
  static const char *const known[][2] = {{"r_squared", "R²"},
                                         {"cai_rad_per_m_kPa", "CAI"},
                                         {"bending_angle_deg", "Bending angle"},
                                         {"twist_angle_deg", "Twist angle"},
                                         {"chord_angle_deg", "Angle of the chord"},
                                         {"end_face_angle_deg", "Angle of the end face"},
                                         {"contraction_pct", "Contraction of the reach"}};
  char words[100];
  const struct suffix *suffix = find_suffix(key);
  size_t length = strlen(key) - (suffix ? strlen(suffix->end) : 0);
  snprintf(words, sizeof words, "%.*s", (int)(length < 99 ? length : 99), key);
  for (char *c = words; *c; c++) {
    *c = *c == '_' ? ' ' : *c;
  }
  words[0] = (char)toupper((unsigned char)words[0]);
  const char *name = words;
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    name = strcmp(key, known[i][0]) == 0 ? known[i][1] : name;
  }
  snprintf(text, size, "%s", name);
}

void quantity_label(const char *key, char *text, size_t size) {
  char name[100], unit[QUANTITY_UNIT];
  quantity_name(key, name, sizeof name);
  quantity_unit(key, unit, sizeof unit);
  snprintf(text, size, *unit ? "%s (%s)" : "%s", name, unit);
}

bool quantity_read(const json_t *value, double *number, char unit[QUANTITY_UNIT]) {
  unit[0] = '\0';
  if (json_is_number(value)) {
    *number = json_number_value(value);
    return fabs(*number) <= 1e9;
  }
  const char *text = json_string_value(value);
  if (!text || !(isdigit((unsigned char)*text) || strchr("+-.", *text))) {
    return false; /* nor "nan", "inf" and what else strtod takes for numbers */
  }
  char *end;
  *number = strtod(text, &end);
  if (end == text || !(fabs(*number) <= 1e9)) {
    return false;
  }
  end += strspn(end, " ");
  size_t length = strlen(end);
  if (length >= QUANTITY_UNIT) {
    return false;
  }
  snprintf(unit, QUANTITY_UNIT, "%s", strcmp(end, "deg") == 0 ? "°" : end);
  return true;
}

double quantity_pressure_kPa(const json_t *value) {
  static const struct {
    const char *unit;
    double kPa;
  } units[] = {{"kPa", 1},   {"Pa", 1e-3},  {"MPa", 1e3},         {"hPa", 0.1},
               {"bar", 100}, {"mbar", 0.1}, {"psi", 6.894757293}, {"N/mm2", 1e3}};
  double number;
  char unit[QUANTITY_UNIT];
  if (json_is_string(value) && quantity_read(value, &number, unit)) {
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
      if (strcmp(unit, units[i].unit) == 0) {
        return number * units[i].kPa;
      }
    }
  }
  return NAN;
}
