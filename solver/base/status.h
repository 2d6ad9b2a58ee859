/* Status codes of every function that can fail. */
#ifndef PNEULAB_BASE_STATUS_H
#define PNEULAB_BASE_STATUS_H

#include <stdbool.h>

/* X(name, word, sentence): the word is the stable reason code written into
 * results and HTTP problem documents. */
#define STATUS_LIST(X)                                                                             \
  X(OK, "ok", "no error")                                                                          \
  X(INVALID, "invalid_job", "the input breaks a rule of the job format")                           \
  X(SYNTAX, "syntax_error", "the text is not well-formed JSON")                                    \
  X(GEOMETRY, "impossible_geometry", "the described body cannot exist")                            \
  X(NOT_FOUND, "not_found", "the named thing does not exist")                                      \
  X(CONFLICT, "conflict", "the request does not fit the present state")                            \
  X(TOO_LARGE, "too_large", "a size limit was exceeded")                                           \
  X(NO_MEMORY, "no_memory", "memory ran out")                                                      \
  X(IO, "io_error", "reading or writing failed")                                                   \
  X(NO_SPACE, "no_space", "the disk is full")                                                      \
  X(BUSY, "database_busy", "another program holds the database")                                   \
  X(DAMAGED, "database_damaged", "the database is damaged")                                        \
  X(DIVERGED, "diverged", "the iteration did not converge")                                        \
  X(INVERTED, "inverted_element", "an element turned inside out")                                  \
  X(CONTACT, "contact_cycling", "the contact did not settle")                                      \
  X(UNSTABLE, "material_instability", "the material law lost its stability")                       \
  X(STEP_MINIMUM, "step_below_minimum", "the load step fell below its minimum")                    \
  X(LIMIT_POINT, "limit_point", "the load passed a limit point of the equilibrium path")           \
  X(UNSTABLE_PATH, "loss_of_stability",                                                            \
    "the equilibrium loses its stability: it would snap or wrinkle")                               \
  X(CHATTERING, "chattering", "guards send the state to and fro at one time")                      \
  X(ZENO, "zeno", "infinitely many switches accumulate before a finite time")                      \
  X(EVENTS, "too_many_events", "more switches were made than are followed")                        \
  X(TIMEOUT, "timeout", "the time limit was reached")                                              \
  X(CANCELLED, "cancelled", "the work was cancelled")                                              \
  X(INTERNAL, "internal_error", "an invariant of the program does not hold")

enum status {
#define STATUS_ENUM(name, word, sentence) STATUS_##name,
  STATUS_LIST(STATUS_ENUM)
#undef STATUS_ENUM
      STATUS_COUNT
};

/* Whether another attempt is of no use: the time is over, the work was cancelled, or there is no
 * memory. */
bool status_is_final(enum status status);

/* Stable machine-readable word of a status ("limit_point"). Static storage. */
const char *status_word(enum status status);
/* One-sentence meaning of a status. Static storage. */
const char *status_sentence(enum status status);

#endif
