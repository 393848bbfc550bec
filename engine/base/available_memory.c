/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How much memory a process may still take. Three bounds, the smallest of which counts: what the
 * machine has free (pages of files that it can drop included, and swap), what the limit on address
 * space leaves (ulimit -v, a job's memory), and what the control group leaves that containers live
 * in. A file that cannot be read is no bound. */
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/job.h"

enum { TEXT = 8192 };

/* The beginning of a small file; false where there is none. */
static bool read_text(const char *path, char text[TEXT]) {
  int file = open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0)
    return false;
  size_t fill = 0;
  ssize_t got;
  while (fill < TEXT - 1 && (got = read(file, text + fill, TEXT - 1 - fill)) > 0)
    fill += (size_t)got;
  close(file);
  text[fill] = 0;
  return fill > 0;
}

/* The whole number behind `name` at the start of a line; -1 where there is none ("max", say). */
static double number_after(const char *text, const char *name) {
  size_t length = strlen(name);
  for (const char *line = text; line; line = strchr(line, '\n')) {
    line += *line == '\n';
    if (strncmp(line, name, length) != 0)
      continue;
    const char *digit = line + length + strspn(line + length, " \t");
    char *end;
    unsigned long long value = strtoull(digit, &end, 10);
    return end > digit ? (double)value : -1;
  }
  return -1;
}

static double of_machine(char text[TEXT]) {
  if (!read_text("/proc/meminfo", text)) {
    long pages = sysconf(_SC_PHYS_PAGES);
    return pages > 0 ? (double)pages * (double)sysconf(_SC_PAGESIZE) : INFINITY;
  }
  double available = number_after(text, "MemAvailable:"), swap = number_after(text, "SwapFree:");
  return available < 0 ? INFINITY : 1024 * (available + fmax(swap, 0));
}

double bwi_address_space(void) {
  char text[TEXT];
  return read_text("/proc/self/statm", text)
             ? number_after(text, "") * (double)sysconf(_SC_PAGESIZE)
             : 0;
}

double bwi_address_space_left(void) {
  struct rlimit space;
  if (getrlimit(RLIMIT_AS, &space) != 0 || space.rlim_cur == RLIM_INFINITY)
    return INFINITY;
  double used = bwi_address_space();
  return used > 0 ? fmax(0, (double)space.rlim_cur - used) : INFINITY;
}

/* `limit` and `used` are files of one number; what files take of it can be dropped. */
static double of_group(const char *limit, const char *used, const char *parts, char text[TEXT]) {
  double max, now, files;
  if (!read_text(limit, text) || (max = number_after(text, "")) < 0 || max > 1e18 ||
      !read_text(used, text) || (now = number_after(text, "")) < 0)
    return INFINITY;
  files = read_text(parts, text) ? fmax(0, number_after(text, "inactive_file")) : 0;
  return fmax(0, max - now + files);
}

double bw_available_memory(void) {
  char text[TEXT];
  double available = fmin(of_machine(text), bwi_address_space_left());
  available = fmin(available, of_group("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current",
                                       "/sys/fs/cgroup/memory.stat", text));
  return fmin(available, of_group("/sys/fs/cgroup/memory/memory.limit_in_bytes",
                                  "/sys/fs/cgroup/memory/memory.usage_in_bytes",
                                  "/sys/fs/cgroup/memory/memory.stat", text));
}
