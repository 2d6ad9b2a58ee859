/* Small helpers for text that came from outside and goes into messages. */
#ifndef PNEULAB_BASE_TEXT_H
#define PNEULAB_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* Longest prefix of `text` of at most `limit` bytes that does not cut a UTF-8 character.
 * Returns its length in bytes. */
size_t text_prefix(const char *text, size_t limit);

/* Length of the longest prefix of `size` bytes that is valid UTF-8. */
size_t text_valid(const char *text, size_t size);

/* Replaces every byte of `text` that is not part of a valid UTF-8 character by '?'. */
void text_repair(char *text);

/* Writes `text` in double quotes into `out` (`size` >= 8 bytes), shortened with "..." to what
 * fits, control characters replaced by '?'. Returns `out`. */
const char *text_quote(char *out, size_t size, const char *text);

/* Whether one of the `words` (in lower case, ended by NULL) occurs in `text`, upper and lower case
 * taken as equal. */
bool text_mentions(const char *text, const char *const *words);

/* Number of insertions, deletions, replacements and swaps of neighbours that turn `a` into
 * `b`, upper and lower case taken as equal. Texts over 64 bytes are not compared: the answer
 * is then SIZE_MAX. */
size_t text_distance(const char *a, const char *b);

/* The entry of `words` nearest to `text`, or NULL when none is near enough to be meant
 * (more than a third of its letters differ). The pointer is the caller's own. */
const char *text_nearest(const char *text, const char *const *words, size_t count);

#endif
