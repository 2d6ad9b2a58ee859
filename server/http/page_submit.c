/* The page where jobs are written, changed and submitted. */
#include <stdlib.h>
#include <string.h>

#include "server/http/handlers.h"
#include "server/http/page.h"

struct submit_page {
  char *document; /* the job to start from, or NULL */
  int64_t from;   /* whose document it is */
};

static void from_write(struct html *html, void *context) {
  const struct submit_page *page = context;
  char href[60];
  if (!page->document) {
    return;
  }
  snprintf(href, sizeof href, "/jobs/%lld", (long long)page->from);
  html_open(html, "p", "class", "muted", "id", "from", NULL);
  html_text(html, "From the document of ");
  html_open(html, "a", "href", href, NULL);
  html_format(html, "job %lld", (long long)page->from);
  html_close(html);
  html_text(html, ". It stays as it is: what you submit is a new job.");
  html_close(html);
}

/* A first newline belongs to the markup, not to the text. */
static void document_write(struct html *html, void *context) {
  const struct submit_page *page = context;
  html_text(html, "\n");
  html_text(html, page->document ? page->document : "");
}

void page_submit(struct request *request, struct reply *reply) {
  static const struct page_slot slots[] = {{"from", from_write}, {"document", document_write}};
  struct submit_page page = {.document = NULL};
  struct error error = {.status = STATUS_OK};
  if (!page_allowed(request, reply)) {
    return;
  }
  if (!request_query_integer(request, reply, "from", 1, INT64_MAX, 0, &page.from)) {
    page_problem(request, reply);
    return;
  }
  if (page.from != 0 &&
      store_document(request->service->store, page.from, &page.document, &error) != STATUS_OK) {
    reply_error(reply, &error);
    page_problem(request, reply);
    return;
  }
  page_reply(request, reply, "submit", "New job", slots, sizeof slots / sizeof *slots, &page);
  free(page.document);
}
