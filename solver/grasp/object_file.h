/* The object's surface in files for ParaView, one for each frame. */
#ifndef PNEULAB_GRASP_OBJECT_FILE_H
#define PNEULAB_GRASP_OBJECT_FILE_H

#include <jansson.h>
#include "solver/rigid/skin.h"

struct object_file;

/* Of a skin, which is copied. The caller owns *out. STATUS_NO_MEMORY. */
enum status object_file_create(const struct rigid_skin *skin, struct object_file **out,
                               struct error *error);
void object_file_destroy(struct object_file *file);

/* Writes object-NNNN.vtu, the surface at its pose, and object.pvd, the list of those so far by
 * `time` (s), into the directory; appends the names of new files to `written`. STATUS_IO or
 * NO_MEMORY. */
enum status object_file_write(struct object_file *file, const char *directory,
                              const struct rigid_pose *pose, json_t *written, double time,
                              struct error *error);

#endif
