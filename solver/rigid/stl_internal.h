/* The two forms of an STL file. */
#ifndef PNEULAB_RIGID_STL_INTERNAL_H
#define PNEULAB_RIGID_STL_INTERNAL_H

#include "solver/rigid/stl.h"

/* Reads text that begins with "solid"; as stl_read. */
enum status stl_read_text(const unsigned char *data, size_t size, struct stl *stl,
                          struct error *error);

/* Errors that both forms have. */
enum status stl_refuse_count(double count, struct error *error);
enum status stl_refuse_memory(struct error *error);

#endif
