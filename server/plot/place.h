/* What is already drawn, in pixels, so that words can be put where nothing is. */
#ifndef PNEULAB_PLOT_PLACE_H
#define PNEULAB_PLOT_PLACE_H

#include <stdbool.h>
#include <stddef.h>

/* A rectangle with its top left corner at (x, y), y downwards. */
struct box {
  double x, y, width, height;
};

struct place_segment {
  double x0, y0, x1, y1;
};

/* Obstacles. Start from a zeroed one inside `bounds`. When memory runs out further obstacles are
 * forgotten: the picture is less tidy then, never wrong. */
struct place {
  struct box bounds; /* words must stay inside */
  struct box *boxes;
  size_t box_count, box_room;
  struct place_segment *segments;
  size_t segment_count, segment_room;
};

void place_release(struct place *place);
void place_add_box(struct place *place, struct box box);
void place_add_segment(struct place *place, struct place_segment segment);

/* Whether `box`, grown by `margin` on all sides, is inside the bounds and touches no obstacle. */
bool place_is_free(const struct place *place, struct box box, double margin);

/* Finds a free place for a box of the given size: corners first, then along the edges, then
 * anywhere on a grid. Returns false and leaves *found alone when there is none. */
bool place_find(const struct place *place, double width, double height, double margin,
                struct box *found);

/* Finds a free place next to the point (x, y) at `distance`, above right first.
 * Returns false when all eight are taken. */
bool place_find_beside(const struct place *place, double x, double y, double width, double height,
                       double distance, struct box *found);

#endif
