/* Files that a job names, { "file": "curve.csv" }, and their content in their place.
 *
 * A job may name a file where a table ("data", also that of "measured", "input", each of
 * "tables" and the "input" of each of "actuators"), the base of a study ("base"), the snap job
 * of a bistable one ("snap", also that of each of "laws") or the surface of an object ("stl" of the
 * "shape" of an "object") is due.
 * Whoever has the job's file at hand embeds the content before the job is read, so that everything
 * after it, the hash included, depends on the content alone:
 *   table   { "file": "curve.csv" }  becomes  { "csv": "text of the file" }
 *   base    { "file": "base.json" }  becomes  the document of that file, embedded likewise
 *   snap    { "file": "snap.json" }  becomes  the document of that file
 *   stl     { "file": "part.stl" }   becomes  { "base64": "its triangles as a binary file" }
 * A relative path starts at the folder of the file that names it. */
#ifndef PNEULAB_JOB_EMBED_H
#define PNEULAB_JOB_EMBED_H

#include <jansson.h>
#include <stddef.h>
#include "solver/base/error.h"

/* Triangles of a surface that fit into a job: 50 bytes each, four characters for three bytes, and
 * 64 KiB for the rest of it. */
enum { EMBED_TRIANGLES_MAX = (((1 << 20) - (64 << 10)) / 4 * 3 - 84) / 50 };

/* Embeds the files that the job in `text` names.
 * path: of the job's own file, or NULL when it has none: relative paths then start at the working
 * directory. *embedded: the self-contained document as text of *length bytes, to be freed by the
 * caller. Text without names of files is copied as it is.
 * STATUS_SYNTAX or TOO_LARGE as json_text_read; STATUS_INVALID with the pointer to the "file" that
 * cannot be read, is no text (or no STL file), or is larger than a job may be; STATUS_NO_MEMORY. */
enum status embed_files(const char *text, size_t size, const char *path, char **embedded,
                        size_t *length, struct error *error);

/* STATUS_OK when the document names no file, otherwise STATUS_INVALID with the pointer to it and
 * advice: what reads a job may not open files that the job's writer chose. */
enum status embed_refuse(const json_t *document, struct error *error);

#endif
