/* surface.bin: the outer surface in all recorded states, small enough for a page to load at once.
 *
 * All numbers are little-endian. The file is
 *   8 bytes        "PNLSURF1"
 *   uint32         length of the header
 *   header         JSON: points P, quads Q, pressures_kPa [S], low_mm [3] and high_mm [3], and
 *                  fields: [{ name, unit, low, high }, ...]
 *   zlib stream    of Q x 4 uint32, the corners of the quadrilaterals with outward normals, and
 * then for each of x, y, z and of the fields S rows of P uint16 A uint16 v stands for low + v (high
 * - low) / 65535. What is stored is not v but the difference (modulo 2^16) to what one would
 * expect: in the first state to the point before, in the second to the state before, then to the
 * straight line through the two states before; of a corner the difference (modulo 2^32) to the
 * corner before. Of each row, and of the corners as a whole, first all lowest bytes are written,
 * then all next ones. */
#ifndef PNEULAB_POST_RECORDING_H
#define PNEULAB_POST_RECORDING_H

#include <stdio.h>
#include "solver/post/fields.h"

struct recording;

/* Of the outer surface of a mesh, without cavities, whole where half of it was modelled. The mesh
 * outlives the recording. The caller owns *out. STATUS_NO_MEMORY. */
enum status recording_create(const struct mesh *mesh, struct recording **out, struct error *error);
void recording_destroy(struct recording *recording);

/* Takes in a state at `pressure`, kPa. STATUS_NO_MEMORY. */
enum status recording_add(struct recording *recording, const struct fields *fields,
                          double pressure);

/* Writes the file; failures of writing are left to the caller's ferror. STATUS_NO_MEMORY. */
enum status recording_write(const struct recording *recording, FILE *file);

#endif
