#include "server/http/url.h"

#include <string.h>
#include <strings.h>

static int hex_digit(char c) {
  if (c >= '0' && c <= '9') {
    return c - '0';
  }
  if (c >= 'a' && c <= 'f') {
    return c - 'a' + 10;
  }
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* Length of the well-formed UTF-8 sequence at `text`, 0 when there is none. */
static size_t utf8_length(const unsigned char *text) {
  static const struct {
    unsigned char first_low, first_high, second_low, second_high;
    size_t length;
  } forms[] = {{0xc2, 0xdf, 0x80, 0xbf, 2}, {0xe0, 0xe0, 0xa0, 0xbf, 3},
               {0xe1, 0xec, 0x80, 0xbf, 3}, {0xed, 0xed, 0x80, 0x9f, 3},
               {0xee, 0xef, 0x80, 0xbf, 3}, {0xf0, 0xf0, 0x90, 0xbf, 4},
               {0xf1, 0xf3, 0x80, 0xbf, 4}, {0xf4, 0xf4, 0x80, 0x8f, 4}};
  if (text[0] < 0x80) {
    return 1;
  }
  for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
    if (text[0] < forms[i].first_low || text[0] > forms[i].first_high) {
      continue;
    }
    if (text[1] < forms[i].second_low || text[1] > forms[i].second_high) {
      return 0;
    }
    for (size_t k = 2; k < forms[i].length; k++) {
      if ((text[k] & 0xc0) != 0x80) {
        return 0;
      }
    }
    return forms[i].length;
  }
  return 0;
}

static bool text_is_clean(const char *text) {
  const unsigned char *at = (const unsigned char *)text;
  while (*at) {
    size_t length = utf8_length(at);
    if (length == 0 || *at < 0x20 || *at == 0x7f) {
      return false;
    }
    at += length;
  }
  return true;
}

bool url_decode(char *text, bool plus) {
  char *to = text;
  for (const char *from = text; *from; from++) {
    if (*from == '%') {
      int high = hex_digit(from[1]);
      int low = high >= 0 ? hex_digit(from[2]) : -1;
      if (low < 0 || (high == 0 && low == 0)) {
        return false;
      }
      *to++ = (char)(high * 16 + low);
      from += 2;
    } else {
      *to++ = plus && *from == '+' ? ' ' : *from;
    }
  }
  *to = '\0';
  return text_is_clean(text);
}

static const char *url_path(char *path, struct url *url) {
  if (strchr(path, '\\')) {
    return "A path has no backslash.";
  }
  if (strcmp(path, "/") == 0) {
    return NULL;
  }
  char *rest = path + 1;
  while (rest) {
    char *segment = strsep(&rest, "/");
    if (!url_decode(segment, false)) {
      return "The path has a malformed escape, a control character or invalid UTF-8.";
    }
    if (strchr(segment, '/') || strchr(segment, '\\') || strcmp(segment, ".") == 0 ||
        strcmp(segment, "..") == 0) {
      return "The path has an encoded slash or a dot segment.";
    }
    if (url->segment_count == URL_SEGMENTS_MAX) {
      return "The path has too many segments.";
    }
    url->segments[url->segment_count++] = segment;
  }
  return NULL;
}

static const char *url_query_parse(char *query, struct url *url) {
  while (query) {
    char *value = strsep(&query, "&");
    if (*value == '\0') {
      continue;
    }
    char *name = strsep(&value, "=");
    if (!url_decode(name, true) || (value && !url_decode(value, true))) {
      return "The query has a malformed escape, a control character or invalid UTF-8.";
    }
    if (url_query(url, name)) {
      return "A query parameter is given twice.";
    }
    if (url->query_count == URL_QUERY_MAX) {
      return "The query has too many parameters.";
    }
    url->query[url->query_count++] = (struct url_pair){name, value ? value : ""};
  }
  return NULL;
}

const char *url_parse(char *target, struct url *url) {
  *url = (struct url){0};
  if (strchr(target, '#')) {
    return "A request target has no fragment.";
  }
  if (strncasecmp(target, "http://", 7) == 0) {
    url->authority = target + 7;
    target = strpbrk(target + 7, "/?");
    if (!target || *target == '?' || target == url->authority) {
      return "An absolute target needs a host and a path.";
    }
    /* Make room for the end of the authority: it moves into the place of "//". */
    size_t length = (size_t)(target - url->authority);
    char *moved = (char *)url->authority - 1;
    memmove(moved, url->authority, length);
    moved[length] = '\0';
    url->authority = moved;
  }
  if (*target != '/') {
    return "The request target must be a path that starts with a slash.";
  }
  char *query = strchr(target, '?');
  if (query) {
    *query++ = '\0';
  }
  const char *problem = url_path(target, url);
  return problem ? problem : url_query_parse(query, url);
}

const char *url_query(const struct url *url, const char *name) {
  for (size_t i = 0; i < url->query_count; i++) {
    if (strcmp(url->query[i].name, name) == 0) {
      return url->query[i].value;
    }
  }
  return NULL;
}
