/* One path of a table, divided into the branches of a law. */
#ifndef PNEULAB_BISTABLE_LAW_PATH_H
#define PNEULAB_BISTABLE_LAW_PATH_H

#include <stdbool.h>
#include "solver/job/bistable.h"

/* A path with rising h in sum, and its turning points: of h (turn), where h ceases to rise and
 * where it rises again for good, and of the force (limit): the first
 * greatest one from the compressed end on, and the first least one from the stretched end on. */
struct law_path {
  const struct law_level *level;
  bool backward;            /* its points stand in reverse order */
  bool folds;               /* h has turning points */
  bool falls;               /* the force has a falling stretch */
  size_t last, first;       /* points of the compressed side end with `last`, those of the stretched
                             * one begin with `first` */
  double turn[2], force[2]; /* h at the turning points, and the forces there; without a fold the
                             * middle of the steepest fall, for both */
  double limit[2];          /* h; NAN where nothing falls */
};

/* Point i of the path, from the compressed side. */
size_t law_path_index(const struct law_path *path, size_t i);
double law_path_h(const struct law_path *path, size_t i);
double law_path_force(const struct law_path *path, size_t i);

/* Divides the path. STATUS_INVALID where it is no way from one side to the other. */
enum status law_path_divide(const struct law_level *level, struct law_path *path,
                            struct error *error);

#endif
