/* Bearer tokens as they are kept: DATA/tokens.json, mode 0600, replaced as a whole.
 *
 * A secret is "pneulab_" and 256 random bits in hexadecimal. Only its SHA-256 is stored. A slow
 * password hash would add nothing: it makes guessing a word costly, and nobody guesses 2^256. */
#ifndef PNEULAB_AUTH_TOKEN_FILE_H
#define PNEULAB_AUTH_TOKEN_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "server/base/caller.h"
#include "solver/base/error.h"

#define TOKEN_PREFIX "pneulab_"

enum {
  TOKEN_HASH_BYTES = 32,
  TOKEN_SECRET_SIZE = sizeof TOKEN_PREFIX + 64, /* with its NUL */
  TOKENS_MAX = 1000
};

struct token {
  char name[64]; /* 1 to 63 of [A-Za-z0-9._@-] */
  enum role role;
  unsigned char hash[TOKEN_HASH_BYTES];
  char created[32]; /* ISO 8601; when the secret was made */
};

struct token_list {
  struct token *tokens;
  size_t count;
};

/* The path of the file below a data directory; false when it is too long for `size` bytes. */
bool token_file_path(const char *data, char *path, size_t size);

/* Reads the file. *list is the caller's, to be cleared. STATUS_NOT_FOUND when there is none; other
 * errors name the file and what is wrong with it. */
enum status token_file_read(const char *data, struct token_list *list, struct error *error);

/* Replaces the file: the new one is on disk before it takes the name. It belongs to the owner of
 * the data directory, so that root can write it for the daemon's user. */
enum status token_file_write(const char *data, const struct token_list *list, struct error *error);

/* Frees the tokens and empties the list. */
void token_list_clear(struct token_list *list);

/* Adds a token with a new secret. STATUS_CONFLICT when the name is taken, STATUS_INVALID when it
 * is malformed. */
enum status token_list_add(struct token_list *list, const char *name, enum role role,
                           char secret[TOKEN_SECRET_SIZE], struct error *error);

/* Gives a token a new secret; the old one is void. STATUS_NOT_FOUND. */
enum status token_list_rotate(struct token_list *list, const char *name,
                              char secret[TOKEN_SECRET_SIZE], struct error *error);

/* Removes a token. STATUS_NOT_FOUND. */
enum status token_list_revoke(struct token_list *list, const char *name, struct error *error);

/* The SHA-256 of a secret. */
void token_hash(const char *secret, unsigned char hash[TOKEN_HASH_BYTES]);

#endif
