#include "solver/base/base64.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

char *base64_encode(const void *bytes, size_t size, size_t *length) {
  const unsigned char *from = bytes;
  *length = (size + 2) / 3 * 4;
  char *text = malloc(*length + 1);
  if (!text) {
    return NULL;
  }
  for (size_t i = 0, k = 0; i < size; i += 3, k += 4) {
    size_t count = size - i < 3 ? size - i : 3;
    uint32_t group = (uint32_t)from[i] << 16;
    group |= count > 1 ? (uint32_t)from[i + 1] << 8 : 0;
    group |= count > 2 ? from[i + 2] : 0;
    for (size_t n = 0; n < 4; n++) {
      text[k + n] = n <= count ? digits[group >> (18 - 6 * n) & 63] : '=';
    }
  }
  text[*length] = '\0';
  return text;
}

bool base64_decode(const char *text, size_t length, unsigned char *bytes, size_t *size) {
  uint32_t group = 0;
  size_t filled = 0, padding = 0;
  *size = 0;
  for (size_t i = 0; i < length; i++) {
    const char *digit = text[i] != '\0' ? strchr(digits, text[i]) : NULL;
    if (strchr(" \t\r\n", text[i]) && text[i] != '\0') {
      continue;
    }
    if (text[i] == '=' && filled >= 2) {
      padding++;
    } else if (!digit || padding > 0) {
      return false;
    }
    group = group << 6 | (digit ? (uint32_t)(digit - digits) : 0);
    if (++filled < 4) {
      continue;
    }
    for (size_t n = 0; n < 3 - padding; n++) {
      bytes[(*size)++] = (unsigned char)(group >> (16 - 8 * n) & 255);
    }
    filled = 0;
    group = 0;
  }
  return filled == 0 && padding <= 2;
}
