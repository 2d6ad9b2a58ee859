#include "solver/job/embed.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "solver/base/base64.h"
#include "solver/base/text.h"
#include "solver/job/json.h"
#include "solver/rigid/stl.h"

#define ANY "*"

enum { WAY_MAX = 2 };

/* What a file holds: a table of data, a document, or triangles, as text or binary. */
enum content { CONTENT_TABLE, CONTENT_DOCUMENT, CONTENT_SURFACE };

/* A place where a job may name a file. */
struct slot {
  /* Way from the document to what holds the key, NULL where it ends: members, of which lists are
   * entered by themselves, and ANY for each member of an object. */
  const char *way[WAY_MAX + 1];
  const char *key;
  enum content content;
};

static const struct slot slots[] = {{{NULL}, "data", CONTENT_TABLE},
                                    {{"measured"}, "data", CONTENT_TABLE},
                                    {{"input"}, "data", CONTENT_TABLE},
                                    {{"tables"}, "data", CONTENT_TABLE},
                                    {{"actuators", "input"}, "data", CONTENT_TABLE},
                                    {{NULL}, "base", CONTENT_DOCUMENT},
                                    {{NULL}, "snap", CONTENT_DOCUMENT},
                                    {{"laws", ANY}, "snap", CONTENT_DOCUMENT},
                                    {{"object", "shape"}, "stl", CONTENT_SURFACE}};

static const struct {
  const char *refusal, *example;
} kinds[] = {
    [CONTENT_TABLE] = {"is no table: give one of comma-separated values, as .csv", "curve.csv"},
    [CONTENT_DOCUMENT] = {"is no job document: give one, as .json", "baseline.json"},
    [CONTENT_SURFACE] = {"is no surface: give one of triangles, as .stl", "part.stl"}};

enum { SLOTS = sizeof slots / sizeof *slots, EMBED_LEVELS = 2 };

/* What is done at every place on the way through a document. */
struct embedding {
  bool read; /* put contents in, rather than refuse */
  bool changed;
  struct json_pointer pointer;
  struct error *error;
};

static enum status walk(struct embedding *embedding, json_t *document, const char *folder,
                        int level);

/* ---- reading ---------------------------------------------------------------------------- */

/* "folder/name", or the name alone where it is absolute or the folder is not known. The caller
 * frees it. */
static char *join_path(const char *folder, const char *name) {
  bool alone = !folder || name[0] == '/';
  size_t size = strlen(name) + (alone ? 0 : strlen(folder) + 1) + 1;
  char *path = malloc(size);
  if (path) {
    snprintf(path, size, "%s%s%s", alone ? "" : folder, alone ? "" : "/", name);
  }
  return path;
}

/* The folder of a path, NULL for the working directory. The caller frees it. */
static enum status folder_of(const char *path, char **folder) {
  const char *slash = path ? strrchr(path, '/') : NULL;
  *folder = slash ? strndup(path, slash == path ? 1 : (size_t)(slash - path)) : NULL;
  return slash && !*folder ? STATUS_NO_MEMORY : STATUS_OK;
}

static enum status refuse_file(struct embedding *embedding, const char *name, const char *why) {
  char quoted[160];
  return error_set(embedding->error, STATUS_INVALID, embedding->pointer.text,
                   "the file %s %s\npaths start at the folder of the job's file",
                   text_quote(quoted, sizeof quoted, name), why);
}

static enum status refuse_open(struct embedding *embedding, const char *name) {
  char why[100];
  snprintf(why, sizeof why, "cannot be opened (%s)", strerror(errno));
  return refuse_file(embedding, name, why);
}

/* Reads a whole file of text into *text, NUL-terminated, owned by the caller. */
static enum status read_file(struct embedding *embedding, const char *path, const char *name,
                             char **text, size_t *size) {
  struct stat properties;
  enum status status = STATUS_OK;
  /* Opening a pipe would wait for its writer. */
  if (stat(path, &properties) != 0) {
    return refuse_open(embedding, name);
  }
  if (!S_ISREG(properties.st_mode)) {
    return refuse_file(embedding, name, "is not a regular file");
  }
  FILE *file = fopen(path, "rb");
  char *buffer = malloc(JSON_TEXT_MAX + 2);
  if (!file || !buffer) {
    status = file ? error_set(embedding->error, STATUS_NO_MEMORY, NULL, "no memory for a file")
                  : refuse_open(embedding, name);
    goto done;
  }
  *size = fread(buffer, 1, JSON_TEXT_MAX + 1, file);
  if (ferror(file)) {
    status = refuse_file(embedding, name, "cannot be read to its end");
  } else if (*size > JSON_TEXT_MAX) {
    status = refuse_file(embedding, name, "is larger than 1 MiB, the most that a job may have");
  } else if (memchr(buffer, '\0', *size)) {
    status = refuse_file(embedding, name, "is no text in UTF-8: it has NUL characters");
  }
  if (status == STATUS_OK) {
    buffer[*size] = '\0';
    *text = buffer;
    buffer = NULL;
  }
done:
  free(buffer);
  if (file) {
    fclose(file);
  }
  return status;
}

/* The text as a JSON string. Text that is not in UTF-8 is taken for Latin-1, in which measuring
 * machines write degrees and micro signs. NULL when memory runs out. */
static json_t *text_value(const char *text, size_t size) {
  json_t *value = json_stringn(text, size);
  if (value) {
    return value;
  }
  char *wide = malloc(2 * size + 1);
  size_t length = 0;
  for (size_t i = 0; wide && i < size; i++) {
    unsigned char c = (unsigned char)text[i];
    if (c >= 0x80) {
      wide[length++] = (char)(0xC0 | (c >> 6));
      c = 0x80 | (c & 0x3F);
    }
    wide[length++] = (char)c;
  }
  value = wide ? json_stringn(wide, length) : NULL;
  free(wide);
  return value;
}

/* The triangles of a file as a binary one in base64, which is shorter than text. */
static enum status read_surface(struct embedding *embedding, const char *path, const char *name,
                                json_t **content) {
  struct stl stl;
  struct error *error = embedding->error;
  char quoted[160], *text = NULL;
  size_t size = 0, length = 0;
  enum status status = stl_load(path, &stl, error);
  text_quote(quoted, sizeof quoted, name);
  if (status == STATUS_NO_MEMORY) {
    return status;
  }
  if (status != STATUS_OK) {
    if (error) {
      error->status = STATUS_INVALID;
      error_carry(error, embedding->pointer.text, "%s: ", quoted);
    }
    return STATUS_INVALID;
  }
  if (stl.count > EMBED_TRIANGLES_MAX) {
    status =
        error_set(error, STATUS_INVALID, embedding->pointer.text,
                  "the surface %s has %d triangles\nat most %d, which fit into a job: simplify "
                  "it",
                  quoted, stl.count, EMBED_TRIANGLES_MAX);
  } else {
    unsigned char *data = stl_write(&stl, &size);
    text = data ? base64_encode(data, size, &length) : NULL;
    *content = text ? json_pack("{s:o}", "base64", json_stringn(text, length)) : NULL;
    status = *content ? STATUS_OK : STATUS_NO_MEMORY;
    free(data);
    free(text);
  }
  stl_release(&stl);
  return status;
}

/* The document of a base, its own files embedded. */
static enum status read_document(struct embedding *embedding, const char *path, const char *text,
                                 size_t size, int level, json_t **document) {
  struct error inner = {.status = STATUS_OK};
  char *folder = NULL;
  enum status status = json_text_read(text, size, document, &inner);
  if (status != STATUS_OK) {
    return error_set(embedding->error, status, embedding->pointer.text, "line %d of that file: %s",
                     inner.line, inner.message);
  }
  status = folder_of(path, &folder);
  if (status == STATUS_OK) {
    status = walk(embedding, *document, folder, level + 1);
  }
  if (status != STATUS_OK) {
    json_decref(*document);
    *document = NULL;
  }
  free(folder);
  return status;
}

/* ---- one place -------------------------------------------------------------------------- */

static bool ends_with(const char *text, const char *end) {
  size_t length = strlen(text), tail = strlen(end);
  return length >= tail && strcmp(text + length - tail, end) == 0;
}

/* Puts the content of the file `name` in the place `key` of `parent`. */
static enum status embed_one(struct embedding *embedding, json_t *parent, const struct slot *slot,
                             const char *name, const char *folder, int level) {
  if ((slot->content != CONTENT_DOCUMENT) == ends_with(name, ".json")) {
    return refuse_file(embedding, name, kinds[slot->content].refusal);
  }
  char *path = join_path(folder, name), *text = NULL;
  size_t size = 0;
  json_t *content = NULL;
  enum status status = path ? STATUS_OK : STATUS_NO_MEMORY;
  if (status == STATUS_OK && slot->content == CONTENT_SURFACE) {
    status = read_surface(embedding, path, name, &content);
  } else if (status == STATUS_OK) {
    status = read_file(embedding, path, name, &text, &size);
  }
  if (status == STATUS_OK && slot->content == CONTENT_TABLE) {
    content = json_pack("{s:o}", "csv", text_value(text, size));
  } else if (status == STATUS_OK && slot->content == CONTENT_DOCUMENT) {
    status = read_document(embedding, path, text, size, level, &content);
  }
  if (status == STATUS_OK && json_object_set_new(parent, slot->key, content) != 0) {
    status = STATUS_NO_MEMORY;
  }
  if (status == STATUS_NO_MEMORY) {
    error_set(embedding->error, status, NULL, "no memory for a file");
  }
  embedding->changed = true;
  free(text);
  free(path);
  return status;
}

static enum status look_at(struct embedding *embedding, json_t *parent, const struct slot *slot,
                           const char *folder, int level) {
  json_t *value = json_object_get(parent, slot->key);
  json_t *name = json_object_get(value, "file");
  size_t mark = json_pointer_key(&embedding->pointer, slot->key);
  enum status status = STATUS_OK;
  if (name) {
    size_t inner = json_pointer_key(&embedding->pointer, "file");
    if (!embedding->read) {
      status = error_set(
          embedding->error, STATUS_INVALID, embedding->pointer.text,
          "a file can be named on the command line only\nsend its content instead; \"pneulab-solve "
          "--embed JOB.json\" prints the job with the content of its files in their place");
    } else if (json_is_string(name) && json_object_size(value) == 1) {
      status = embed_one(embedding, parent, slot, json_string_value(name), folder, level);
    } else {
      status = error_set(embedding->error, STATUS_INVALID, embedding->pointer.text,
                         "this names no file\none string and nothing beside it\n\"%s\"",
                         kinds[slot->content].example);
    }
    json_pointer_pop(&embedding->pointer, inner);
  } else if (slot->content == CONTENT_DOCUMENT) {
    status = walk(embedding, value, folder, level + 1);
  }
  json_pointer_pop(&embedding->pointer, mark);
  return status;
}

/* Looks at all places of a slot below `parent`, to which the first `done` steps of the way lead. */
static enum status go(struct embedding *embedding, json_t *parent, const struct slot *slot,
                      int done, const char *folder, int level) {
  const char *step = slot->way[done], *name;
  bool each = step && strcmp(step, ANY) == 0;
  enum status status = STATUS_OK;
  json_t *value;
  if (json_is_array(parent)) {
    size_t index;
    json_array_foreach(parent, index, value) {
      size_t mark = json_pointer_index(&embedding->pointer, index);
      status = status == STATUS_OK ? go(embedding, value, slot, done, folder, level) : status;
      json_pointer_pop(&embedding->pointer, mark);
    }
    return status;
  }
  if (!step) {
    return look_at(embedding, parent, slot, folder, level);
  }
  json_object_foreach(parent, name, value) {
    if (each || strcmp(name, step) == 0) {
      size_t mark = json_pointer_key(&embedding->pointer, name);
      status = status == STATUS_OK ? go(embedding, value, slot, done + 1, folder, level) : status;
      json_pointer_pop(&embedding->pointer, mark);
    }
  }
  return status;
}

/* A base has no base, so the walk ends below it, whatever the files name. */
static enum status walk(struct embedding *embedding, json_t *document, const char *folder,
                        int level) {
  enum status status = STATUS_OK;
  for (size_t i = 0; level < EMBED_LEVELS && i < SLOTS && status == STATUS_OK; i++) {
    status = go(embedding, document, &slots[i], 0, folder, level);
  }
  return status;
}

/* ---- the whole document ----------------------------------------------------------------- */

enum status embed_files(const char *text, size_t size, const char *path, char **embedded,
                        size_t *length, struct error *error) {
  json_t *document = NULL;
  char *folder = NULL;
  struct embedding embedding = {.read = true, .error = error};
  enum status status = json_text_read(text, size, &document, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = folder_of(path, &folder);
  if (status == STATUS_OK) {
    status = walk(&embedding, document, folder, 0);
  }
  if (status == STATUS_OK) {
    *embedded = embedding.changed ? json_dumps(document, JSON_INDENT(2)) : strndup(text, size);
    *length = *embedded ? strlen(*embedded) : 0;
    status = *embedded ? STATUS_OK : STATUS_NO_MEMORY;
  } else if (error && status == STATUS_INVALID) {
    json_text_locate(text, size, error->pointer, &error->line, &error->column);
  }
  if (status == STATUS_NO_MEMORY) {
    error_set(error, status, NULL, "no memory for the document");
  }
  free(folder);
  json_decref(document);
  return status;
}

enum status embed_refuse(const json_t *document, struct error *error) {
  struct embedding embedding = {.read = false, .error = error};
  return walk(&embedding, (json_t *)document, NULL, 0);
}
