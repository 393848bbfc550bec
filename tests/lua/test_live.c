/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The live view's server, spoken to through plain sockets: who is answered, what closes a
 * connection, that a client who never reads holds up nobody, that nothing is left at the end. */
#include "check.h"

#include <arpa/inet.h>
#include <errno.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "live/internal.h"

/* How long a condition is waited for: it comes at once, but the machine may be busy. */
enum { TIME_LIMIT = 60 };

/* ---- a client -------------------------------------------------------------------------------- */

static int connect_to(struct in_addr host, int port) {
  int s = socket(AF_INET, SOCK_STREAM, 0);
  assert_true(s >= 0);
  struct sockaddr_in address = {
      .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr = host};
  if (connect(s, (struct sockaddr *)&address, sizeof address) == 0)
    return s;
  close(s);
  return -1;
}

static int connect_here(const lbw_live_server *server) {
  struct in_addr loopback = {htonl(INADDR_LOOPBACK)};
  int s = connect_to(loopback, lbw_live_port(server));
  assert_true(s >= 0);
  return s;
}

static void put(int s, const void *bytes, size_t length) {
  send(s, bytes, length, MSG_NOSIGNAL); /* the server may have had enough */
}

static bool readable(int s, int milliseconds) {
  struct pollfd entry = {.fd = s, .events = POLLIN};
  return poll(&entry, 1, milliseconds) == 1;
}

/* Bytes until `length` are there or the end came; their number. */
static size_t get(int s, void *into, size_t length) {
  size_t got = 0;
  while (got < length && readable(s, 1000 * TIME_LIMIT)) {
    ssize_t n = recv(s, (char *)into + got, length - got, 0);
    if (n <= 0)
      break;
    got += (size_t)n;
  }
  return got;
}

/* The status of the answer to a request, 0 for none; the whole answer into text. */
static int ask(const lbw_live_server *server, const char *request, char text[4096]) {
  int s = connect_here(server);
  put(s, request, strlen(request));
  size_t length = get(s, text, 4095);
  text[length] = 0;
  close(s);
  return length > 12 && strncmp(text, "HTTP/1.1 ", 9) == 0 ? atoi(text + 9) : 0;
}

/* A WebSocket that has been agreed on. */
static int open_socket(const lbw_live_server *server, char answer[1024]) {
  char request[600];
  snprintf(request, sizeof request,
           "GET /%s/socket HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nUpgrade: websocket\r\n"
           "Connection: Upgrade\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
           "Sec-WebSocket-Version: 13\r\nOrigin: http://127.0.0.1:%d\r\n\r\n",
           lbw_live_token(server), lbw_live_port(server), lbw_live_port(server));
  int s = connect_here(server);
  put(s, request, strlen(request));
  size_t length = 0;
  while (length < 1023 && !(length >= 4 && memcmp(answer + length - 4, "\r\n\r\n", 4) == 0) &&
         get(s, answer + length, 1) == 1)
    length++;
  answer[length] = 0;
  return s;
}

/* With a mask of zeros, or without one. */
static void put_frame_as(int s, bool masked, int first, const void *bytes, size_t length) {
  unsigned char head[14] = {(unsigned char)first};
  size_t n;
  if (length < 126) {
    head[1] = (unsigned char)(0x80 | length);
    n = 2;
  } else if (length < 65536) {
    head[1] = 0x80 | 126;
    head[2] = (unsigned char)(length >> 8);
    head[3] = (unsigned char)length;
    n = 4;
  } else {
    head[1] = 0x80 | 127;
    for (int i = 0; i < 8; i++)
      head[2 + i] = (unsigned char)((uint64_t)length >> (56 - 8 * i));
    n = 10;
  }
  if (!masked)
    head[1] &= 0x7f;
  put(s, head, masked ? n + 4 : n);
  put(s, bytes, length);
}

static void put_frame(int s, int first, const void *bytes, size_t length) {
  put_frame_as(s, true, first, bytes, length);
}

/* The next frame: its first byte and its payload's length, or -1. Payloads beyond `most` are cut.
 */
static int get_frame(int s, unsigned char *payload, size_t max, size_t *length) {
  unsigned char head[2], more[8];
  if (get(s, head, 2) != 2)
    return -1;
  size_t n = head[1] & 0x7f;
  if (n >= 126) {
    size_t bytes = n == 126 ? 2 : 8;
    if (get(s, more, bytes) != bytes)
      return -1;
    n = 0;
    for (size_t i = 0; i < bytes; i++)
      n = n << 8 | more[i];
  }
  *length = n;
  for (size_t got = 0; got < n;) {
    unsigned char rest[4096];
    size_t want = n - got < sizeof rest ? n - got : sizeof rest;
    if (get(s, rest, want) != want)
      return -1;
    for (size_t i = 0; i < want && got + i < max; i++)
      payload[got + i] = rest[i];
    got += want;
  }
  return head[0];
}

/* The code of the closing frame that comes next, or 0. */
static int get_close(int s) {
  unsigned char payload[130];
  size_t length;
  int first;
  do
    first = get_frame(s, payload, sizeof payload, &length);
  while (first == 0x89); /* pings */
  return first == 0x88 && length >= 2 ? payload[0] << 8 | payload[1] : 0;
}

/* ---- the server's side ----------------------------------------------------------------------- */

static lbw_live_server *start(void **state, void (*change)(lbw_live_options *)) {
  lbw_live_options options;
  lbw_live_defaults(&options);
  if (change)
    change(&options);
  lbw_live_server *server = NULL;
  check_ok(check_context(state), lbw_live_create(check_context(state), &options, &server));
  return server;
}

static int64_t expect(lbw_live_server *server, lbw_live_kind kind, const char *text) {
  lbw_live_event *event = lbw_live_receive(server, TIME_LIMIT);
  assert_non_null(event);
  assert_int_equal(event->kind, kind);
  if (text) {
    assert_int_equal(event->length, strlen(text));
    assert_memory_equal(event->text, text, event->length);
  }
  int64_t client = event->client;
  bw_free(event);
  return client;
}

static int64_t open_client(lbw_live_server *server, int *s) {
  char answer[1024];
  *s = open_socket(server, answer);
  assert_non_null(strstr(answer, " 101 "));
  return expect(server, LBW_LIVE_OPEN, "");
}

/* ---- who is answered ------------------------------------------------------------------------- */

static void test_only_the_right_address_is_answered(void **state) {
  lbw_live_server *server = start(state, NULL);
  check_ok(check_context(state),
           lbw_live_serve(check_context(state), server, "", "text/html", NULL, "<p>old", 6));
  check_ok(check_context(state),
           lbw_live_serve(check_context(state), server, "", "text/html", NULL, "<p>new", 6));
  check_ok(check_context(state), lbw_live_serve(check_context(state), server, "a.stl", "model/stl",
                                                "part.stl", "solid", 5));
  const char *token = lbw_live_token(server);
  int port = lbw_live_port(server);
  char wrong[40];
  strcpy(wrong, token);
  wrong[31] = wrong[31] == '0' ? '1' : '0';
  const struct {
    const char *method, *token, *path, *host, *more;
    int code;
  } cases[] = {
      {"GET", token, "/", "127.0.0.1:%d", "", 200},
      {"GET", token, "/", "localhost:%d", "", 200},
      {"GET", token, "/a.stl", "127.0.0.1:%d", "", 200},
      {"HEAD", token, "/", "127.0.0.1:%d", "", 200},
      {"GET", token, "/", "127.0.0.1:%d", "Origin: http://127.0.0.1:%d\r\n", 200},
      {"GET", token, "/", "127.0.0.1:%d", "Origin: http://localhost:%d\r\n", 403},
      {"GET", token, "/", "127.0.0.1:%d", "Origin: https://127.0.0.1:%d\r\n", 403},
      {"GET", token, "/", "127.0.0.1:%d", "Origin: http://example.org\r\n", 403},
      {"GET", token, "/", "127.0.0.1:%d", "Origin: null\r\n", 403},
      {"GET", token, "/", "example.org:%d", "", 403},
      {"GET", token, "/", "127.0.0.1", "", 403},
      {"GET", token, "/", "127.0.0.1.example.org:%d", "", 403},
      {"GET", token, "/", "127.0.0.1:%d", "Host: 127.0.0.1:%d\r\n", 403},
      {"GET", wrong, "/", "127.0.0.1:%d", "", 404},
      {"GET", "", "", "127.0.0.1:%d", "", 404},
      {"GET", token, "", "127.0.0.1:%d", "", 404},
      {"GET", token, "/b.stl", "127.0.0.1:%d", "", 404},
      {"GET", token, "/../../etc/passwd", "127.0.0.1:%d", "", 404},
      {"GET", token, "/%2e%2e/%2e%2e/etc/passwd", "127.0.0.1:%d", "", 404},
      {"POST", token, "/", "127.0.0.1:%d", "Content-Length: 0\r\n", 405},
      {"OPTIONS", token, "/", "127.0.0.1:%d", "Origin: http://example.org\r\n", 403},
      {"GET", token, "/socket", "127.0.0.1:%d", "", 426},
      {"GET", token, "/socket", "127.0.0.1:%d",
       "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
       "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nOrigin: http://example.org\r\n",
       403},
      {"GET", wrong, "/socket", "127.0.0.1:%d",
       "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
       "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n",
       404},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char host[64], more[400], request[900], text[4096];
    const char *mark = strstr(cases[i].host, "%d");
    snprintf(host, sizeof host, "%.*s", mark ? (int)(mark - cases[i].host) : 60, cases[i].host);
    size_t length = strlen(host);
    if (mark)
      snprintf(host + length, sizeof host - length, "%d", port);
    mark = strstr(cases[i].more, "%d");
    if (mark)
      snprintf(more, sizeof more, "%.*s%d\r\n", (int)(mark - cases[i].more), cases[i].more, port);
    else
      snprintf(more, sizeof more, "%s", cases[i].more);
    snprintf(request, sizeof request, "%s /%s%s HTTP/1.1\r\nHost: %s\r\n%s\r\n", cases[i].method,
             cases[i].token, cases[i].path, host, more);
    int code = ask(server, request, text);
    if (code != cases[i].code)
      fail_msg("case %d: %d instead of %d:\n%s", (int)i, code, cases[i].code, request);
    if (code) {
      assert_non_null(strstr(text, "nosniff"));
      assert_non_null(strstr(text, "no-store"));
      assert_non_null(strstr(text, "frame-ancestors 'none'"));
      assert_null(strstr(text, "<p>old"));
    }
    if (i == 0)
      assert_non_null(strstr(text, "\r\n\r\n<p>new"));
    if (i == 2)
      assert_non_null(strstr(text, "attachment; filename=\"part.stl\""));
  }
  bw_release(server);
}

static void test_what_is_no_request_is_refused(void **state) {
  lbw_live_server *server = start(state, NULL);
  const struct {
    const char *request;
    int code;
  } cases[] = {
      {"GET / HTTP/1.0\r\n\r\n", 403},
      {"\r\n\r\n", 400},
      {"GET\r\n\r\n", 400},
      {"GET /\r\n\r\n", 400},
      {"GET / HTTP/2.0\r\n\r\n", 400},
      {"GET / HTTP/1.1 \r\n\r\n", 400},
      {"GET  / HTTP/1.1\r\n\r\n", 400},
      {"GET / HTTP/1.1\r\nHost\r\n\r\n", 400},
      {"GET / HTTP/1.1\r\n: x\r\n\r\n", 400},
      {"GET / HTTP/1.1\r\nHost : x\r\n\r\n", 400},
      {"GET / HTTP/1.1\r\nA: b\r\n folded\r\n\r\n", 400},
      {"GET / HTTP/1.1\nHost: x\n\r\n\r\n", 400},
      {"GET / HTTP/1.1\r\nA: \001\r\n\r\n", 400},
      {"GET / HTTP/1.1\r\nHost: x\r\n\r\n", 403},
  };
  char text[4096];
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    int code = ask(server, cases[i].request, text);
    if (code != cases[i].code)
      fail_msg("%d instead of %d:\n%s", code, cases[i].code, cases[i].request);
  }
  static char large[LIVE_HEAD_BYTES + 2] = "GET / HTTP/1.1\r\nHost: ";
  memset(large + strlen(large), 'x', sizeof large - 1 - strlen(large));
  assert_int_equal(ask(server, large, text), 431);
  int s = connect_here(server); /* a NUL */
  put(s, "GET / HTTP/1.1\r\nHost: \0\r\n\r\n", 28);
  text[get(s, text, 12)] = 0;
  assert_string_equal(text, "HTTP/1.1 400");
  close(s);
  bw_release(server);
}

static void test_the_handshake_is_that_of_rfc_6455(void **state) {
  (void)state;
  char answer[LIVE_ACCEPT_BYTES];
  assert_true(live_accept_key("dGhlIHNhbXBsZSBub25jZQ==", answer));
  assert_string_equal(answer, "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
  static const char *const none[] = {"", "dGhlIHNhbXBsZSBub25jZQ", "dGhlIHNhbXBsZSBub25jZQ=!",
                                     "dGhlIHNhbXBsZSBub25jZSEhISEh"};
  for (size_t i = 0; i < sizeof none / sizeof *none; i++)
    assert_false(live_accept_key(none[i], answer));
}

static void test_other_addresses_of_the_machine_are_not_listened_to(void **state) {
  lbw_live_server *server = start(state, NULL);
  struct ifaddrs *list = NULL;
  assert_int_equal(getifaddrs(&list), 0);
  for (const struct ifaddrs *i = list; i; i = i->ifa_next) {
    if (!i->ifa_addr || i->ifa_addr->sa_family != AF_INET)
      continue;
    struct in_addr host = ((const struct sockaddr_in *)(const void *)i->ifa_addr)->sin_addr;
    if (host.s_addr != htonl(INADDR_LOOPBACK))
      assert_int_equal(connect_to(host, lbw_live_port(server)), -1);
  }
  freeifaddrs(list);
  struct in_addr other = {htonl(INADDR_LOOPBACK + 1)};
  assert_int_equal(connect_to(other, lbw_live_port(server)), -1);
  bw_release(server);
}

static void test_a_taken_port_is_reported(void **state) {
  lbw_live_server *server = start(state, NULL), *second = NULL;
  lbw_live_options options;
  lbw_live_defaults(&options);
  options.port = lbw_live_port(server);
  check_fails(check_context(state), BW_IO, "is the port taken",
              lbw_live_create(check_context(state), &options, &second));
  assert_null(second);
  bw_release(server);
}

/* ---- messages -------------------------------------------------------------------------------- */

static void test_messages_go_both_ways(void **state) {
  lbw_live_server *server = start(state, NULL);
  int s, t;
  int64_t a = open_client(server, &s), b = open_client(server, &t);
  assert_int_not_equal(a, b);
  assert_int_equal(lbw_live_client_count(server), 2);
  put_frame(s, 0x81, "{\"type\":\"undo\"}", 15);
  assert_int_equal(expect(server, LBW_LIVE_MESSAGE, "{\"type\":\"undo\"}"), a);
  static char big[65536];
  memset(big, 'x', sizeof big);
  put_frame(t, 0x81, big, sizeof big);
  assert_int_equal(expect(server, LBW_LIVE_MESSAGE, NULL), b);
  bool sent;
  check_ok(check_context(state),
           lbw_live_send(check_context(state), server, b, "hello", 5, false, NULL, &sent));
  assert_true(sent);
  unsigned char payload[16];
  size_t length;
  assert_int_equal(get_frame(t, payload, sizeof payload, &length), 0x81);
  assert_int_equal(length, 5);
  assert_memory_equal(payload, "hello", 5);
  check_ok(check_context(state),
           lbw_live_send(check_context(state), server, a, big, sizeof big, true, "state", &sent));
  assert_int_equal(get_frame(s, payload, sizeof payload, &length), 0x82);
  assert_int_equal(length, sizeof big);
  close(s);
  assert_int_equal(expect(server, LBW_LIVE_CLOSE, ""), a);
  check_ok(check_context(state),
           lbw_live_send(check_context(state), server, a, "hello", 5, false, NULL, &sent));
  assert_false(sent);
  lbw_live_disconnect(server, b, 1001, "the end");
  assert_int_equal(get_close(t), 1001);
  assert_int_equal(expect(server, LBW_LIVE_CLOSE, ""), b);
  close(t);
  assert_null(lbw_live_receive(server, 0));
  bw_release(server);
}

static void test_bad_frames_close_their_connection(void **state) {
  lbw_live_server *server = start(state, NULL);
  static char long_text[70000];
  memset(long_text, 'x', sizeof long_text);
  const struct {
    int first;
    const char *bytes;
    size_t length;
    int code;
  } cases[] = {
      {0x82, "binary", 6, 1003},
      {0x01, "half", 4, 1003},
      {0x80, "rest", 4, 1002},
      {0xc1, "reserved", 8, 1002},
      {0x83, "unknown", 7, 1002},
      {0x8b, "unknown", 7, 1002},
      {0x09, "half a ping", 11, 1002},
      {0x89, long_text, 126, 1002},
      {0x88, "x", 1, 1002},
      {0x81, long_text, sizeof long_text, 1009},
      {0x81, "\xff\xfe", 2, 1007},
      {0x81, "\xc0\x80", 2, 1007},
      {0x81, "\xed\xa0\x80", 3, 1007},
      {0x81, "abc\xe2\x82", 5, 1007},
      {0x81, "\xf4\x90\x80\x80", 4, 1007},
      {0x88, "\x03\xe8", 2, 1000},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    int s;
    int64_t client = open_client(server, &s);
    put_frame(s, cases[i].first, cases[i].bytes, cases[i].length);
    int code = get_close(s);
    if (code != cases[i].code)
      fail_msg("case %d: closed with %d instead of %d", (int)i, code, cases[i].code);
    assert_int_equal(expect(server, LBW_LIVE_CLOSE, ""), client);
    close(s);
  }
  int s;
  open_client(server, &s);
  put_frame(s, 0x81, "\xe2\x82\xac \xf0\x9f\x98\x80", 8);
  expect(server, LBW_LIVE_MESSAGE, "\xe2\x82\xac \xf0\x9f\x98\x80");
  close(s);
  bw_release(server);
}

static void test_unmasked_frames_close_with_1002(void **state) {
  lbw_live_server *server = start(state, NULL);
  static const int firsts[] = {0x81, 0x82, 0x88, 0x89, 0x8a};
  for (size_t i = 0; i < sizeof firsts / sizeof *firsts; i++) {
    int s;
    int64_t client = open_client(server, &s);
    put_frame_as(s, false, firsts[i], "{}", 2);
    assert_int_equal(get_close(s), 1002);
    assert_int_equal(expect(server, LBW_LIVE_CLOSE, ""), client); /* and no message before */
    close(s);
  }
  bw_release(server);
}

static void test_a_length_is_checked_before_the_bytes_come(void **state) {
  lbw_live_server *server = start(state, NULL);
  const struct {
    unsigned char head[14];
    size_t length;
    int code;
  } cases[] = {
      {{0x81, 0xff, 0, 0, 0, 0, 0x7f, 0xff, 0xff, 0xff}, 14, 1009}, /* 2 GiB */
      {{0x81, 0xff, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff}, 14, 1009},
      {{0x81, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff}, 14, 1002}, /* negative */
      {{0x81, 0xfe, 0, 125}, 8, 1002}, /* not the shortest form */
      {{0x81, 0xff, 0, 0, 0, 0, 0, 0, 0xff, 0xff}, 14, 1002},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    int s;
    int64_t client = open_client(server, &s);
    put(s, cases[i].head, cases[i].length);
    int code = get_close(s);
    if (code != cases[i].code)
      fail_msg("case %d: closed with %d instead of %d", (int)i, code, cases[i].code);
    assert_int_equal(expect(server, LBW_LIVE_CLOSE, ""), client);
    close(s);
  }
  bw_release(server);
}

static void test_a_ping_is_answered(void **state) {
  lbw_live_server *server = start(state, NULL);
  int s;
  open_client(server, &s);
  put_frame(s, 0x89, "are you there", 13);
  unsigned char payload[16];
  size_t length;
  assert_int_equal(get_frame(s, payload, sizeof payload, &length), 0x8a);
  assert_int_equal(length, 13);
  assert_memory_equal(payload, "are you there", 13);
  close(s);
  bw_release(server);
}

static void few(lbw_live_options *options) {
  options->clients = 2;
  options->queue_messages = 4;
  options->queue_bytes = 8 << 20;
}

static void test_limits_hold(void **state) {
  lbw_live_server *server = start(state, few);
  int s, t;
  int64_t a = open_client(server, &s);
  open_client(server, &t);
  char answer[1024];
  int u = open_socket(server, answer);
  assert_int_equal(get_close(u), 1013);
  close(u);
  for (int i = 0; i < 5; i++)
    put_frame(s, 0x81, "{}", 2);
  assert_int_equal(get_close(s), 1008);
  for (int i = 0; i < 4; i++)
    assert_int_equal(expect(server, LBW_LIVE_MESSAGE, "{}"), a);
  assert_int_equal(expect(server, LBW_LIVE_CLOSE, ""), a);
  close(s);
  open_client(server, &s); /* there is room again */
  close(s);
  close(t);
  bw_release(server);
}

/* ---- clients that do not read ---------------------------------------------------------------- */

enum { MEGABYTE = 1 << 20 };

static void test_a_stalled_client_holds_up_nobody(void **state) {
  lbw_live_server *server = start(state, few);
  int stalled, lively;
  int64_t a = open_client(server, &stalled), b = open_client(server, &lively);
  char *bytes = (char *)calloc(1, MEGABYTE);
  bool sent;
  /* States take one another's place, so that they never fill a queue. */
  for (int i = 0; i < 100; i++) {
    check_ok(check_context(state),
             lbw_live_send(check_context(state), server, a, bytes, MEGABYTE, true, "state", &sent));
    assert_true(sent);
    check_ok(check_context(state),
             lbw_live_send(check_context(state), server, b, "tick", 4, false, NULL, &sent));
    unsigned char payload[8];
    size_t length;
    assert_int_equal(get_frame(lively, payload, sizeof payload, &length), 0x81);
  }
  assert_int_equal(lbw_live_client_count(server), 2);
  /* What must not be left out does fill it, and then the client is cut off. */
  for (int i = 0; i < 100; i++) {
    check_ok(check_context(state),
             lbw_live_send(check_context(state), server, a, bytes, MEGABYTE, true, NULL, &sent));
    if (!sent)
      break;
  }
  assert_false(sent);
  assert_int_equal(expect(server, LBW_LIVE_CLOSE, ""), a);
  assert_int_equal(lbw_live_client_count(server), 1);
  free(bytes);
  close(stalled);
  close(lively);
  bw_release(server);
}

/* ---- connections that do nothing ------------------------------------------------------------- */

/* A silent connection is ended by others that come, never by time. */
static void for_ever(lbw_live_options *options) {
  options->head_seconds = 1e6;
}

static bool ended(int s) {
  char byte;
  ssize_t got = recv(s, &byte, 1, MSG_DONTWAIT);
  return got == 0 || (got < 0 && errno != EAGAIN);
}

static void test_silent_and_slow_connections_keep_nobody_out(void **state) {
  enum { COUNT = 1000, VISITS = 10 };
  struct rlimit limit;
  assert_int_equal(getrlimit(RLIMIT_NOFILE, &limit), 0);
  limit.rlim_cur = limit.rlim_max < 4096 ? limit.rlim_max : 4096;
  if (limit.rlim_cur < COUNT + 200 || setrlimit(RLIMIT_NOFILE, &limit) != 0)
    skip();
  lbw_live_server *server = start(state, for_ever);
  int window, s[COUNT];
  int64_t first = open_client(server, &window);
  for (int i = 0; i < COUNT; i++) {
    s[i] = connect_here(server);
    if (i % 2)
      put(s[i], "GET /", 5);
  }
  double longest = 0;
  for (int visit = 0; visit < VISITS; visit++) {
    for (int i = 1; i < COUNT; i += 2)
      put(s[i], "a", 1);
    double before = bw_seconds();
    int visitor;
    int64_t client = open_client(server, &visitor);
    longest = fmax(longest, bw_seconds() - before);
    close(visitor);
    assert_int_equal(expect(server, LBW_LIVE_CLOSE, ""), client);
  }
  print_message("beside %d connections the slowest of %d windows was there after %.4f s\n", COUNT,
                VISITS, longest);
  int kept = 0;
  for (int i = 0; i < COUNT; i++)
    kept += !ended(s[i]);
  assert_true(kept <= LIVE_WAITING);
  put_frame(window, 0x81, "{}", 2); /* a window is never displaced */
  assert_int_equal(expect(server, LBW_LIVE_MESSAGE, "{}"), first);
  for (int i = 0; i < COUNT; i++)
    close(s[i]);
  close(window);
  bw_release(server);
}

static void test_pages_that_nobody_reads_keep_nobody_out(void **state) {
  enum { COUNT = LIVE_LOADING + 40, LENGTH = 16 * MEGABYTE };
  lbw_live_server *server = start(state, NULL);
  char *page = (char *)calloc(1, LENGTH), *got = (char *)malloc(LENGTH), request[200];
  check_ok(check_context(state),
           lbw_live_serve(check_context(state), server, "page", "text/plain", NULL, page, LENGTH));
  snprintf(request, sizeof request, "GET /%s/page HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n",
           lbw_live_token(server), lbw_live_port(server));
  int s[COUNT];
  for (int i = 0; i < COUNT; i++) {
    s[i] = connect_here(server);
    put(s[i], request, strlen(request));
  }
  int reader = connect_here(server);
  put(reader, request, strlen(request));
  char end[5] = "";
  while (strcmp(end, "\r\n\r\n") != 0) { /* of the head */
    memmove(end, end + 1, 3);
    assert_int_equal(get(reader, end + 3, 1), 1);
  }
  assert_int_equal(get(reader, got, LENGTH), LENGTH);
  close(reader);
  for (int i = 0; i < COUNT; i++)
    close(s[i]);
  free(page);
  free(got);
  bw_release(server);
}

static void soon(lbw_live_options *options) {
  options->head_seconds = 0.3;
  options->silence_seconds = 0.3;
}

static void test_a_connection_without_a_request_is_ended(void **state) {
  lbw_live_server *server = start(state, soon);
  int silent = connect_here(server), slow = connect_here(server);
  char byte;
  while (!ended(slow)) { /* each byte comes in time, the request does not */
    put(slow, "a", 1);
    usleep(10000);
  }
  assert_int_equal(get(silent, &byte, 1), 0);
  close(silent);
  close(slow);
  bw_release(server);
}

static void test_a_window_gone_without_a_word_is_noticed(void **state) {
  lbw_live_server *server = start(state, soon);
  int s;
  int64_t client = open_client(server, &s);
  unsigned char payload[8];
  size_t length;
  assert_int_equal(get_frame(s, payload, sizeof payload, &length), 0x89); /* is it there? */
  assert_int_equal(expect(server, LBW_LIVE_CLOSE, ""), client);
  assert_int_equal(lbw_live_client_count(server), 0);
  close(s);
  bw_release(server);
}

/* ---- noise ----------------------------------------------------------------------------------- */

static uint64_t seed = 20130701;
static unsigned random_number(unsigned max) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (unsigned)(seed >> 33) % max;
}

static void test_noise_does_no_harm(void **state) {
  lbw_live_server *server = start(state, NULL);
  unsigned char noise[600];
  for (int round = 0; round < 150; round++) {
    size_t length = 1 + random_number(sizeof noise - 1);
    for (size_t i = 0; i < length; i++)
      noise[i] = (unsigned char)random_number(256);
    char answer[1024];
    bool agreed = round % 3 != 0;
    int s = agreed ? open_socket(server, answer) : connect_here(server);
    if (round % 3 == 2) /* a frame that is one, of noise */
      put_frame(s, (int)(0x80 | random_number(128)), noise, length);
    else
      put(s, noise, length);
    close(s);
  }
  /* Until the windows of noise have left, there may be no room for one more. A ping is answered
   * where there is. */
  int s, code = LIVE_CLOSE_LATER;
  while (code == LIVE_CLOSE_LATER) {
    char answer[1024];
    unsigned char payload[8];
    size_t size;
    s = open_socket(server, answer);
    put_frame(s, 0x89, "room?", 5);
    int first = get_frame(s, payload, sizeof payload, &size);
    code = first == 0x88 && size >= 2 ? payload[0] << 8 | payload[1] : first;
    if (code == LIVE_CLOSE_LATER)
      close(s);
  }
  assert_int_equal(code, 0x8a);
  put_frame(s, 0x81, "\"sane\"", 6);
  bool sane = false;
  for (lbw_live_event *event; !sane && (event = lbw_live_receive(server, TIME_LIMIT));
       bw_free(event))
    sane = event->kind == LBW_LIVE_MESSAGE && event->length == 6 &&
           memcmp(event->text, "\"sane\"", 6) == 0;
  assert_true(sane);
  close(s);
  bw_release(server);
}

/* ---- the end --------------------------------------------------------------------------------- */

/* ---- uploads --------------------------------------------------------------------------------- */

static void uploads(lbw_live_options *options) {
  options->upload_bytes = 100000;
  options->head_seconds = 3600;
}

/* The status of a POST below the token with these header lines and bytes behind the head. */
static int post(const lbw_live_server *server, const char *path, const char *fields,
                const void *body, size_t length) {
  char request[1000], text[4096];
  int n = snprintf(request, sizeof request, "POST /%s/%s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n%s\r\n",
                   lbw_live_token(server), path, lbw_live_port(server), fields);
  int s = connect_here(server);
  put(s, request, (size_t)n);
  put(s, body, length);
  size_t got = get(s, text, sizeof text - 1);
  text[got] = 0;
  close(s);
  return got > 12 ? atoi(text + 9) : 0;
}

static void test_an_upload_arrives_whole(void **state) {
  lbw_live_server *server = start(state, uploads);
  static char body[100000];
  for (size_t i = 0; i < sizeof body; i++)
    body[i] = (char)(i * 7 + i / 251);
  for (int k = 0; k < 3; k++) { /* the next one after the owner took the one before */
    assert_int_equal(post(server, "upload?name=a%20b.stl",
                          "Content-Type: application/octet-stream\r\nContent-Length: 100000\r\n",
                          body, sizeof body),
                     200);
    lbw_live_event *event = lbw_live_receive(server, TIME_LIMIT);
    assert_non_null(event);
    assert_int_equal(event->kind, LBW_LIVE_UPLOAD);
    assert_int_equal(event->client, 0);
    assert_int_equal(event->length, 15 + sizeof body);
    assert_memory_equal(event->text, "name=a%20b.stl\n", 15);
    assert_memory_equal(event->text + 15, body, sizeof body);
    bw_free(event);
  }
  bw_release(server);
}

static void test_hostile_uploads_are_refused(void **state) {
  lbw_live_server *server = start(state, uploads);
  static const struct {
    const char *path, *fields;
    int code;
  } cases[] = {
      {"upload", "", 411},
      {"upload", "Transfer-Encoding: chunked\r\n", 411},
      {"upload", "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n", 411},
      {"upload", "Content-Length: 5\r\nContent-Length: 6\r\n", 403},
      {"upload", "Content-Length: 0\r\n", 400},
      {"upload", "Content-Length: -1\r\n", 400},
      {"upload", "Content-Length: +5\r\n", 400},
      {"upload", "Content-Length: 5 5\r\n", 400},
      {"upload", "Content-Length: 0x10\r\n", 400},
      {"upload", "Content-Length: \r\n", 400},
      {"upload", "Content-Length: 99999999999999999999\r\n", 400},
      {"upload", "Content-Length: 100001\r\n", 413},
      {"upload", "Content-Length: 999999999999999\r\n", 413},
      {"upload", "Content-Length: 5\r\nOrigin: http://example.org\r\n", 403},
      {"upload/", "Content-Length: 5\r\n", 405},
      {"", "Content-Length: 5\r\n", 405},
      {"socket", "Content-Length: 5\r\n", 405},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    assert_int_equal(post(server, cases[i].path, cases[i].fields, "", 0), cases[i].code);
  /* one at a time: a second is refused, until the first is gone */
  char request[300];
  int n = snprintf(request, sizeof request,
                   "POST /%s/upload HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nContent-Length: 9\r\n\r\n12",
                   lbw_live_token(server), lbw_live_port(server));
  int s = connect_here(server);
  put(s, request, (size_t)n);
  int code = 0;
  for (int k = 0; k < 1000 && code != 503; k++) { /* once the first was read */
    code = post(server, "upload?name=x", "Content-Length: 3\r\n", "abc", 3);
    if (code == 200)
      bw_free(lbw_live_receive(server, TIME_LIMIT));
  }
  assert_int_equal(code, 503);
  assert_null(lbw_live_receive(server, 0)); /* half of one is none */
  close(s);
  for (int k = 0; k < 1000 && code != 200; k++)
    code = post(server, "upload", "Content-Length: 3\r\n", "abc", 3);
  assert_int_equal(code, 200);
  expect(server, LBW_LIVE_UPLOAD, "\nabc");
  bw_release(server);
}

static void test_without_a_limit_nothing_is_uploaded(void **state) {
  lbw_live_server *server = start(state, NULL);
  assert_int_equal(post(server, "upload", "Content-Length: 5\r\n", "", 0), 405);
  bw_release(server);
}

static void test_it_ends_with_clients_connected(void **state) {
  lbw_live_server *server = start(state, NULL);
  int s[3];
  int64_t client = 0;
  for (int i = 0; i < 3; i++)
    client = open_client(server, &s[i]);
  put_frame(s[0], 0x81, "{}", 2);
  char *bytes = (char *)calloc(1, MEGABYTE);
  bool sent;
  for (int i = 0; i < 20; i++)
    check_ok(check_context(state), lbw_live_send(check_context(state), server, client, bytes,
                                                 MEGABYTE, true, NULL, &sent));
  free(bytes);
  bw_release(server);
  for (int i = 0; i < 3; i++)
    close(s[i]);
}

static bw_status make_and_use(bw_context *context) {
  lbw_live_options options;
  lbw_live_defaults(&options);
  lbw_live_server *server = NULL;
  bool sent;
  bw_status status;
  BW_TRY(lbw_live_create(context, &options, &server));
  BW_TRY(lbw_live_serve(context, server, "a", "text/plain", NULL, "a", 1));
  BW_TRY(lbw_live_serve(context, server, "a", "text/plain", "b", "b", 1));
  BW_TRY(lbw_live_send(context, server, 1, "a", 1, false, NULL, &sent));
done:
  bw_release(server);
  return status;
}

/* Whether a message arrives; false when the connection ends before. */
static bool message_arrives(lbw_live_server *server, int s) {
  put_frame(s, 0x81, "{}", 2);
  while (true) {
    lbw_live_event *event = lbw_live_receive(server, 0.01);
    bool message = event && event->kind == LBW_LIVE_MESSAGE;
    bw_free(event);
    if (message || (!event && readable(s, 0)))
      return message;
  }
}

static void test_memory_running_out(void **state) {
  bw_context *context = check_context(state);
  check_each_allocation(context, status, 1) {
    status = make_and_use(context);
  }
  /* In the server's thread: a window is refused, or told why it is closed, and the server goes on.
   */
  bool admitted = false;
  for (int n = 1; !admitted; n++) {
    assert_true(n < 100);
    lbw_live_server *server = start(state, NULL);
    char answer[1024];
    bw_fail_allocation(n, true);
    int s = open_socket(server, answer);
    if (strstr(answer, " 101 "))
      admitted = message_arrives(server, s);
    bw_fail_allocation(0, false);
    close(s);
    s = open_socket(server, answer);
    assert_non_null(strstr(answer, " 101 "));
    close(s);
    bw_release(server);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(test_only_the_right_address_is_answered),
      check_test(test_what_is_no_request_is_refused),
      check_test(test_the_handshake_is_that_of_rfc_6455),
      check_test(test_other_addresses_of_the_machine_are_not_listened_to),
      check_test(test_a_taken_port_is_reported),
      check_test(test_messages_go_both_ways),
      check_test(test_bad_frames_close_their_connection),
      check_test(test_unmasked_frames_close_with_1002),
      check_test(test_a_length_is_checked_before_the_bytes_come),
      check_test(test_a_ping_is_answered),
      check_test(test_limits_hold),
      check_test(test_a_stalled_client_holds_up_nobody),
      check_test(test_silent_and_slow_connections_keep_nobody_out),
      check_test(test_pages_that_nobody_reads_keep_nobody_out),
      check_test(test_a_connection_without_a_request_is_ended),
      check_test(test_a_window_gone_without_a_word_is_noticed),
      check_test(test_noise_does_no_harm),
      check_test(test_an_upload_arrives_whole),
      check_test(test_hostile_uploads_are_refused),
      check_test(test_without_a_limit_nothing_is_uploaded),
      check_test(test_it_ends_with_clients_connected),
      check_test(test_memory_running_out),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
