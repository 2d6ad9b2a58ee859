/* Bytes as text: base64 (RFC 4648, section 4). */
#ifndef PNEULAB_BASE_BASE64_H
#define PNEULAB_BASE_BASE64_H

#include <stdbool.h>
#include <stddef.h>

/* The text of `size` bytes, NUL-terminated, of *length characters; the caller frees it. NULL when
 * memory runs out. */
char *base64_encode(const void *bytes, size_t size, size_t *length);

/* Decodes `length` characters of text into bytes, which has room for 3 (length / 4); white space is
 * passed over. Returns false for anything that is not base64; else *size is the number of bytes. */
bool base64_decode(const char *text, size_t length, unsigned char *bytes, size_t *size);

#endif
