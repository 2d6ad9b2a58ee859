#include "server/http/html.h"

#include <assert.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

bool html_start(struct html *html) {
  *html = (struct html){0};
  html->out = open_memstream(&html->text, &html->size);
  return html->out != NULL;
}

char *html_finish(struct html *html, size_t *size) {
  assert(html->depth == 0);
  bool failed = !html->out || ferror(html->out);
  if (html->out) {
    failed |= fclose(html->out) != 0;
  }
  if (failed) {
    free(html->text);
    return NULL;
  }
  *size = html->size;
  return html->text;
}

void html_copy(struct html *html, const char *markup, size_t size) {
  fwrite(markup, 1, size, html->out);
}

/* Escapes what is special in a text or in an attribute between double quotes. */
static void put(struct html *html, const char *text) {
  while (*text) {
    size_t plain = strcspn(text, "<>&\"'");
    fwrite(text, 1, plain, html->out);
    text += plain;
    switch (*text) {
    case '<':
      fputs("&lt;", html->out);
      break;
    case '>':
      fputs("&gt;", html->out);
      break;
    case '&':
      fputs("&amp;", html->out);
      break;
    case '"':
      fputs("&quot;", html->out);
      break;
    case '\'':
      fputs("&#39;", html->out);
      break;
    default:
      return;
    }
    text++;
  }
}

static void start_tag(struct html *html, const char *tag, va_list attributes) {
  const char *name;
  fprintf(html->out, "<%s", tag);
  while ((name = va_arg(attributes, const char *))) {
    const char *value = va_arg(attributes, const char *);
    if (value) {
      fprintf(html->out, " %s=\"", name);
      put(html, value);
      fputc('"', html->out);
    }
  }
  fputc('>', html->out);
}

static void push(struct html *html, const char *tag) {
  assert(html->depth < HTML_DEPTH);
  html->open[html->depth++] = tag;
}

void html_open(struct html *html, const char *tag, ...) {
  va_list attributes;
  va_start(attributes, tag);
  start_tag(html, tag, attributes);
  va_end(attributes);
  push(html, tag);
}

void html_void(struct html *html, const char *tag, ...) {
  va_list attributes;
  va_start(attributes, tag);
  start_tag(html, tag, attributes);
  va_end(attributes);
}

void html_leaf(struct html *html, const char *tag, const char *text, ...) {
  va_list attributes;
  va_start(attributes, text);
  start_tag(html, tag, attributes);
  va_end(attributes);
  push(html, tag);
  put(html, text);
  html_close(html);
}

void html_close(struct html *html) {
  assert(html->depth > 0);
  fprintf(html->out, "</%s>", html->open[--html->depth]);
}

void html_text(struct html *html, const char *text) {
  put(html, text);
}

void html_format(struct html *html, const char *format, ...) {
  char *text = NULL;
  va_list arguments;
  va_start(arguments, format);
  if (vasprintf(&text, format, arguments) >= 0) {
    put(html, text);
    free(text);
  }
  va_end(arguments);
}
