/* What a request for a picture says about its sheet. */
#ifndef PNEULAB_HTTP_PICTURE_H
#define PNEULAB_HTTP_PICTURE_H

#include <stdbool.h>
#include "server/plot/sheet.h"

struct request;
struct reply;

/* Reads `width`, `height` and `theme` of the query. False after a reply that says what is wrong. */
bool picture_query(const struct request *request, struct reply *reply, struct plot_sheet *sheet);

#endif
