/* STL files, binary and text: triangles as they stand there, nothing assumed of their surface. */
#ifndef PNEULAB_RIGID_STL_H
#define PNEULAB_RIGID_STL_H

#include <stddef.h>
#include "solver/base/error.h"

enum {
  STL_TRIANGLES_MAX = 200000,
  STL_FILE_MAX = 64 << 20, /* bytes of a file that is looked at: text of that many triangles */
  STL_HEADER = 84,         /* bytes before the triangles of a binary file */
  STL_RECORD = 50          /* bytes of each of them */
};

struct stl {
  int count;      /* triangles */
  double *corner; /* 9 numbers each: x, y, z of its corners, in the file's unit; owned */
};

/* Reads `size` bytes of an STL file, binary (of exactly 84 + 50 n bytes) or text ("solid"); normals
 * and attributes in it are passed over, since corners in order say the same. Empties *stl, then
 * fills it; the caller releases it. STATUS_INVALID with what is wrong (in text with its line):
 * neither form, a count that does not fit the size, a number that is none or is not finite, no
 * triangle; STATUS_TOO_LARGE beyond STL_TRIANGLES_MAX; STATUS_NO_MEMORY. The error's pointer stays
 * empty. */
enum status stl_read(const unsigned char *data, size_t size, struct stl *stl, struct error *error);

/* The same for a file, of which no more than the header is read before size and count fit. Also
 * STATUS_TOO_LARGE beyond STL_FILE_MAX, STATUS_INVALID for what is no regular file or cannot be
 * read. */
enum status stl_load(const char *path, struct stl *stl, struct error *error);

void stl_release(struct stl *stl);

/* The triangles as a binary file of *size bytes, owned by the caller: coordinates in single
 * precision, normals zero, which the format allows. NULL when memory runs out. */
unsigned char *stl_write(const struct stl *stl, size_t *size);

#endif
