/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stacks that hold thread-local storage.
 *
 * glibc puts the thread-local storage of all libraries that a program is linked with on the stack
 * of each thread. Here that is about 190 kB (CGAL, OpenBLAS, METIS), more than the 100 kB of stack
 * that CivetWeb gives its threads, and pthread_create refuses them. The program therefore stands
 * before pthread_attr_setstacksize and raises small sizes; what is not touched costs no memory. A
 * Lua interpreter that loads the module needs none of this: storage of libraries loaded later lies
 * elsewhere. */
#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <string.h>

static const size_t least_stack = (size_t)1 << 20;

__attribute__((visibility("default"))) int pthread_attr_setstacksize(pthread_attr_t *attributes,
                                                                     size_t bytes) {
  static int (*next)(pthread_attr_t *, size_t);
  int (*known)(pthread_attr_t *, size_t) = __atomic_load_n(&next, __ATOMIC_RELAXED);
  if (!known) {
    /* The way POSIX has a function pointer made of what dlsym returns. */
    void *symbol = dlsym(RTLD_NEXT, "pthread_attr_setstacksize");
    if (!symbol)
      return ENOSYS;
    memcpy(&known, &symbol, sizeof known);
    __atomic_store_n(&next, known, __ATOMIC_RELAXED);
  }
  return known(attributes, bytes < least_stack ? least_stack : bytes);
}
