#include <stdio.h>
#include <string.h>

#include "server/http/access.h"
#include "server/http/handlers.h"

enum { NEXT_MAX = 120 };

/* Where to go after signing in: a path of this server, nothing that leads elsewhere. */
static const char *next_page(const struct request *request) {
  static const char allowed[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"
                                "-._~/?=&,";
  const char *next = url_query(&request->url, "next");
  bool fine = next && next[0] == '/' && next[1] != '/' && strlen(next) < NEXT_MAX &&
              next[strspn(next, allowed)] == '\0';
  return fine ? next : "/";
}

/* The value of a field of a form, decoded where it stands; NULL when it is missing. */
static const char *form_value(struct request *request, const char *name) {
  char *rest = request->body;
  while (rest) {
    char *value = strsep(&rest, "&");
    const char *key = strsep(&value, "=");
    if (value && strcmp(key, name) == 0) {
      return url_decode(value, true) ? value : NULL;
    }
  }
  return NULL;
}

static void see_other(struct reply *reply, const char *format, const char *where) {
  static const char text[] = "See the Location.\n";
  reply->status = 303;
  reply_static(reply, "text/plain; charset=utf-8", text, sizeof text - 1);
  reply_header(reply, "Location", format, where);
}

static void set_cookie(const struct request *request, struct reply *reply, const char *secret) {
  reply_header(reply, "Set-Cookie", "%s=%s; Path=/; HttpOnly; SameSite=Strict%s%s",
               access_cookie(request), secret, access_is_secure(request) ? "; Secure" : "",
               secret[0] ? "" : "; Max-Age=0");
}

/* Back to the form, which then shows that the token was wrong. */
static void sign_in_again(const char *next, struct reply *reply) {
  char where[3 * NEXT_MAX], *to = where;
  for (; *next; next++) {
    if (*next == '&') {
      to = stpcpy(to, "%26");
    } else {
      *to++ = *next;
    }
  }
  *to = '\0';
  see_other(reply, "/sign-in?next=%s#failed", where);
}

void session_open(struct request *request, struct reply *reply) {
  struct caller caller;
  char secret[TOKEN_SECRET_SIZE] = "";
  const char *value = form_value(request, "token");
  if (value) { /* spaces around it come with copying */
    value += strspn(value, " \t");
    snprintf(secret, sizeof secret, "%.*s", (int)strcspn(value, " \t"), value);
  }
  if (tokens_check(request->service->access->tokens, secret, &caller)) {
    see_other(reply, "%s", next_page(request));
    set_cookie(request, reply, secret);
  } else if (access_note_failure(request, reply)) {
    sign_in_again(next_page(request), reply);
  }
}

void session_close(struct request *request, struct reply *reply) {
  see_other(reply, "%s", "/sign-in");
  set_cookie(request, reply, "");
}

void session_caller(struct request *request, struct reply *reply) {
  const struct caller *caller = &request->caller;
  reply_json(reply, 200,
             json_pack("{s:s, s:s}", "name", caller->name, "role", role_word(caller->role)));
}
