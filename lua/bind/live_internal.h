/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Between live_server.c and live_client.c. */
#ifndef LBW_LIVE_INTERNAL_H
#define LBW_LIVE_INTERNAL_H

#include <civetweb.h>
#include <pthread.h>
#include <sys/types.h>

#include "live_server.h"

enum { LIVE_TOKEN_DIGITS = 32 };

typedef struct live_page {
  bw_object object;
  struct live_page *next;
  char *text; /* path, mime, download: one block */
  const char *path, *mime, *download;
  char *content;
  size_t length;
} live_page;

typedef struct live_client live_client;

struct lbw_live_server {
  bw_object object;
  lbw_live_options options;
  int port;
  char token[LIVE_TOKEN_DIGITS + 1];
  pid_t owner;  /* a child that was forked has none of its threads */
  bool library; /* mg_init_library was called */
  bool stopped; /* CivetWeb has ended (atomic) */
  struct mg_context *web;
  pthread_mutex_t lock; /* of all that follows */
  pthread_cond_t arrived;
  live_page *pages;
  live_client *clients;
  int client_count;
  int64_t last_client;
  lbw_live_event *first, *last;
  bool stopping;
};

/* Takes WebSockets at this address from now on. */
void lbw_live_take_clients(lbw_live_server *server, const char *uri);
/* Cuts all connections and takes no new ones: before mg_stop, which waits for them. */
void lbw_live_end_clients(lbw_live_server *server);

#endif
