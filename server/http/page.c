#include "server/http/page.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/http/access.h"
#include "server/http/cache.h"
#include "server/http/static_files.h"
#include "solver/job/json.h"

static const char html_type[] = "text/html; charset=utf-8";

/* What the slots of all pages need to know. */
struct page {
  const struct request *request;
  const char *title;
  const struct page_slot *slots;
  size_t count;
  void *context;
};

static const struct static_file *template_find(const char *page) {
  char path[80];
  snprintf(path, sizeof path, "pages/%s.html", page);
  for (size_t i = 0; i < static_file_count; i++) {
    if (strcmp(static_files[i].path, path) == 0) {
      return &static_files[i];
    }
  }
  return NULL;
}

/* ---- the top of every page --------------------------------------------------------------- */

static void link_write(struct html *html, const struct request *request, const char *href,
                       const char *text) {
  const char *first = request->url.segment_count > 0 ? request->url.segments[0] : "";
  html_leaf(html, "a", text, "href", href, "aria-current",
            strcmp(first, href + 1) == 0 ? "page" : NULL, NULL);
  html_text(html, "\n");
}

static void session_write(struct html *html, const struct caller *caller) {
  if (caller->name[0] == '\0') {
    return;
  }
  html_open(html, "form", "id", "session", "class", "push", "method", "post", "action", "/sign-out",
            NULL);
  html_open(html, "span", "id", "caller", "class", "muted", NULL);
  html_format(html, "%s (%s)", caller->name, role_word(caller->role));
  html_close(html);
  html_leaf(html, "button", "Sign out", "type", "submit", NULL);
  html_close(html);
}

static void top_write(struct html *html, const struct request *request) {
  html_leaf(html, "a", "Skip to the content", "class", "skip", "href", "#main", NULL);
  html_open(html, "header", "class", "top", NULL);
  html_open(html, "a", "class", "brand", "href", "/", NULL);
  html_void(html, "img", "src", "/static/favicon.svg", "alt", "", "width", "28", "height", "28",
            NULL);
  html_text(html, "PneuLab");
  html_close(html);
  html_open(html, "nav", "aria-label", "Pages", NULL);
  link_write(html, request, "/", "Jobs");
  link_write(html, request, "/submit", "New job");
  link_write(html, request, "/docs", "API");
  html_leaf(html, "a", "Job format", "href", "/docs/job", NULL);
  html_close(html);
  session_write(html, &request->caller);
  html_close(html);
}

/* ---- filling a page ---------------------------------------------------------------------- */

static void template_fill(struct html *html, const struct static_file *file,
                          const struct page *page);

static void slot_write(struct html *html, const struct page *page, const char *name,
                       size_t length) {
  if (length == 4 && memcmp(name, "head", 4) == 0) {
    template_fill(html, template_find("head"), page);
  } else if (length == 3 && memcmp(name, "top", 3) == 0) {
    top_write(html, page->request);
  } else if (length == 5 && memcmp(name, "title", 5) == 0) {
    html_text(html, page->title);
  }
  for (size_t i = 0; i < page->count; i++) {
    if (strlen(page->slots[i].name) == length && memcmp(page->slots[i].name, name, length) == 0) {
      page->slots[i].write(html, page->context);
    }
  }
}

static void template_fill(struct html *html, const struct static_file *file,
                          const struct page *page) {
  static const char mark[] = "<!--=", end[] = "-->";
  const char *at = (const char *)file->plain.data, *stop = at + file->plain.size, *place;
  while ((place = memmem(at, (size_t)(stop - at), mark, sizeof mark - 1))) {
    const char *name = place + sizeof mark - 1;
    const char *after = memmem(name, (size_t)(stop - name), end, sizeof end - 1);
    if (!after) {
      break;
    }
    html_copy(html, at, (size_t)(place - at));
    slot_write(html, page, name, (size_t)(after - name));
    at = after + sizeof end - 1;
  }
  html_copy(html, at, (size_t)(stop - at));
}

void page_reply(struct request *request, struct reply *reply, const char *name, const char *title,
                const struct page_slot *slots, size_t count, void *context) {
  const struct page page = {request, title, slots, count, context};
  const struct static_file *file = template_find(name);
  struct html html;
  size_t size = 0;
  if (!file) {
    reply_problem(reply, 404, "not_found", "This build carries no pages.");
    return;
  }
  char *text = NULL;
  if (html_start(&html)) {
    template_fill(&html, file, &page);
    text = html_finish(&html, &size);
  }
  reply->content_type = html_type; /* the policy that goes with it, for a 304 too */
  if (text && reply->status == 200) {
    cache_reply_text(request, reply, html_type, text);
  } else {
    reply_text(reply, html_type, text, size);
  }
}

/* ---- refusals ---------------------------------------------------------------------------- */

static void detail_write(struct html *html, void *context) {
  html_text(html, context);
}

void page_problem(struct request *request, struct reply *reply) {
  static const struct page_slot slots[] = {{"detail", detail_write}};
  json_t *problem = reply->body ? json_read(reply->body, reply->size, 0, NULL) : NULL;
  const char *title = json_string_value(json_object_get(problem, "title"));
  const char *detail = json_string_value(json_object_get(problem, "detail"));
  if (title && detail && reply->status < 500) {
    page_reply(request, reply, "problem", title, slots, 1, (void *)detail);
  }
  json_decref(problem);
}

/* The address of the request, `between` the parameters of its query; "/" for one that would have to
 * be escaped. */
static void address_write(const struct request *request, const char *between, char *text,
                          size_t size) {
  size_t used = (size_t)snprintf(text, size, "%s", request->url.segment_count > 0 ? "" : "/");
  for (size_t i = 0; i < request->url.segment_count && used < size; i++) {
    used += (size_t)snprintf(text + used, size - used, "/%s", request->url.segments[i]);
  }
  for (size_t i = 0; i < request->url.query_count && used < size; i++) {
    used += (size_t)snprintf(text + used, size - used, "%s%s=%s", i == 0 ? "?" : between,
                             request->url.query[i].name, request->url.query[i].value);
  }
  if (used >= size || strpbrk(text, "\"<>\\ #")) {
    strcpy(text, "/");
  }
}

static void again_write(struct html *html, void *context) {
  char refresh[260];
  snprintf(refresh, sizeof refresh, "0; url=%s", (const char *)context);
  html_void(html, "meta", "http-equiv", "refresh", "content", refresh, NULL);
}

bool page_allowed(struct request *request, struct reply *reply) {
  static const struct page_slot slots[] = {{"again", again_write}};
  static const char text[] = "Sign in first.\n";
  const char *site = request_header(request, "Sec-Fetch-Site");
  char address[160], where[200];
  if (request->caller.role >= ROLE_READ) {
    return true;
  }
  if (request->bad_token && !access_note_failure(request, reply)) {
    return false;
  }
  if (site && strcmp(site, "same-origin") != 0 && strcmp(site, "none") != 0) {
    /* Whoever comes by a link of another site left the cookie at home (SameSite=Strict); a step of
     * our own brings it. */
    address_write(request, "&", address, sizeof address);
    page_reply(request, reply, "again", "PneuLab", slots, 1, address);
    return false;
  }
  address_write(request, "%26", address, sizeof address);
  snprintf(where, sizeof where, "/sign-in?next=%s", address);
  reply->status = 303;
  reply_static(reply, "text/plain; charset=utf-8", text, sizeof text - 1);
  reply_header(reply, "Location", "%s", where);
  return false;
}
