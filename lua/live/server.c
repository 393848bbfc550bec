/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The server's life, and the pages that it serves. */
#include <errno.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include "live/internal.h"

void lbw_live_defaults(lbw_live_options *options) {
  *options = (lbw_live_options){.clients = 8,
                                .message_bytes = 64 << 10,
                                .queue_bytes = (int64_t)64 << 20,
                                .queue_messages = 256,
                                .head_seconds = 5,
                                .silence_seconds = 30};
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

/* Retained: the page may be replaced while it is being sent. */
live_page *live_find_page(lbw_live_server *server, const char *path) {
  pthread_mutex_lock(&server->lock);
  live_page *page = server->pages;
  while (page && strcmp(page->path, path) != 0)
    page = page->next;
  bw_retain(page);
  pthread_mutex_unlock(&server->lock);
  return page;
}

/* ---- life ------------------------------------------------------------------------------------ */

static void destroy_server(void *object) {
  lbw_live_server *server = (lbw_live_server *)object;
  if (server->owner != getpid())
    return; /* nobody would answer; the child's memory goes with it */
  live_stop(server);
  if (server->listening >= 0) {
    shutdown(server->listening, SHUT_RDWR); /* a forked child may have the socket as well */
    close(server->listening);
  }
  if (server->wake >= 0)
    close(server->wake);
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

/* Listens at the loopback address alone. */
static bw_status listen_to(bw_context *context, lbw_live_server *server) {
  const int yes = 1;
  struct sockaddr_in address = {.sin_family = AF_INET,
                                .sin_port = htons((uint16_t)server->options.port),
                                .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  socklen_t length = sizeof address;
  server->wake = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  server->listening = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  int s = server->listening;
  if (server->wake < 0 || s < 0)
    return bw_fail(context, BW_IO, "the live view cannot open a socket: %s", strerror(errno));
  setsockopt(s, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (bind(s, (const struct sockaddr *)&address, sizeof address) != 0 ||
      listen(s, SOMAXCONN) != 0 || getsockname(s, (struct sockaddr *)&address, &length) != 0) {
    bw_detail_number(context, "port", server->options.port);
    return bw_fail(context, BW_IO,
                   "the live view cannot listen at 127.0.0.1:%d (%s): is the port taken? Give "
                   "another one, or 0 for any that is free",
                   server->options.port, strerror(errno));
  }
  server->port = ntohs(address.sin_port);
  return BW_OK;
}

bw_status lbw_live_create(bw_context *context, const lbw_live_options *options,
                          lbw_live_server **out) {
  *out = NULL;
  lbw_live_server *server = BW_NEW0(context, lbw_live_server, 1);
  if (!server)
    return BW_MEMORY;
  bw_object_init(server, &server_kind);
  server->owner = getpid();
  server->listening = server->wake = -1;
  server->options = *options;
  pthread_mutex_init(&server->lock, NULL);
  pthread_condattr_t clock;
  pthread_condattr_init(&clock);
  pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
  pthread_cond_init(&server->arrived, &clock);
  pthread_condattr_destroy(&clock);
  bw_status status;
  BW_TRY(make_token(server->token)
             ? BW_OK
             : bw_fail(context, BW_IO, "the random numbers of the system cannot be read"));
  BW_TRY(listen_to(context, server));
  BW_TRY(live_start(context, server));
  bw_retain(server);
  *out = server;
done:
  bw_release(server);
  return status;
}
