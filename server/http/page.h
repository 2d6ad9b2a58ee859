/* Pages with data in them: a file of static/pages whose places <!--=name--> the daemon fills in.
 * They are whole without JavaScript; where there is some, it makes them live. */
#ifndef PNEULAB_HTTP_PAGE_H
#define PNEULAB_HTTP_PAGE_H

#include "server/http/html.h"
#include "server/http/service.h"

/* What goes into one place. */
struct page_slot {
  const char *name;
  void (*write)(struct html *html, void *context);
};

/* Replies with the page of that name ("job" for static/pages/job.html), whose places are filled by
 * the slots, called with the context. Every page also has "head": what the heads of all pages begin
 * with (static/pages/head.html), "top": the links to all pages and who is signed in, and "title"
 * (escaped). A place without a slot stays empty. */
void page_reply(struct request *request, struct reply *reply, const char *page, const char *title,
                const struct page_slot *slots, size_t count, void *context);

/* Turns a problem, with which the request was refused, into a page that says the same. */
void page_problem(struct request *request, struct reply *reply);

/* Whether the caller may read. Otherwise replies with the way to sign in, and back here
 * afterwards, and returns false. */
bool page_allowed(struct request *request, struct reply *reply);

#endif
