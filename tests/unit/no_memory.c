#include "tests/unit/no_memory.h"

#include <errno.h>
#include <sqlite3.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

static atomic_long left; /* allocations until the one that fails */
static atomic_bool armed, failed, all;
static sqlite3_mem_methods methods;

static bool fails(void) {
  if (!atomic_load(&armed)) {
    return false;
  }
  long now = atomic_fetch_sub(&left, 1);
  bool failing = now == 1 || (now < 1 && atomic_load(&all));
  if (failing) {
    atomic_store(&failed, true);
    errno = ENOMEM;
  }
  return failing;
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
char *__real_strdup(const char *text);
char *__real_strndup(const char *text, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
char *__wrap_strdup(const char *text);
char *__wrap_strndup(const char *text, size_t size);

void *__wrap_malloc(size_t size) {
  return fails() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size) {
  return fails() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *old, size_t size) {
  return fails() ? NULL : __real_realloc(old, size);
}

char *__wrap_strdup(const char *text) {
  return fails() ? NULL : __real_strdup(text);
}

char *__wrap_strndup(const char *text, size_t size) {
  return fails() ? NULL : __real_strndup(text, size);
}

static void *sqlite_malloc(int size) {
  return fails() ? NULL : methods.xMalloc(size);
}

static void *sqlite_realloc(void *old, int size) {
  return fails() ? NULL : methods.xRealloc(old, size);
}

void no_memory_install(void) {
  sqlite3_config(SQLITE_CONFIG_GETMALLOC, &methods);
  sqlite3_mem_methods own = methods;
  own.xMalloc = sqlite_malloc;
  own.xRealloc = sqlite_realloc;
  sqlite3_config(SQLITE_CONFIG_MALLOC, &own);
}

void no_memory_arm(long first, bool onwards) {
  atomic_store(&left, first);
  atomic_store(&all, onwards);
  atomic_store(&failed, false);
  atomic_store(&armed, true);
}

bool no_memory_disarm(void) {
  atomic_store(&armed, false);
  return atomic_load(&failed);
}
