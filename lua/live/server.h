/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The server of the live view: files and WebSockets for the browsers of this machine. Knows nothing
 * of Lua; lua/bind/live.c makes it a userdata.
 *
 * What it answers to: connections to 127.0.0.1 alone, whose Host is 127.0.0.1:PORT or
 * localhost:PORT (so that a name that somebody points at this machine does not serve), whose
 * Origin, where there is one, is the same, below a path of 128 random bits.
 *
 * A thread of the server's own accepts, reads and writes, and never blocks. The owner queues what
 * is to be sent, and takes what arrived. Everything that both use is guarded by one lock, which is
 * never held while something is sent. The thread blocks every signal. */
#ifndef LBW_LIVE_SERVER_H
#define LBW_LIVE_SERVER_H

#include "barwright.h"

typedef struct lbw_live_server lbw_live_server; /* reference-counted */

typedef struct lbw_live_options {
  int port;               /* 0: any free one */
  int clients;            /* at most, at a time */
  int64_t message_bytes;  /* a longer message closes its connection */
  int64_t queue_bytes;    /* a client for whom more is waiting to be sent is closed */
  int queue_messages;     /* a client from whom more is waiting to be read is closed */
  int64_t upload_bytes;   /* longest body of POST /TOKEN/upload; 0: none is taken */
  double head_seconds;    /* a connection whose request is not whole by then is ended */
  double silence_seconds; /* a client that neither took nor gave a byte for so long is ended; it is
                             asked for a sign of life after a third of that */
} lbw_live_options;
void lbw_live_defaults(lbw_live_options *options);

bw_status lbw_live_create(bw_context *context, const lbw_live_options *options,
                          lbw_live_server **server);
int lbw_live_port(const lbw_live_server *server);
const char *lbw_live_token(const lbw_live_server *server); /* 32 hexadecimal digits */
int lbw_live_client_count(lbw_live_server *server);

/* Serves a copy of the bytes at /TOKEN/path, in place of what was there. With a `download` the
 * browser saves it under that name. All three texts are plain ASCII without quotes. */
bw_status lbw_live_serve(bw_context *context, lbw_live_server *server, const char *path,
                         const char *mime, const char *download, const void *bytes, size_t length);

enum { LBW_LIVE_KEY_BYTES = 24 }; /* a key with its end fits */

/* Queues a copy of a message for a client, text or binary. A message with a key takes the place of
 * an unsent one with that key, at the end of the queue. *sent is false when there is no such client
 * (any more). */
bw_status lbw_live_send(bw_context *context, lbw_live_server *server, int64_t client,
                        const void *bytes, size_t length, bool binary, const char *key, bool *sent);

/* Ends a client's connection with a code of RFC 6455 and a short reason. */
void lbw_live_disconnect(lbw_live_server *server, int64_t client, int code, const char *reason);

/* An upload has client 0; its text is the query of the request, a line feed, the body. */
typedef enum lbw_live_kind {
  LBW_LIVE_OPEN,
  LBW_LIVE_MESSAGE,
  LBW_LIVE_CLOSE,
  LBW_LIVE_UPLOAD
} lbw_live_kind;
typedef struct lbw_live_event {
  struct lbw_live_event *next;
  lbw_live_kind kind;
  int64_t client;
  size_t length;
  char text[];
} lbw_live_event;
/* The oldest event, to be released with bw_free; waits for one up to so many seconds. NULL when
 * none came. */
lbw_live_event *lbw_live_receive(lbw_live_server *server, double seconds);

#endif
