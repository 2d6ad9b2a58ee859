/* The tokens that are valid now, for all threads; follows the file of token_file.h. */
#ifndef PNEULAB_AUTH_TOKENS_H
#define PNEULAB_AUTH_TOKENS_H

#include <stdbool.h>

#include "server/auth/token_file.h"

struct tokens;

/* Reads the tokens of the data directory. A token is needed when `always`, or once the file
 * exists, and from then on until the end of the process. A damaged file is an error. The caller
 * owns *tokens. */
enum status tokens_create(const char *data, bool always, struct tokens **tokens,
                          struct error *error);
void tokens_destroy(struct tokens *tokens);

/* Reads the file again if it has changed. A file that has vanished leaves no valid token; a
 * damaged one leaves those that were valid, and is logged. To be called every second or so. */
void tokens_refresh(struct tokens *tokens);

/* Whether a request needs a token. */
bool tokens_required(struct tokens *tokens);

/* Finds whose secret it is: fills *caller and returns true. The time it takes tells nothing about
 * the stored hashes. */
bool tokens_check(struct tokens *tokens, const char *secret, struct caller *caller);

#endif
