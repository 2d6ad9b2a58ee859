#include "server/http/picture.h"

#include "server/http/service.h"

enum { WIDTH = 800, HEIGHT = 600 };

bool picture_query(const struct request *request, struct reply *reply, struct plot_sheet *sheet) {
  int64_t width, height;
  const char *theme = url_query(&request->url, "theme");
  if (!request_query_integer(request, reply, "width", SHEET_SIDE_MIN, SHEET_SIDE_MAX, WIDTH,
                             &width) ||
      !request_query_integer(request, reply, "height", SHEET_SIDE_MIN, SHEET_SIDE_MAX, HEIGHT,
                             &height)) {
    return false;
  }
  *sheet = (struct plot_sheet){.width = (int)width, .height = (int)height};
  if (theme && !colour_theme_of(theme, &sheet->theme)) {
    reply_problem(reply, 400, "invalid_query",
                  "theme=%.40s: expected light or dark, for example theme=dark.", theme);
    return false;
  }
  return true;
}
