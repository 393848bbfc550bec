/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Requests of the live view: who is answered, and with what. */
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "live/internal.h"

/* The header fields that decide, each given once at most. Texts end with NUL. */
typedef struct request {
  char *method, *target;
  const char *host, *origin, *upgrade, *connection, *key, *version;
  const char *length, *transfer;
} request;

typedef enum reading { READ_WELL, MALFORMED, REPEATED } reading;

/* ---- reading --------------------------------------------------------------------------------- */

/* The text up to the mark, which becomes its end; *rest begins behind it. NULL without a mark. */
static char *cut_off(char **rest, const char *mark) {
  char *text = *rest, *end = strstr(text, mark);
  if (!end)
    return NULL;
  *end = 0;
  *rest = end + strlen(mark);
  return text;
}

static reading read_field(request *out, char *line) {
  static const struct {
    const char *name;
    size_t place;
  } known[] = {{"Host", offsetof(request, host)},
               {"Origin", offsetof(request, origin)},
               {"Upgrade", offsetof(request, upgrade)},
               {"Connection", offsetof(request, connection)},
               {"Sec-WebSocket-Key", offsetof(request, key)},
               {"Sec-WebSocket-Version", offsetof(request, version)},
               {"Content-Length", offsetof(request, length)},
               {"Transfer-Encoding", offsetof(request, transfer)}};
  char *value = line, *name = cut_off(&value, ":");
  if (!name || !*name || strpbrk(name, " \t"))
    return MALFORMED;
  value += strspn(value, " \t");
  size_t length = strlen(value);
  while (length > 0 && strchr(" \t", value[length - 1]))
    value[--length] = 0;
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    if (strcasecmp(name, known[i].name) != 0)
      continue;
    const char **place = (const char **)(void *)((char *)out + known[i].place);
    if (*place)
      return REPEATED;
    *place = value;
  }
  return READ_WELL;
}

static reading read_request(request *out, char *head, size_t length) {
  *out = (request){0};
  /* No control characters but tabs, and the ends of lines, which are whole. */
  for (size_t i = 0; i < length; i++)
    if (head[i] == '\r'   ? i + 1 == length || head[i + 1] != '\n'
        : head[i] == '\n' ? i == 0 || head[i - 1] != '\r'
                          : (unsigned char)head[i] < ' ' && head[i] != '\t')
      return MALFORMED;
  head[length - 2] = 0; /* the empty line, after the end of the last one */
  char *rest = head, *line = cut_off(&rest, "\r\n");
  out->method = line ? cut_off(&line, " ") : NULL;
  out->target = out->method ? cut_off(&line, " ") : NULL;
  if (!out->target || (strcmp(line, "HTTP/1.1") != 0 && strcmp(line, "HTTP/1.0") != 0))
    return MALFORMED;
  reading how = READ_WELL;
  while (how == READ_WELL && *rest) {
    line = cut_off(&rest, "\r\n");
    how = line ? read_field(out, line) : MALFORMED;
  }
  return how;
}

/* Whether a list such as "keep-alive, Upgrade" has a word. */
static bool lists(const char *list, const char *word) {
  size_t length = strlen(word);
  while (list && *list) {
    list += strspn(list, ", \t");
    size_t n = strcspn(list, ", \t");
    if (n == length && strncasecmp(list, word, n) == 0)
      return true;
    list += n;
  }
  return false;
}

/* ---- who may ask ----------------------------------------------------------------------------- */

/* Host is one of our two names; a browser that was led here by another name, or a page of another
 * origin, is not answered. */
static bool trusted(const lbw_live_server *server, const request *asked) {
  if (!asked->host)
    return false;
  char numeric[40], named[40];
  snprintf(numeric, sizeof numeric, "127.0.0.1:%d", server->port);
  snprintf(named, sizeof named, "localhost:%d", server->port);
  if (strcmp(asked->host, numeric) != 0 && strcmp(asked->host, named) != 0)
    return false;
  static const char scheme[] = "http://";
  const char *origin = asked->origin;
  return !origin || (strncmp(origin, scheme, sizeof scheme - 1) == 0 &&
                     strcmp(origin + sizeof scheme - 1, asked->host) == 0);
}

/* What stands behind /TOKEN/, or NULL. Takes as long whatever the guess is. */
static const char *path_below_token(const lbw_live_server *server, const char *target) {
  if (strlen(target) < 2 + LIVE_TOKEN_DIGITS)
    return NULL;
  unsigned char difference = (unsigned char)(target[0] ^ '/');
  for (int i = 0; i < LIVE_TOKEN_DIGITS; i++)
    difference |= (unsigned char)(target[1 + i] ^ server->token[i]);
  difference |= (unsigned char)(target[1 + LIVE_TOKEN_DIGITS] ^ '/');
  return difference == 0 ? target + 2 + LIVE_TOKEN_DIGITS : NULL;
}

/* ---- answers --------------------------------------------------------------------------------- */

/* Bytes as printf makes them. */
__attribute__((format(printf, 1, 2))) static live_outgoing *new_text(const char *format, ...) {
  va_list list;
  va_start(list, format);
  int length = vsnprintf(NULL, 0, format, list);
  va_end(list);
  size_t capacity = (size_t)(length < 0 ? 0 : length) + 1;
  live_outgoing *out = (live_outgoing *)bw_alloc(NULL, 1, sizeof *out + capacity);
  if (!out)
    return NULL;
  *out = (live_outgoing){.data = out->bytes, .length = capacity - 1};
  va_start(list, format);
  vsnprintf(out->bytes, capacity, format, list);
  va_end(list);
  return out;
}

static bool queue(lbw_live_server *server, live_connection *connection, live_outgoing *out) {
  if (!out)
    return false;
  pthread_mutex_lock(&server->lock);
  live_enqueue(connection, out);
  pthread_mutex_unlock(&server->lock);
  return true;
}

/* Queues the head of an answer, and `text` as its body. */
static bool queue_head(lbw_live_server *server, live_connection *connection, int code,
                       const char *word, const char *mime, const char *download, size_t length,
                       const char *text) {
  connection->stage = LIVE_ANSWER;
  /* The address holds the token, so no referrer; the page loads nothing but its own files and its
   * own socket (whose scheme 'self' does not cover in every browser). */
  return queue(server, connection,
               new_text("HTTP/1.1 %d %s\r\n"
                        "Content-Type: %s\r\n"
                        "Content-Length: %zu\r\n"
                        "Connection: close\r\n"
                        "Cache-Control: no-store\r\n"
                        "X-Content-Type-Options: nosniff\r\n"
                        "X-Frame-Options: DENY\r\n"
                        "Referrer-Policy: no-referrer\r\n"
                        "Cross-Origin-Opener-Policy: same-origin\r\n"
                        "Cross-Origin-Resource-Policy: same-origin\r\n"
                        "Content-Security-Policy: default-src 'none'; script-src 'self'; "
                        "style-src 'unsafe-inline'; img-src 'self' data:; "
                        "connect-src 'self' ws://127.0.0.1:%d ws://localhost:%d; base-uri 'none'; "
                        "form-action 'none'; frame-ancestors 'none'\r\n"
                        "%s%s%s\r\n%s",
                        code, word, mime, length, server->port, server->port,
                        download[0] ? "Content-Disposition: attachment; filename=\"" : "", download,
                        download[0] ? "\"\r\n" : "", text));
}

bool live_refuse(lbw_live_server *server, live_connection *connection, int code, const char *word) {
  char text[64];
  int length = snprintf(text, sizeof text, "%s\n", word);
  return queue_head(server, connection, code, word, "text/plain; charset=utf-8", "", (size_t)length,
                    text);
}

/* The content is not copied: it belongs to the page, which is retained until it is sent. */
static bool queue_content(lbw_live_server *server, live_connection *connection, live_page *page) {
  live_outgoing *out = new_text("%s", "");
  if (!out)
    return false;
  bw_retain(page);
  out->page = page;
  out->data = page->content;
  out->length = page->length;
  return queue(server, connection, out);
}

static bool send_page(lbw_live_server *server, live_connection *connection, const char *path,
                      bool body) {
  live_page *page = live_find_page(server, path);
  if (!page)
    return live_refuse(server, connection, 404, "Not Found");
  bool ok =
      queue_head(server, connection, 200, "OK", page->mime, page->download, page->length, "") &&
      (!body || page->length == 0 || queue_content(server, connection, page));
  bw_release(page);
  return ok;
}

static bool agree(lbw_live_server *server, live_connection *connection, const request *asked) {
  char accept[LIVE_ACCEPT_BYTES];
  if (!lists(asked->upgrade, "websocket") || !lists(asked->connection, "upgrade") ||
      !asked->version || strcmp(asked->version, "13") != 0)
    return live_refuse(server, connection, 426, "Upgrade Required");
  if (!asked->key || !live_accept_key(asked->key, accept))
    return live_refuse(server, connection, 400, "Bad Request");
  if (!queue(server, connection,
             new_text("HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
                      "Connection: Upgrade\r\nSec-WebSocket-Accept: %s\r\n\r\n",
                      accept)))
    return false;
  live_admit(server, connection);
  return true;
}

/* POST /TOKEN/upload?QUERY with a body whose length is given. */
static bool accept_upload(lbw_live_server *server, live_connection *connection,
                          const request *asked, const char *query) {
  if (asked->transfer || !asked->length)
    return live_refuse(server, connection, 411, "Length Required");
  size_t digits = strspn(asked->length, "0123456789");
  if (digits == 0 || digits > 15 || asked->length[digits] || strspn(asked->length, "0") == digits)
    return live_refuse(server, connection, 400, "Bad Request");
  int64_t length = strtoll(asked->length, NULL, 10);
  if (length > server->options.upload_bytes)
    return live_refuse(server, connection, 413, "Content Too Large");
  int code = live_begin_upload(server, connection, query, (size_t)length);
  if (code)
    return live_refuse(server, connection, code, "Service Unavailable");
  connection->stage = LIVE_BODY;
  return true;
}

bool live_answer(lbw_live_server *server, live_connection *connection, char *head, size_t length) {
  request asked;
  reading how = read_request(&asked, head, length);
  if (how == MALFORMED)
    return live_refuse(server, connection, 400, "Bad Request");
  if (how == REPEATED || !trusted(server, &asked))
    return live_refuse(server, connection, 403, "Forbidden");
  char *query = asked.target + strcspn(asked.target, "?#");
  if (*query)
    *query++ = 0;
  const char *path = path_below_token(server, asked.target);
  if (!path)
    return live_refuse(server, connection, 404, "Not Found");
  connection->shown = true;
  if (strcmp(asked.method, "POST") == 0 && server->options.upload_bytes > 0 &&
      strcmp(path, "upload") == 0)
    return accept_upload(server, connection, &asked, query);
  bool get = strcmp(asked.method, "GET") == 0;
  if (!get && strcmp(asked.method, "HEAD") != 0)
    return live_refuse(server, connection, 405, "Method Not Allowed");
  if (strcmp(path, "socket") == 0)
    return get ? agree(server, connection, &asked)
               : live_refuse(server, connection, 426, "Upgrade Required");
  return send_page(server, connection, path, get);
}
