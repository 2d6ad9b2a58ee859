/* Content codings that a client takes (RFC 9110, section 12.5.3). */
#ifndef PNEULAB_HTTP_ENCODING_H
#define PNEULAB_HTTP_ENCODING_H

#include <stdbool.h>

/* Whether the value of an Accept-Encoding header, NULL when there was none, names the coding
 * ("gzip", "br"; in any case, or as "*") with a weight above zero. A name counts more than "*",
 * wherever it stands; what is malformed names nothing. */
bool encoding_accepted(const char *accept, const char *coding);

#endif
