/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The server's life, the pages that it serves, and who may ask for them. Clients: live_client.c. */
#include <errno.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "live_internal.h"

enum { WORKERS_BESIDE_CLIENTS = 12 };

void lbw_live_defaults(lbw_live_options *options) {
  *options = (lbw_live_options){.clients = 8,
                                .message_bytes = 64 << 10,
                                .queue_bytes = (int64_t)64 << 20,
                                .queue_messages = 256};
}

int lbw_live_port(const lbw_live_server *server) {
  return server->port;
}

const char *lbw_live_token(const lbw_live_server *server) {
  return server->token;
}

/* ---- pages ----------------------------------------------------------------------------------- */

static void destroy_page(void *object) {
  live_page *page = (live_page *)object;
  bw_free(page->content);
  bw_free(page->text);
  bw_free(page);
}

static const bw_kind page_kind = {"live page", destroy_page, NULL};

/* The three texts of a page in one block. */
static bool name_page(bw_context *context, live_page *page, const char *path, const char *mime,
                      const char *download) {
  size_t a = strlen(path) + 1, b = strlen(mime) + 1, c = strlen(download) + 1;
  page->text = BW_NEW(context, char, a + b + c);
  if (!page->text)
    return false;
  page->path = (char *)memcpy(page->text, path, a);
  page->mime = (char *)memcpy(page->text + a, mime, b);
  page->download = (char *)memcpy(page->text + a + b, download, c);
  return true;
}

bw_status lbw_live_serve(bw_context *context, lbw_live_server *server, const char *path,
                         const char *mime, const char *download, const void *bytes, size_t length) {
  live_page *page = BW_NEW0(context, live_page, 1);
  if (!page)
    return BW_MEMORY;
  bw_object_init(page, &page_kind);
  page->length = length;
  page->content = BW_NEW(context, char, length);
  if (!page->content || !name_page(context, page, path, mime, download ? download : "")) {
    bw_release(page);
    return BW_MEMORY;
  }
  memcpy(page->content, bytes, length);
  pthread_mutex_lock(&server->lock);
  live_page **place = &server->pages, *old = NULL;
  while (*place && strcmp((*place)->path, path) != 0)
    place = &(*place)->next;
  if (*place) {
    old = *place;
    page->next = old->next;
  }
  *place = page;
  pthread_mutex_unlock(&server->lock);
  bw_release(old);
  return BW_OK;
}

/* The page at a path, retained: it may be replaced while it is being sent. */
static live_page *find_page(lbw_live_server *server, const char *path) {
  pthread_mutex_lock(&server->lock);
  live_page *page = server->pages;
  while (page && strcmp(page->path, path) != 0)
    page = page->next;
  bw_retain(page);
  pthread_mutex_unlock(&server->lock);
  return page;
}

/* ---- answers --------------------------------------------------------------------------------- */

static void write_head(struct mg_connection *connection, int code, const char *word,
                       const char *mime, size_t length) {
  const lbw_live_server *server = (const lbw_live_server *)mg_get_user_context_data(connection);
  /* The address holds the token, so no referrer; the page loads nothing but its own files and its
   * own socket (whose scheme 'self' does not cover in every browser). */
  mg_printf(connection,
            "HTTP/1.1 %d %s\r\n"
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
            "form-action 'none'; frame-ancestors 'none'\r\n",
            code, word, mime, length, server->port, server->port);
}

static int answer(struct mg_connection *connection, int code, const char *word) {
  write_head(connection, code, word, "text/plain; charset=utf-8", strlen(word) + 1);
  mg_printf(connection, "\r\n%s\n", word);
  return code;
}

static int send_page(struct mg_connection *connection, const live_page *page, bool body) {
  write_head(connection, 200, "OK", page->mime, page->length);
  if (page->download[0])
    mg_printf(connection, "Content-Disposition: attachment; filename=\"%s\"\r\n", page->download);
  mg_printf(connection, "\r\n");
  if (body && page->length > 0)
    mg_write(connection, page->content, page->length);
  return 200;
}

/* ---- who may ask ----------------------------------------------------------------------------- */

/* Host is one of our two names, given once; a browser that was led here by another name, or a page
 * of another origin, is not answered. */
static bool trusted(const lbw_live_server *server, const struct mg_request_info *request) {
  const char *host = NULL, *origin = NULL;
  for (int i = 0; i < request->num_headers; i++) {
    const struct mg_header *header = &request->http_headers[i];
    const char **place = mg_strcasecmp(header->name, "Host") == 0     ? &host
                         : mg_strcasecmp(header->name, "Origin") == 0 ? &origin
                                                                      : NULL;
    if (!place)
      continue;
    if (*place)
      return false;
    *place = header->value;
  }
  if (!host)
    return false;
  char numeric[40], named[40];
  snprintf(numeric, sizeof numeric, "127.0.0.1:%d", server->port);
  snprintf(named, sizeof named, "localhost:%d", server->port);
  if (strcmp(host, numeric) != 0 && strcmp(host, named) != 0)
    return false;
  static const char scheme[] = "http://";
  return !origin || (strncmp(origin, scheme, sizeof scheme - 1) == 0 &&
                     strcmp(origin + sizeof scheme - 1, host) == 0);
}

/* What stands behind /TOKEN/, or NULL. Takes as long whatever the guess is. */
static const char *path_below_token(const lbw_live_server *server, const char *uri) {
  if (!uri || strlen(uri) < 2 + LIVE_TOKEN_DIGITS)
    return NULL;
  unsigned char difference = (unsigned char)(uri[0] ^ '/');
  for (int i = 0; i < LIVE_TOKEN_DIGITS; i++)
    difference |= (unsigned char)(uri[1 + i] ^ server->token[i]);
  difference |= (unsigned char)(uri[1 + LIVE_TOKEN_DIGITS] ^ '/');
  return difference == 0 ? uri + 2 + LIVE_TOKEN_DIGITS : NULL;
}

/* Sees every request first. Zero hands it on to CivetWeb, which then finds the WebSocket. */
static int on_request(struct mg_connection *connection) {
  lbw_live_server *server = (lbw_live_server *)mg_get_user_context_data(connection);
  const struct mg_request_info *request = mg_get_request_info(connection);
  if (!trusted(server, request))
    return answer(connection, 403, "Forbidden");
  const char *path = path_below_token(server, request->local_uri);
  if (!path)
    return answer(connection, 404, "Not Found");
  bool get = strcmp(request->request_method, "GET") == 0;
  if (!get && strcmp(request->request_method, "HEAD") != 0)
    return answer(connection, 405, "Method Not Allowed");
  if (strcmp(path, "socket") == 0) {
    const char *upgrade = mg_get_header(connection, "Upgrade");
    return get && upgrade && mg_strcasecmp(upgrade, "websocket") == 0
               ? 0
               : answer(connection, 426, "Upgrade Required");
  }
  live_page *page = find_page(server, path);
  int code = page ? send_page(connection, page, get) : answer(connection, 404, "Not Found");
  bw_release(page);
  return code;
}

/* Requests that CivetWeb itself refuses. */
static int on_http_error(struct mg_connection *connection, int code, const char *message) {
  (void)message;
  answer(connection, code, "Refused");
  return 0;
}

static int on_log(const struct mg_connection *connection, const char *message) {
  (void)connection;
  (void)message;
  return 1; /* said: nothing goes to standard error */
}

/* ---- life ------------------------------------------------------------------------------------ */

/* CivetWeb's master thread looks up every two seconds, or when somebody connects. */
static void *knock(void *data) {
  lbw_live_server *server = (lbw_live_server *)data;
  const struct timespec pause = {0, 10000000};
  const struct sockaddr_in address = {.sin_family = AF_INET,
                                      .sin_port = htons((uint16_t)server->port),
                                      .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  while (!__atomic_load_n(&server->stopped, __ATOMIC_RELAXED)) {
    nanosleep(&pause, NULL);
    int s = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (s < 0)
      continue;
    if (connect(s, (const struct sockaddr *)&address, sizeof address) != 0 && errno != EINPROGRESS)
      nanosleep(&pause, NULL);
    close(s);
  }
  return NULL;
}

static void stop_web(lbw_live_server *server) {
  lbw_live_end_clients(server);
  pthread_t knocker;
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  bool knocks = pthread_create(&knocker, NULL, knock, server) == 0;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  mg_stop(server->web); /* returns when no thread is left */
  __atomic_store_n(&server->stopped, true, __ATOMIC_RELAXED);
  if (knocks)
    pthread_join(knocker, NULL);
}

static void destroy_server(void *object) {
  lbw_live_server *server = (lbw_live_server *)object;
  if (server->owner != getpid())
    return; /* nobody would answer; the child's memory goes with it */
  if (server->web)
    stop_web(server);
  if (server->library)
    mg_exit_library();
  while (server->pages) {
    live_page *page = server->pages;
    server->pages = page->next;
    bw_release(page);
  }
  while (server->first) {
    lbw_live_event *event = server->first;
    server->first = event->next;
    bw_free(event);
  }
  pthread_cond_destroy(&server->arrived);
  pthread_mutex_destroy(&server->lock);
  bw_free(server);
}

static const bw_kind server_kind = {"live server", destroy_server, NULL};

static bool make_token(char token[LIVE_TOKEN_DIGITS + 1]) {
  unsigned char bytes[LIVE_TOKEN_DIGITS / 2];
  ssize_t got;
  do
    got = getrandom(bytes, sizeof bytes, 0);
  while (got < 0 && errno == EINTR);
  if (got != (ssize_t)sizeof bytes)
    return false;
  for (size_t i = 0; i < sizeof bytes; i++)
    snprintf(token + 2 * i, 3, "%02x", bytes[i]);
  return true;
}

/* mg_start makes threads, which take over the mask of signals, and ignores SIGCHLD and SIGPIPE for
 * the whole process; with SIGCHLD ignored nobody could wait for a child. */
static struct mg_context *start_web(lbw_live_server *server, const struct mg_callbacks *callbacks,
                                    const char **options) {
  sigset_t all, before;
  struct sigaction child, pipe;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  sigaction(SIGCHLD, NULL, &child);
  sigaction(SIGPIPE, NULL, &pipe);
  struct mg_context *web = mg_start(callbacks, server, options);
  sigaction(SIGCHLD, &child, NULL);
  sigaction(SIGPIPE, &pipe, NULL);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  return web;
}

static bw_status listen_to(bw_context *context, lbw_live_server *server) {
  char address[40], workers[20];
  snprintf(address, sizeof address, "127.0.0.1:%d", server->options.port);
  snprintf(workers, sizeof workers, "%d", server->options.clients + WORKERS_BESIDE_CLIENTS);
  const char *options[] = {"listening_ports",
                           address,
                           "num_threads",
                           workers,
                           "tcp_nodelay",
                           "1",
                           "request_timeout_ms",
                           "10000",
                           "websocket_timeout_ms",
                           "5000",
                           "enable_websocket_ping_pong",
                           "yes",
                           "enable_directory_listing",
                           "no",
                           "enable_auth_domain_check",
                           "no",
                           NULL};
  const struct mg_callbacks callbacks = {.begin_request = on_request,
                                         .http_error = on_http_error,
                                         .log_message = on_log,
                                         .log_access = on_log};
  server->library = mg_init_library(0) || true;
  server->web = start_web(server, &callbacks, options);
  struct mg_server_port port;
  memset(&port, 0, sizeof port);
  if (!server->web || mg_get_server_ports(server->web, 1, &port) != 1) {
    bw_detail_number(context, "port", server->options.port);
    return bw_fail(context, BW_IO,
                   "the live view cannot listen at %s: is the port taken? Give another one, or 0 "
                   "for any that is free",
                   address);
  }
  server->port = port.port;
  char uri[LIVE_TOKEN_DIGITS + 16];
  snprintf(uri, sizeof uri, "/%s/socket", server->token);
  lbw_live_take_clients(server, uri);
  return BW_OK;
}

bw_status lbw_live_create(bw_context *context, const lbw_live_options *options,
                          lbw_live_server **out) {
  *out = NULL;
  if (!(mg_check_feature(MG_FEATURES_WEBSOCKET) & MG_FEATURES_WEBSOCKET))
    return bw_fail(context, BW_UNSUPPORTED, "this CivetWeb was built without WebSocket");
  lbw_live_server *server = BW_NEW0(context, lbw_live_server, 1);
  if (!server)
    return BW_MEMORY;
  bw_object_init(server, &server_kind);
  server->owner = getpid();
  server->options = *options;
  pthread_mutex_init(&server->lock, NULL);
  pthread_condattr_t clock;
  pthread_condattr_init(&clock);
  pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
  pthread_cond_init(&server->arrived, &clock);
  pthread_condattr_destroy(&clock);
  bw_status status = make_token(server->token)
                         ? listen_to(context, server)
                         : bw_fail(context, BW_IO, "the system gives no random numbers");
  if (status == BW_OK)
    *out = server;
  else
    bw_release(server);
  return status;
}
