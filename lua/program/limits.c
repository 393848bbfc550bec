/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Limits on memory and time of a script, and the process that watches them.
 *
 * With a limit or a sandbox the program forks at once: the child runs the script, the parent waits,
 * passes signals on, ends the child when its time is over, and says why it ended. So no loop, no
 * pattern, no engine call and no pcall can hold out against it, and the child begins with a single
 * thread, as what the kernel confines (kernel.c) is a thread and those that it starts.
 *
 * Memory is limited twice: Lua's by its allocator, so that a script gets Lua's own error; that of
 * the process by the kernel (address space beyond what there is before the script), so that the
 * engine's allocations fail as they do when memory is out. */
#include "program.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/* A child that writes to a slow disk ends only after the write. */
enum { GRACE_MILLISECONDS = 20000 };

/* ---- what the options say -------------------------------------------------------------------- */

/* A number with one of the suffixes behind it; false when it is none, or not above 0. */
static bool read_quantity(const char *text, const char *const suffix[], const double scale[],
                          double *value) {
  char digits[64];
  size_t length = strspn(text, "0123456789.");
  if (length == 0 || length >= sizeof digits)
    return false;
  memcpy(digits, text, length);
  digits[length] = 0;
  if (!bw_parse_number(digits, value))
    return false;
  for (int i = 0; suffix[i]; i++)
    if (strcmp(text + length, suffix[i]) == 0) {
      *value *= scale[i];
      return *value > 0 && *value < 1e15;
    }
  return false;
}

bool program_read_bytes(const char *text, double *bytes) {
  static const char *const suffix[] = {"", "B", "K", "M", "G", "T", "KB", "MB", "GB", "TB", NULL};
  static const double scale[] = {1, 1, 0x1p10, 0x1p20, 0x1p30, 0x1p40, 1e3, 1e6, 1e9, 1e12};
  return read_quantity(text, suffix, scale, bytes);
}

bool program_read_seconds(const char *text, double *seconds) {
  static const char *const suffix[] = {"", "s", "min", "h", NULL};
  static const double scale[] = {1, 1, 60, 3600};
  return read_quantity(text, suffix, scale, seconds);
}

static void size_text(double bytes, char text[32]) {
  static const char *const unit[] = {"MiB", "GiB", "TiB"};
  double size = bytes / 0x1p20;
  int u = 0;
  for (; u < 2 && size >= 1023.5; u++)
    size /= 1024;
  snprintf(text, 32, "%.4g %s", size, unit[u]);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static struct { size_t used, max; /* bytes that Lua holds and may hold; max 0: no limit */ } held;

/* As lua_Alloc asks: shrinking never fails. */
static void *allocate(void *data, void *block, size_t old, size_t wanted) {
  (void)data;
  if (!block)
    old = 0; /* then it says what kind of object is made */
  if (wanted == 0) {
    held.used -= old;
    free(block);
    return NULL;
  }
  if (wanted > old && wanted - old > held.max - held.used)
    return NULL;
  void *grown = realloc(block, wanted);
  if (!grown)
    return wanted <= old ? block : NULL;
  held.used += wanted - old;
  return grown;
}

static int on_panic(lua_State *L) {
  const char *message = lua_tostring(L, -1);
  fprintf(stderr, "barwright: %s\n", message ? message : "an error outside of every call");
  return 0; /* Lua aborts */
}

lua_State *program_new_state(const program_limits *limits) {
  if (limits->memory <= 0)
    return luaL_newstate();
  held.max = (size_t)limits->memory;
  lua_State *L = lua_newstate(allocate, NULL);
  if (L)
    lua_atpanic(L, on_panic);
  return L;
}

void program_out_of_memory(void) {
  char size[32];
  if (held.max > 0) {
    size_text((double)held.max, size);
    fprintf(stderr, "barwright: not enough memory: the script may use %s (--memory)\n", size);
  } else
    fprintf(stderr, "barwright: not enough memory\n");
}

static double address_space(void) {
  char text[64] = "";
  int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  ssize_t got = file >= 0 ? read(file, text, sizeof text - 1) : -1;
  if (file >= 0)
    close(file);
  return got > 0 ? strtod(text, NULL) * (double)sysconf(_SC_PAGESIZE) : 0;
}

static void limit_memory(double bytes) {
  double present = address_space();
  struct rlimit space;
  if (bytes <= 0 || present <= 0 || getrlimit(RLIMIT_AS, &space) != 0)
    return;
  mallopt(M_ARENA_MAX, 1); /* each further one reserves 128 MiB of addresses */
  double wanted = present + bytes;
  if (wanted < 9e18 && (space.rlim_cur == RLIM_INFINITY || wanted < (double)space.rlim_cur)) {
    space.rlim_cur = (rlim_t)wanted;
    setrlimit(RLIMIT_AS, &space);
  }
}

/* ---- the parent ------------------------------------------------------------------------------ */

static volatile pid_t watched;
static volatile sig_atomic_t asked_to_end;

/* What a terminal sends, the child gets by itself. */
static void pass_on(int number, siginfo_t *about, void *context) {
  (void)context;
  if (number != SIGINT && number != SIGQUIT)
    asked_to_end = number;
  if (about->si_code == SI_USER || number == SIGTERM)
    kill(watched, number);
}

static void catch_signals(void) {
  static const int list[] = {SIGINT, SIGQUIT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2};
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_sigaction = pass_on;
  action.sa_flags = SA_SIGINFO | SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (size_t i = 0; i < sizeof list / sizeof *list; i++)
    sigaction(list[i], &action, NULL);
}

/* Waits for the end of the child, at most this long (negative: for ever): has it ended? */
static bool ends_within(int child, double seconds) {
  double end = bw_seconds() + seconds;
  for (;;) {
    double left = end - bw_seconds();
    int milliseconds = seconds < 0 ? -1 : left <= 0 ? 0 : (int)fmin(1e3 * left + 1, 1e9);
    struct pollfd wait = {child, POLLIN, 0};
    int ready = poll(&wait, 1, milliseconds);
    if (ready > 0)
      return true;
    if (ready < 0 && errno != EINTR)
      return true; /* the wait that follows blocks */
    if (ready == 0 && seconds >= 0 && bw_seconds() >= end)
      return false;
  }
}

static int code_of(int how, bool overdue, const program_limits *limits) {
  const char *clear = isatty(STDERR_FILENO) ? "\r\033[K" : "";
  if (overdue) {
    fprintf(stderr, "%sbarwright: stopped after the %.3g s that --seconds allows\n", clear,
            limits->seconds);
    return PROGRAM_OVERDUE;
  }
  if (WIFEXITED(how))
    return WEXITSTATUS(how);
  int number = WTERMSIG(how);
  if (number == asked_to_end) { /* as the script would have ended without a parent */
    signal(number, SIG_DFL);
    raise(number);
  }
  char size[32];
  size_text(limits->memory, size);
  fprintf(stderr, "%sbarwright: the script was ended by signal %d (%s)%s%s%s\n", clear, number,
          strsignal(number), limits->memory > 0 ? ": probably it needed more than the " : "",
          limits->memory > 0 ? size : "", limits->memory > 0 ? " that --memory allows" : "");
  return EXIT_FAILURE;
}

/* OpenBLAS ends its threads before a fork and would start them again in the child; where memory is
 * too short for their stacks, it goes on without noticing and waits for them for ever at the next
 * fork. With one thread there is nothing to start; the engine has threads of its own. */
static void settle_blas(void) {
  static void (*set_threads)(int);
  void *symbol = dlsym(RTLD_DEFAULT, "openblas_set_num_threads");
  memcpy(&set_threads, &symbol, sizeof symbol);
  if (set_threads)
    set_threads(1);
}

int program_watch(const program_limits *limits) {
  pid_t parent = getpid();
  fflush(NULL);
  settle_blas();
  pid_t child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) /* gone in between */
      _exit(EXIT_FAILURE);
    limit_memory(limits->memory);
    return PROGRAM_CHILD;
  }
  if (child < 0) {
    fprintf(stderr, "barwright: no process for the script: %s\n", strerror(errno));
    return EXIT_FAILURE;
  }
  watched = child;
  catch_signals();
  int ending = pidfd_open(child, 0), how = 0;
  bool overdue = false;
  if (ending >= 0 && limits->seconds > 0 && !ends_within(ending, limits->seconds)) {
    overdue = true;
    kill(child, SIGTERM); /* its handler removes files that are half written */
    if (!ends_within(ending, 1e-3 * GRACE_MILLISECONDS))
      kill(child, SIGKILL);
  } else if (ending < 0 && limits->seconds > 0) {
    fprintf(stderr, "barwright: the time of the script cannot be watched: %s\n", strerror(errno));
    kill(child, SIGKILL);
  }
  while (waitpid(child, &how, 0) < 0 && errno == EINTR)
    ;
  return code_of(how, overdue, limits);
}
