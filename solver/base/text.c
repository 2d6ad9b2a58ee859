#include "solver/base/text.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { WORD_MAX = 64 };

size_t text_prefix(const char *text, size_t limit) {
  size_t length = strnlen(text, limit + 1);
  if (length <= limit) {
    return length;
  }
  length = limit;
  while (length > 0 && ((unsigned char)text[length] & 0xC0) == 0x80) {
    length--;
  }
  return length;
}

/* Length of the UTF-8 character at `at`, 0 when it is malformed (RFC 3629: no overlong forms, no
 * surrogates, nothing above U+10FFFF). */
static size_t character_length(const unsigned char *at) {
  unsigned char lead = at[0];
  size_t length = lead < 0x80 ? 1 : lead < 0xC2 ? 0 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  for (size_t i = 1; i < length; i++) {
    if ((at[i] & 0xC0) != 0x80) {
      return 0;
    }
  }
  bool malformed = lead > 0xF4 || (lead == 0xE0 && at[1] < 0xA0) ||
                   (lead == 0xED && at[1] > 0x9F) || (lead == 0xF0 && at[1] < 0x90) ||
                   (lead == 0xF4 && at[1] > 0x8F);
  return malformed ? 0 : length;
}

size_t text_valid(const char *text, size_t size) {
  size_t valid = 0;
  while (valid < size) {
    unsigned char next[5] = {0}; /* the longest character and its end */
    memcpy(next, text + valid, size - valid < 4 ? size - valid : 4);
    size_t length = character_length(next);
    if (length == 0) {
      break;
    }
    valid += length;
  }
  return valid;
}

void text_repair(char *text) {
  while (*text) {
    size_t length = character_length((const unsigned char *)text);
    if (length == 0) {
      *text = '?';
      length = 1;
    }
    text += length;
  }
}

const char *text_quote(char *out, size_t size, const char *text) {
  size_t room = size - 3;
  size_t length = strnlen(text, room + 1);
  const char *tail = "\"";
  if (length > room) {
    length = text_prefix(text, room - 3);
    tail = "...\"";
  }
  out[0] = '"';
  for (size_t i = 0; i < length; i++) {
    unsigned char c = (unsigned char)text[i];
    out[i + 1] = c < 0x20 || c == 0x7F ? '?' : text[i];
  }
  memcpy(out + length + 1, tail, strlen(tail) + 1);
  return out;
}

static size_t smaller(size_t a, size_t b) {
  return a < b ? a : b;
}

static int folded(char c) {
  return tolower((unsigned char)c);
}

size_t text_distance(const char *a, const char *b) {
  size_t rows = strnlen(a, WORD_MAX + 1);
  size_t columns = strnlen(b, WORD_MAX + 1);
  if (rows > WORD_MAX || columns > WORD_MAX) {
    return SIZE_MAX;
  }
  size_t row[3][WORD_MAX + 1]; /* the last three rows of the table, used in turn */
  for (size_t j = 0; j <= columns; j++) {
    row[0][j] = j;
  }
  for (size_t i = 1; i <= rows; i++) {
    size_t *now = row[i % 3];
    const size_t *above = row[(i + 2) % 3];
    const size_t *two_above = row[(i + 1) % 3];
    now[0] = i;
    for (size_t j = 1; j <= columns; j++) {
      size_t replaced = above[j - 1] + (folded(a[i - 1]) != folded(b[j - 1]));
      now[j] = smaller(replaced, smaller(above[j], now[j - 1]) + 1);
      if (i > 1 && j > 1 && folded(a[i - 1]) == folded(b[j - 2]) &&
          folded(a[i - 2]) == folded(b[j - 1])) {
        now[j] = smaller(now[j], two_above[j - 2] + 1);
      }
    }
  }
  return row[rows % 3][columns];
}

const char *text_nearest(const char *text, const char *const *words, size_t count) {
  const char *nearest = NULL;
  size_t least = SIZE_MAX;
  for (size_t i = 0; i < count; i++) {
    size_t distance = text_distance(text, words[i]);
    size_t allowed = strlen(words[i]) / 3;
    if (distance < least && distance <= (allowed > 1 ? allowed : 1) &&
        (distance == 0 || distance < strlen(words[i]))) {
      least = distance;
      nearest = words[i];
    }
  }
  return nearest;
}

bool text_mentions(const char *text, const char *const *words) {
  for (; *words; words++) {
    if (strcasestr(text, *words)) {
      return true;
    }
  }
  return false;
}
