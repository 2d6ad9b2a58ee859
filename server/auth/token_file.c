#include "server/auth/token_file.h"

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <limits.h>
#include <sha2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/file.h"
#include "solver/job/json.h"

static const char token_characters[] =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._@-";

bool token_file_path(const char *data, char *path, size_t size) {
  int length = snprintf(path, size, "%s/tokens.json", data);
  return length > 0 && (size_t)length < size;
}

void token_list_clear(struct token_list *list) {
  free(list->tokens);
  *list = (struct token_list){0};
}

void token_hash(const char *secret, unsigned char hash[TOKEN_HASH_BYTES]) {
  SHA2_CTX context;
  SHA256Init(&context);
  SHA256Update(&context, (const uint8_t *)secret, strlen(secret));
  SHA256Final(hash, &context);
}

static void hex_write(const unsigned char *bytes, size_t count, char *text) {
  for (size_t i = 0; i < count; i++) {
    snprintf(text + 2 * i, 3, "%02x", bytes[i]);
  }
}

static bool hash_parse(const char *text, unsigned char hash[TOKEN_HASH_BYTES]) {
  if (strlen(text) != 2 * TOKEN_HASH_BYTES || text[strspn(text, "0123456789abcdef")] != '\0') {
    return false;
  }
  for (size_t i = 0; i < TOKEN_HASH_BYTES; i++) {
    char digits[3] = {text[2 * i], text[2 * i + 1], '\0'};
    hash[i] = (unsigned char)strtoul(digits, NULL, 16);
  }
  return true;
}

static bool name_is_allowed(const char *name) {
  size_t length = strlen(name);
  return length > 0 && length < sizeof((struct token *)0)->name &&
         strspn(name, token_characters) == length;
}

static struct token *list_find(const struct token_list *list, const char *name) {
  for (size_t i = 0; i < list->count; i++) {
    if (strcmp(list->tokens[i].name, name) == 0) {
      return &list->tokens[i];
    }
  }
  return NULL;
}

/* Room for one more token, not counted yet; NULL when there is none. */
static struct token *list_grow(struct token_list *list) {
  if (list->count >= TOKENS_MAX) {
    return NULL;
  }
  struct token *grown = realloc(list->tokens, (list->count + 1) * sizeof *grown);
  if (!grown) {
    return NULL;
  }
  list->tokens = grown;
  grown[list->count] = (struct token){0};
  return &grown[list->count];
}

/* ---- the file ---------------------------------------------------------------------------- */

/* A member of an entry, "" when it is no text. */
static const char *entry_text(const json_t *entry, const char *key) {
  const char *text = json_string_value(json_object_get(entry, key));
  return text ? text : "";
}

/* Adds what an entry describes. STATUS_SYNTAX when it describes no token, STATUS_NO_MEMORY. Unlike
 * json_unpack, this takes no memory but for the token. */
static enum status token_read(const json_t *entry, struct token_list *list) {
  const json_t *created = json_object_get(entry, "created");
  const char *name = entry_text(entry, "name");
  struct token *token = list_grow(list);
  if (!token && list->count < TOKENS_MAX) {
    return STATUS_NO_MEMORY;
  }
  if (!token || json_object_size(entry) != 4 || !name_is_allowed(name) || list_find(list, name) ||
      !role_parse(entry_text(entry, "role"), &token->role) ||
      !hash_parse(entry_text(entry, "sha256"), token->hash) || !json_is_string(created) ||
      json_string_length(created) >= sizeof token->created) {
    return STATUS_SYNTAX;
  }
  strcpy(token->name, name);
  strcpy(token->created, json_string_value(created));
  list->count++;
  return STATUS_OK;
}

static enum status tokens_parse(const char *text, size_t size, struct token_list *list) {
  json_t *root = NULL;
  enum status status = json_text_read(text, size, &root, NULL);
  const json_t *tokens = json_object_get(root, "tokens");
  if (status == STATUS_OK && !json_is_array(tokens)) {
    status = STATUS_SYNTAX;
  }
  for (size_t i = 0; status == STATUS_OK && i < json_array_size(tokens); i++) {
    status = token_read(json_array_get(tokens, i), list);
  }
  json_decref(root);
  return status;
}

enum status token_file_read(const char *data, struct token_list *list, struct error *error) {
  char path[PATH_MAX];
  char *text = NULL;
  size_t size = 0;
  *list = (struct token_list){0};
  if (!token_file_path(data, path, sizeof path)) {
    return error_set(error, STATUS_TOO_LARGE, NULL, "The path of the data directory is too long.");
  }
  enum status status = file_read(path, JSON_TEXT_MAX, &text, &size, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = tokens_parse(text, size, list);
  if (status != STATUS_OK) {
    token_list_clear(list);
  }
  if (status == STATUS_NO_MEMORY) {
    error_set(error, status, NULL, "No memory to read %s.", path);
  } else if (status != STATUS_OK) {
    status = error_set(error, STATUS_SYNTAX, NULL,
                       "%s is damaged: expected {\"tokens\": [{\"name\", \"role\", \"sha256\", "
                       "\"created\"}, ...]} with names that differ, as `pneulabd token add` "
                       "writes it. Restore it, or remove it and make new tokens.",
                       path);
  }
  free(text);
  return status;
}

static json_t *list_json(const struct token_list *list) {
  json_t *tokens = json_array();
  for (size_t i = 0; i < list->count; i++) {
    const struct token *token = &list->tokens[i];
    char hash[2 * TOKEN_HASH_BYTES + 1];
    hex_write(token->hash, TOKEN_HASH_BYTES, hash);
    json_array_append_new(tokens, json_pack("{s:s, s:s, s:s, s:s}", "name", token->name, "role",
                                            role_word(token->role), "sha256", hash, "created",
                                            token->created));
  }
  return json_pack("{s:o}", "tokens", tokens);
}

/* Writes the text so that it is on disk and as private as it has to be. */
static bool private_write(const char *data, const char *path, const char *text) {
  struct stat owner;
  size_t size = strlen(text);
  unlink(path); /* what a writer that was killed left behind */
  int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
  bool written = fd >= 0 && write(fd, text, size) == (ssize_t)size && stat(data, &owner) == 0 &&
                 (geteuid() != 0 || fchown(fd, owner.st_uid, owner.st_gid) == 0) && fsync(fd) == 0;
  int reason = errno;
  if (fd >= 0) {
    close(fd);
  }
  errno = reason;
  return written;
}

enum status token_file_write(const char *data, const struct token_list *list, struct error *error) {
  char path[PATH_MAX], draft[PATH_MAX];
  json_t *root = list_json(list);
  char *text = root ? json_dumps(root, JSON_INDENT(2)) : NULL;
  enum status status = STATUS_OK;
  int length = snprintf(draft, sizeof draft, "%s/tokens.json.new", data);
  if (!text || length < 0 || (size_t)length >= sizeof draft ||
      !token_file_path(data, path, sizeof path)) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "No memory to write the tokens.");
  } else if (!private_write(data, draft, text) || rename(draft, path) != 0) {
    status =
        error_set(error, STATUS_IO, NULL, "Cannot write %s: %s.", path, strerrordesc_np(errno));
    unlink(draft);
  } else {
    int directory = open(data, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory >= 0) {
      fsync(directory); /* the new name, too, outlives a loss of power */
      close(directory);
    }
  }
  free(text);
  json_decref(root);
  return status;
}

/* ---- changes ----------------------------------------------------------------------------- */

static enum status token_renew(struct token *token, char secret[TOKEN_SECRET_SIZE],
                               struct error *error) {
  unsigned char random[32];
  if (getrandom(random, sizeof random, 0) != (ssize_t)sizeof random) {
    return error_set(error, STATUS_IO, NULL, "The system gives no random numbers: %s.",
                     strerrordesc_np(errno));
  }
  strcpy(secret, TOKEN_PREFIX);
  hex_write(random, sizeof random, secret + sizeof TOKEN_PREFIX - 1);
  token_hash(secret, token->hash);
  clock_format(clock_unix_ms(), token->created);
  explicit_bzero(random, sizeof random);
  return STATUS_OK;
}

static enum status list_require(const struct token_list *list, const char *name,
                                struct token **token, struct error *error) {
  *token = list_find(list, name);
  if (!*token) {
    return error_set(error, STATUS_NOT_FOUND, NULL,
                     "There is no token %s; see pneulabd token list.", name);
  }
  return STATUS_OK;
}

enum status token_list_add(struct token_list *list, const char *name, enum role role,
                           char secret[TOKEN_SECRET_SIZE], struct error *error) {
  if (!name_is_allowed(name)) {
    return error_set(error, STATUS_INVALID, NULL,
                     "\"%.80s\" is no name for a token: expected 1 to 63 letters, digits or "
                     "any of ._@- , for example alice@lab.",
                     name);
  }
  if (list_find(list, name)) {
    return error_set(error, STATUS_CONFLICT, NULL,
                     "There is a token %s already; `pneulabd token rotate %s` gives it a new "
                     "secret.",
                     name, name);
  }
  struct token *token = list_grow(list);
  if (!token) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "There are at most %d tokens.", TOKENS_MAX);
  }
  strcpy(token->name, name);
  token->role = role;
  enum status status = token_renew(token, secret, error);
  list->count += status == STATUS_OK;
  return status;
}

enum status token_list_rotate(struct token_list *list, const char *name,
                              char secret[TOKEN_SECRET_SIZE], struct error *error) {
  struct token *token;
  enum status status = list_require(list, name, &token, error);
  return status == STATUS_OK ? token_renew(token, secret, error) : status;
}

enum status token_list_revoke(struct token_list *list, const char *name, struct error *error) {
  struct token *token;
  enum status status = list_require(list, name, &token, error);
  if (status == STATUS_OK) {
    size_t at = (size_t)(token - list->tokens);
    memmove(token, token + 1, (list->count - at - 1) * sizeof *token);
    list->count--;
  }
  return status;
}
