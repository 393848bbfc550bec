/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Reference counts. */
#include "barwright/base.h"

void bw_object_init(void *object, const bw_kind *kind) {
  bw_object *head = (bw_object *)object;
  head->kind = kind;
  head->references = 1;
  head->revision = 1;
}

void *bw_retain(const void *object) {
  if (object)
    __atomic_add_fetch(&((bw_object *)object)->references, 1, __ATOMIC_RELAXED);
  return (void *)object;
}

void bw_release(const void *object) {
  if (!object)
    return;
  bw_object *head = (bw_object *)object;
  if (__atomic_sub_fetch(&head->references, 1, __ATOMIC_ACQ_REL) == 0)
    head->kind->destroy(head);
}

size_t bw_bytes(const void *object) {
  const bw_object *head = (const bw_object *)object;
  return head && head->kind->bytes ? head->kind->bytes(head) : 0;
}
