/* The members of a study's result document, read without trusting it. */
#ifndef PNEULAB_PLOT_MEMBERS_H
#define PNEULAB_PLOT_MEMBERS_H

#include "server/plot/data.h"

/* One member. Everything is borrowed from the document. */
struct member {
  const json_t *object; /* has samples and metrics like the result of a job */
  const char *name;
  bool stopped; /* it stopped early or failed */
};

struct members {
  struct member *list;
  size_t count;
};

/* Reads the members; *members is owned by the caller, who calls members_release in either case.
 * Error: STATUS_NO_MEMORY. */
enum status members_read(const json_t *result, struct members *members, struct error *error);
void members_release(struct members *members);

/* A metric of a member, NaN when it has none. */
double member_metric(const struct member *member, const char *key);

/* "job 7 · chamber gap · 3 members" */
void members_subtitle(const struct plot_input *input, size_t count, char text[DATA_HEADING]);

/* What a reader must know about the members that did not succeed, or "". */
void members_notice(const struct members *members, char text[DATA_HEADING]);

#endif
