#include "solver/base/units.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <udunits2.h>

#include "solver/base/text.h"

enum { QUANTITY_MAX = 64, BASE_COUNT = 5, KNOWN_MAX = 256, KNOWN_TEXT = 24 };

/* A unit taken apart: value in SI = scale * number, SI unit = m^p0 kg^p1 s^p2 rad^p3 byte^p4. */
struct dimension {
  double scale;
  int power[BASE_COUNT];
  bool linear; /* no offset, logarithm, time origin or other base unit in it */
};

/* A unit that has been read before: UDUNITS takes some microseconds for one, and a study of many
 * members asks for the same few again and again. */
struct known_unit {
  char text[KNOWN_TEXT]; /* "": a free place */
  struct dimension dimension;
};

struct units {
  ut_system *system;
  struct known_unit *known; /* KNOWN_MAX, each at the place of its hash: the last to come stays */
};

/* The parser and the status of UDUNITS-2 live in static variables of the library, so calls
 * from several threads must not overlap, whichever handle they use. */
static pthread_mutex_t library_lock = PTHREAD_MUTEX_INITIALIZER;

static const struct {
  const char *name;
  int power[BASE_COUNT];
} dimension_names[] = {
    {"a length", {1, 0, 0, 0, 0}},
    {"an area", {2, 0, 0, 0, 0}},
    {"a volume", {3, 0, 0, 0, 0}},
    {"a mass", {0, 1, 0, 0, 0}},
    {"a time", {0, 0, 1, 0, 0}},
    {"an angle", {0, 0, 0, 1, 0}},
    {"a pressure", {-1, 1, -2, 0, 0}},
    {"a force", {1, 1, -2, 0, 0}},
    {"a speed", {1, 0, -1, 0, 0}},
    {"an acceleration", {1, 0, -2, 0, 0}},
    {"a density", {-3, 1, 0, 0, 0}},
    {"a rate", {0, 0, -1, 0, 0}},
    {"a pure number", {0, 0, 0, 0, 0}},
    {"a stiffness", {0, 1, -2, 0, 0}},
    {"a damping", {0, 1, -1, 0, 0}},
    {"a torque", {2, 1, -2, 0, 0}},
    {"a moment of inertia", {2, 1, 0, 0, 0}},
    {"an angular speed", {0, 0, -1, 1, 0}},
    {"a rate of pressure", {-1, 1, -3, 0, 0}},
    {"a conductance", {4, -1, 1, 0, 0}},
    {"an amount of memory", {0, 0, 0, 0, 1}},
};

/* ---- taking a unit apart ---------------------------------------------------------------- */

/* The visitor's functions cannot reach the visitor itself, so both travel together. */
struct visit {
  const ut_visitor *visitor;
  struct dimension *dimension;
};

static void add_power(struct dimension *dimension, const ut_unit *basic, int power) {
  static const char *const symbols[BASE_COUNT] = {"m", "kg", "s", "rad", "byte"};
  const char *symbol = ut_get_symbol(basic, UT_ASCII);
  for (int i = 0; symbol && i < BASE_COUNT; i++) {
    if (strcmp(symbol, symbols[i]) == 0) {
      dimension->power[i] += power;
      return;
    }
  }
  dimension->linear = false;
}

static ut_status visit_basic(const ut_unit *unit, void *argument) {
  add_power(((struct visit *)argument)->dimension, unit, 1);
  return UT_SUCCESS;
}

static ut_status visit_product(const ut_unit *unit, int count, const ut_unit *const *basic,
                               const int *powers, void *argument) {
  (void)unit;
  for (int i = 0; i < count; i++) {
    add_power(((struct visit *)argument)->dimension, basic[i], powers[i]);
  }
  return UT_SUCCESS;
}

static ut_status visit_galilean(const ut_unit *unit, double scale, const ut_unit *underlying,
                                double offset, void *argument) {
  (void)unit;
  struct visit *visit = argument;
  visit->dimension->scale *= scale;
  if (offset != 0.0) {
    visit->dimension->linear = false;
  }
  return ut_accept_visitor(underlying, visit->visitor, visit);
}

static ut_status visit_timestamp(const ut_unit *unit, const ut_unit *time, double origin,
                                 void *argument) {
  (void)unit, (void)time, (void)origin;
  ((struct visit *)argument)->dimension->linear = false;
  return UT_SUCCESS;
}

static ut_status visit_logarithmic(const ut_unit *unit, double base, const ut_unit *reference,
                                   void *argument) {
  (void)unit, (void)base, (void)reference;
  ((struct visit *)argument)->dimension->linear = false;
  return UT_SUCCESS;
}

/* false when UDUNITS does not know the unit. */
static bool take_apart(const struct units *units, const char *text, struct dimension *dimension) {
  static const ut_visitor visitor = {visit_basic, visit_product, visit_galilean, visit_timestamp,
                                     visit_logarithmic};
  ut_unit *unit = ut_parse(units->system, text, UT_UTF8);
  if (!unit) {
    return false;
  }
  *dimension = (struct dimension){.scale = 1.0, .linear = true};
  struct visit visit = {&visitor, dimension};
  ut_status status = ut_accept_visitor(unit, &visitor, &visit);
  ut_free(unit);
  return status == UT_SUCCESS;
}

/* Place of a unit among the known ones: FNV-1a. */
static size_t known_place(const char *text) {
  uint32_t hash = 2166136261u;
  for (const char *at = text; *at; at++) {
    hash = (hash ^ (unsigned char)*at) * 16777619u;
  }
  return (hash ^ hash >> 16) % KNOWN_MAX;
}

/* take_apart, or what it gave before. Call with the lock held. */
static bool parse_unit(const struct units *units, const char *text, struct dimension *dimension) {
  struct known_unit *known = &units->known[known_place(text)];
  if (text[0] && strcmp(known->text, text) == 0) {
    *dimension = known->dimension;
    return true;
  }
  if (!take_apart(units, text, dimension)) {
    return false;
  }
  size_t length = strlen(text);
  if (length < KNOWN_TEXT) {
    memcpy(known->text, text, length + 1);
    known->dimension = *dimension;
  }
  return true;
}

/* ---- the handle ------------------------------------------------------------------------- */

/* Adds amounts of memory, which UDUNITS takes for pure numbers or does not know: a base unit of
 * their own, under the signs that people write. */
static bool add_memory(ut_system *system) {
  static const struct {
    const char *sign;
    double bytes;
  } known[] = {{"kB", 1e3},     {"MB", 1e6},     {"GB", 1e9},     {"TB", 1e12},
               {"KiB", 0x1p10}, {"MiB", 0x1p20}, {"GiB", 0x1p30}, {"TiB", 0x1p40}};
  ut_unit *byte = ut_new_base_unit(system);
  bool good = byte && ut_map_unit_to_symbol(byte, "byte", UT_ASCII) == UT_SUCCESS;
  for (size_t i = 0; good && i < sizeof known / sizeof *known; i++) {
    ut_unit *unit = ut_scale(known[i].bytes, byte);
    good = unit && ut_map_symbol_to_unit(known[i].sign, UT_ASCII, unit) == UT_SUCCESS;
    ut_free(unit);
  }
  ut_free(byte);
  return good;
}

enum status units_create(struct units **units, struct error *error) {
  struct units *created = calloc(1, sizeof *created);
  if (created) {
    created->known = calloc(KNOWN_MAX, sizeof *created->known);
  }
  if (!created || !created->known) {
    free(created);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the unit database");
  }
  enum status status = STATUS_OK;
  pthread_mutex_lock(&library_lock);
  ut_set_error_message_handler(ut_ignore); /* it would write to standard error */
  created->system = ut_read_xml(NULL);
  ut_unit *degree = created->system ? ut_get_unit_by_name(created->system, "degree") : NULL;
  if (!degree || ut_map_name_to_unit("deg", UT_ASCII, degree) != UT_SUCCESS ||
      !add_memory(created->system)) {
    status = error_set(error, STATUS_IO, NULL,
                       "the unit database cannot be read: install UDUNITS-2's data, or name its "
                       "file in UDUNITS2_XML_PATH");
  }
  ut_free(degree);
  pthread_mutex_unlock(&library_lock);
  if (status != STATUS_OK) {
    units_destroy(created);
    return status;
  }
  *units = created;
  return STATUS_OK;
}

void units_destroy(struct units *units) {
  if (!units) {
    return;
  }
  pthread_mutex_lock(&library_lock);
  ut_free_system(units->system);
  pthread_mutex_unlock(&library_lock);
  free(units->known);
  free(units);
}

/* ---- reading a quantity ----------------------------------------------------------------- */

static size_t count_digits(const char *text) {
  return strspn(text, "0123456789");
}

/* Length of the decimal number at the start of `text`, 0 when there is none. Stricter than
 * strtod: no hexadecimal, no "inf", no "nan". */
static size_t number_length(const char *text) {
  const char *at = text + (*text == '-' || *text == '+');
  size_t whole = count_digits(at);
  at += whole;
  size_t part = *at == '.' ? count_digits(at + 1) : 0;
  if (whole + part == 0) {
    return 0;
  }
  if (*at == '.') {
    at += part + 1;
  }
  if (*at == 'e' || *at == 'E') {
    size_t sign = at[1] == '-' || at[1] == '+';
    size_t digits = count_digits(at + 1 + sign);
    if (digits > 0) {
      at += 1 + sign + digits;
    }
  }
  return (size_t)(at - text);
}

/* Length of the name at the start of `text`: letters with digits between them ("inH2O"), or one of
 * the signs. */
static size_t name_length(const char *text) {
  static const char *const signs[] = {"%", "\xC2\xB0"};
  for (size_t i = 0; i < sizeof signs / sizeof *signs; i++) {
    if (strncmp(text, signs[i], strlen(signs[i])) == 0) {
      size_t letter = i == 1 && isalpha((unsigned char)text[2]);
      return strlen(signs[i]) + letter; /* the degree Celsius */
    }
  }
  size_t length = 0;
  for (const char *at = text;;) {
    bool micro = strncmp(at, "\xC2\xB5", 2) == 0 || strncmp(at, "\xCE\xBC", 2) == 0;
    if (micro || isalpha((unsigned char)*at) || *at == '_') {
      at += 1 + micro;
      length = (size_t)(at - text);
    } else if (length > 0 && isdigit((unsigned char)*at)) {
      at++;
    } else {
      return length;
    }
  }
}

/* Length of the exponent at the start of `text`, of one digit: "2", "-2", "^-2", or raised. Not 0:
 * that would read "3W0 mm" as 3 mm. */
static size_t exponent_length(const char *text) {
  static const char *const digits[] = {"\xC2\xB9", "\xC2\xB2", "\xC2\xB3"};
  size_t minus = strncmp(text, "\xE2\x81\xBB", 3) == 0 ? 3 : 0;
  for (size_t i = 0; i < sizeof digits / sizeof *digits; i++) {
    if (strncmp(text + minus, digits[i], 2) == 0) {
      return minus + 2;
    }
  }
  size_t sign = text[0] == '^';
  sign += text[sign] == '-';
  return text[sign] >= '1' && text[sign] <= '9' ? sign + 1 : 0;
}

/* Length of what multiplies or divides at the start of `text`: spaces, or a sign with or without
 * them. */
static size_t operator_length(const char *text) {
  size_t spaces = strspn(text, " ");
  const char *at = text + spaces;
  size_t sign = strncmp(at, "\xC2\xB7", 2) == 0 ? 2 : *at && strchr("/*.-", *at);
  sign = strncmp(at, "per ", 4) == 0 && spaces > 0 ? 4 : sign;
  return spaces + sign + strspn(at + sign, " ");
}

/* Whether a shift of the origin stands for the name: "m from 5". */
static bool is_shift(const char *name, size_t length) {
  static const char *const words[] = {"since", "after", "from", "ref", "per"};
  for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
    if (length == strlen(words[i]) && strncmp(name, words[i], length) == 0) {
      return true;
    }
  }
  return false;
}

/* UDUNITS takes whole expressions: factors ("3 kPa"), shifts ("m @ 5"), logarithms. After the
 * number only a plain unit may follow: names, products, quotients, one-digit powers, parentheses.
 * Its parser loses memory where a text is malformed or a name unknown, so it is given neither: each
 * name is looked for alone first. Call with the lock held. */
static bool is_known_unit(const struct units *units, const char *unit) {
  const char *at = strncmp(unit, "1/", 2) == 0 ? unit + 2 : unit;
  struct dimension ignored;
  int open = 0;
  for (;;) {
    while (*at == '(') {
      at++;
      open++;
    }
    char name[QUANTITY_MAX + 1];
    size_t length = name_length(at);
    if (length == 0 || length >= sizeof name || is_shift(at, length)) {
      return false;
    }
    memcpy(name, at, length);
    name[length] = '\0';
    if (!parse_unit(units, name, &ignored)) {
      return false;
    }
    at += length + exponent_length(at + length);
    for (; *at == ')' && open > 0; open--) {
      at++;
      at += exponent_length(at);
    }
    if (*at == '\0') {
      return open == 0;
    }
    length = operator_length(at);
    if (length == 0) {
      return false;
    }
    at += length;
  }
}

static const char *dimension_name(const struct dimension *dimension) {
  for (size_t i = 0; i < sizeof dimension_names / sizeof *dimension_names; i++) {
    if (memcmp(dimension_names[i].power, dimension->power, sizeof dimension->power) == 0) {
      return dimension_names[i].name;
    }
  }
  return "another kind of quantity";
}

const char *units_dimension(const struct units *units, const char *unit) {
  struct dimension wanted;
  pthread_mutex_lock(&library_lock);
  bool known = parse_unit(units, unit, &wanted);
  pthread_mutex_unlock(&library_lock);
  return known ? dimension_name(&wanted) : "a quantity";
}

static enum status read_unit(const struct units *units, const char *name, const char *number,
                             const char *quoted, const char *unit, double *scale,
                             struct error *error) {
  struct dimension given, wanted;
  pthread_mutex_lock(&library_lock);
  bool known = is_known_unit(units, name) && parse_unit(units, name, &given);
  bool wanted_known = parse_unit(units, unit, &wanted);
  pthread_mutex_unlock(&library_lock);
  if (!wanted_known || !wanted.linear) {
    return error_set(error, STATUS_INTERNAL, NULL, "the program asks for the unknown unit \"%s\"",
                     unit);
  }
  if (!known) {
    return error_set(error, STATUS_INVALID, NULL,
                     "%s has an unknown unit\n%s with its unit\n\"%s %s\"", quoted,
                     dimension_name(&wanted), number, unit);
  }
  if (!given.linear) {
    return error_set(error, STATUS_INVALID, NULL,
                     "%s is not a plain multiple of %s\n%s with its unit\n\"%s %s\"", quoted, unit,
                     dimension_name(&wanted), number, unit);
  }
  if (memcmp(given.power, wanted.power, sizeof given.power) != 0) {
    return error_set(error, STATUS_INVALID, NULL,
                     "%s is %s, but %s is wanted\n%s with its unit\n\"%s %s\"", quoted,
                     dimension_name(&given), dimension_name(&wanted), dimension_name(&wanted),
                     number, unit);
  }
  *scale = given.scale;
  return STATUS_OK;
}

enum status units_read(const struct units *units, const char *text, const char *unit,
                       double *value_si, struct error *error) {
  char quoted[QUANTITY_MAX + 16];
  text_quote(quoted, sizeof quoted, text);
  if (strnlen(text, QUANTITY_MAX + 1) > QUANTITY_MAX) {
    return error_set(error, STATUS_INVALID, NULL,
                     "%s is longer than %d characters\n%s with its unit\n\"1 %s\"", quoted,
                     QUANTITY_MAX, units_dimension(units, unit), unit);
  }
  size_t length = number_length(text);
  if (length == 0) {
    return error_set(error, STATUS_INVALID, NULL,
                     "%s does not begin with a decimal number\n%s with its unit\n\"1 %s\"", quoted,
                     units_dimension(units, unit), unit);
  }
  char number[QUANTITY_MAX + 1];
  memcpy(number, text, length);
  number[length] = '\0';
  const char *name = text + length + strspn(text + length, " ");
  if (*name == '\0') {
    return error_set(error, STATUS_INVALID, NULL, "%s has no unit\n%s with its unit\n\"%s %s\"",
                     quoted, units_dimension(units, unit), number, unit);
  }
  double scale = 0.0;
  enum status status = read_unit(units, name, number, quoted, unit, &scale, error);
  if (status != STATUS_OK) {
    return status;
  }
  errno = 0;
  double value = strtod(number, NULL);
  bool vanished = value != 0.0 && value * scale == 0.0;
  if (errno == ERANGE || vanished || !isfinite(value * scale)) {
    return error_set(error, STATUS_INVALID, NULL,
                     "%s is beyond the range of numbers\n%s with its unit\n\"1 %s\"", quoted,
                     units_dimension(units, unit), unit);
  }
  *value_si = value * scale;
  return STATUS_OK;
}
