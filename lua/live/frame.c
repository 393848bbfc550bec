/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* WebSocket frames (RFC 6455), as much of them as the live view speaks: a message is one frame. */
#include <nettle/base64.h>
#include <nettle/sha1.h>
#include <stdio.h>
#include <string.h>

#include "live/internal.h"

enum { FINAL = 0x80, RESERVED = 0x70, OPCODE = 0x0f, MASKED = 0x80, LENGTH = 0x7f };
enum { MASK_BYTES = 4, CONTROL_BYTES = 125 };

/* Of the first two bytes of a frame. */
static int check_start(int first, int second, const char **reason) {
  int opcode = first & OPCODE;
  bool control = opcode >= LIVE_CLOSE, final = first & FINAL;
  *reason = "reserved bits are set";
  if (first & RESERVED)
    return LIVE_CLOSE_PROTOCOL;
  *reason = "frames from a client must be masked";
  if (!(second & MASKED))
    return LIVE_CLOSE_PROTOCOL;
  *reason = "a control frame is whole and has at most 125 bytes";
  if (control && (!final || (second & LENGTH) > CONTROL_BYTES))
    return LIVE_CLOSE_PROTOCOL;
  *reason = "unexpected kind of frame";
  if (opcode == 0 || (opcode > LIVE_BINARY && opcode < LIVE_CLOSE) || opcode > LIVE_PONG)
    return LIVE_CLOSE_PROTOCOL;
  *reason = "text in one frame expected";
  return opcode == LIVE_BINARY || !final ? LIVE_CLOSE_TYPE : 0;
}

int live_check_frame(const char *bytes, size_t filled, int64_t max, live_frame *frame,
                     const char **reason) {
  const unsigned char *head = (const unsigned char *)bytes;
  *frame = (live_frame){0};
  if (filled < 2)
    return 0;
  int code = check_start(head[0], head[1], reason);
  if (code)
    return code;
  uint64_t length = head[1] & LENGTH;
  size_t more = length == 126 ? 2 : length == 127 ? 8 : 0;
  if (filled < 2 + more + MASK_BYTES)
    return 0;
  if (more) {
    length = 0;
    for (size_t i = 0; i < more; i++)
      length = length << 8 | head[2 + i];
    *reason = "the length of a frame is not in its shortest form";
    if (length < 126 || (more == 8 && (length < 65536 || length >> 63)))
      return LIVE_CLOSE_PROTOCOL;
  }
  *reason = "the message is too long";
  if (length > (uint64_t)max && (head[0] & OPCODE) < LIVE_CLOSE)
    return LIVE_CLOSE_SIZE;
  *frame = (live_frame){head[0] & OPCODE, 2 + more + MASK_BYTES, (size_t)length};
  return 0;
}

char *live_unmask(char *bytes, const live_frame *frame) {
  char *payload = bytes + frame->head;
  const char *mask = payload - MASK_BYTES;
  for (size_t i = 0; i < frame->length; i++)
    payload[i] ^= mask[i % MASK_BYTES];
  return payload;
}

/* Well-formed UTF-8: no overlong forms, no surrogates, nothing above U+10FFFF. */
bool live_is_utf8(const char *bytes, size_t length) {
  const unsigned char *text = (const unsigned char *)bytes;
  for (size_t i = 0; i < length;) {
    unsigned char c = text[i];
    size_t more = c < 0x80 ? 0 : c >= 0xc2 && c < 0xe0 ? 1 : c >= 0xe0 && c < 0xf0 ? 2 : 3;
    if (more == 3 && (c < 0xf0 || c > 0xf4))
      return false;
    if (more >= length - i)
      return more == 0;
    for (size_t k = 1; k <= more; k++)
      if ((text[i + k] & 0xc0) != 0x80)
        return false;
    unsigned char second = more > 0 ? text[i + 1] : 0;
    if ((c == 0xe0 && second < 0xa0) || (c == 0xed && second > 0x9f) ||
        (c == 0xf0 && second < 0x90) || (c == 0xf4 && second > 0x8f))
      return false;
    i += more + 1;
  }
  return true;
}

live_outgoing *live_new_frame(bw_context *context, int opcode, const char *key, const void *payload,
                              size_t length) {
  unsigned char head[10] = {(unsigned char)(FINAL | opcode)};
  size_t more = length < 126 ? 0 : length < 65536 ? 2 : 8;
  head[1] = (unsigned char)(more == 0 ? length : more == 2 ? 126 : 127);
  for (size_t i = 0; i < more; i++)
    head[2 + i] = (unsigned char)((uint64_t)length >> (8 * (more - 1 - i)));
  size_t size = 2 + more;
  live_outgoing *frame = (live_outgoing *)bw_alloc(context, 1, sizeof *frame + size + length);
  if (!frame)
    return NULL;
  *frame = (live_outgoing){.data = frame->bytes, .length = size + length};
  snprintf(frame->key, sizeof frame->key, "%s", key);
  memcpy(frame->bytes, head, size);
  if (length > 0)
    memcpy(frame->bytes + size, payload, length);
  return frame;
}

live_outgoing *live_new_close(int code, const char *reason) {
  char payload[CONTROL_BYTES] = {(char)(code >> 8), (char)(code & 0xff)};
  size_t length = strlen(reason), max = sizeof payload - 2;
  length = length < max ? length : max;
  memcpy(payload + 2, reason, length);
  return live_new_frame(NULL, LIVE_CLOSE, "", payload, 2 + length);
}

bool live_accept_key(const char *key, char answer[LIVE_ACCEPT_BYTES]) {
  enum { KEY_TEXT = 24, KEY_BYTES = 16 };
  static const char magic[] = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"; /* RFC 6455, section 1.3 */
  uint8_t bytes[BASE64_DECODE_LENGTH(KEY_TEXT)], digest[SHA1_DIGEST_SIZE];
  size_t length = sizeof bytes;
  struct base64_decode_ctx decode;
  base64_decode_init(&decode);
  if (strlen(key) != KEY_TEXT || !base64_decode_update(&decode, &length, bytes, KEY_TEXT, key) ||
      !base64_decode_final(&decode) || length != KEY_BYTES)
    return false;
  struct sha1_ctx sha1;
  sha1_init(&sha1);
  sha1_update(&sha1, KEY_TEXT, (const uint8_t *)key);
  sha1_update(&sha1, sizeof magic - 1, (const uint8_t *)magic);
  sha1_digest(&sha1, sizeof digest, digest);
  base64_encode_raw(answer, sizeof digest, digest);
  answer[BASE64_ENCODE_RAW_LENGTH(sizeof digest)] = 0;
  return true;
}
