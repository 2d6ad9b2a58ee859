/* Any text as a quantity: a finite number in SI the same one each time, or a
 * sentence, never worse. The first byte picks the unit that is wanted. */
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/units.h"
#include "tests/fuzz/fuzz.h"

static void check_error(const struct error *error, enum status status) {
  json_t *message = json_string(error->message);
  if (status != STATUS_INVALID || error->status != status || !message ||
      error->message[0] == '\0') {
    abort();
  }
  json_decref(message);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const char *const wanted[] = {"mm",    "kPa", "deg", "s",    "kg/m3", "N/psi",
                                       "N s/m", "1/s", "g",   "m/s2", "1"};
  static struct units *units; /* kept between inputs, as the daemon keeps it */
  if (!units && units_create(&units, NULL) != STATUS_OK) {
    abort();
  }
  if (size == 0) {
    return 0;
  }
  char *text = malloc(size);
  if (!text) {
    return 0;
  }
  memcpy(text, data + 1, size - 1);
  text[size - 1] = '\0';
  const char *unit = wanted[data[0] % (sizeof wanted / sizeof *wanted)];
  double first = NAN, second = NAN;
  struct error error = {.status = STATUS_OK};
  enum status status = units_read(units, text, unit, &first, &error);
  if (status != STATUS_OK) {
    check_error(&error, status);
  } else if (!isfinite(first) || units_read(units, text, unit, &second, NULL) != STATUS_OK ||
             first != second) {
    abort();
  }
  free(text);
  return 0;
}
