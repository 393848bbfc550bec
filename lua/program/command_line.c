/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What stands before the script or the command on the command line. */
#include "program.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static const char *const known[] = {"-e",     "-i",        "--gc-stress", "--mpi",    "--version",
                                    "--help", "--sandbox", "--memory",    "--seconds"};
enum { KNOWN = sizeof known / sizeof *known };

/* The value of an option "--name VALUE" or "--name=VALUE" at argv[*i], or NULL when it is another
 * one; "" and a message where it is missing. */
static const char *value_of(const char *name, int argc, char **argv, int *i) {
  size_t length = strlen(name);
  const char *word = argv[*i];
  if (strncmp(word, name, length) != 0)
    return NULL;
  if (word[length] == '=')
    return word + length + 1;
  if (word[length])
    return NULL;
  if (*i + 1 < argc)
    return argv[++*i];
  return "";
}

static bool is_folder(const char *path) {
  struct stat about;
  return stat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

/* -1: it is no limit; else whether it could be read. */
static int read_limit(int argc, char **argv, int *i, program_limits *limits) {
  const char *value;
  if ((value = value_of("--sandbox", argc, argv, i))) {
    limits->sandbox = value;
    if (is_folder(value))
      return true;
    fprintf(stderr, "barwright: --sandbox: a folder expected, got '%s'\n", value);
    return false;
  }
  if ((value = value_of("--memory", argc, argv, i))) {
    if (program_read_bytes(value, &limits->memory) && limits->memory >= 0x1p20)
      return true;
    fprintf(stderr,
            "barwright: --memory: a size of at least 1M such as 500M or 2G expected, got '%s'\n",
            value);
    return false;
  }
  if ((value = value_of("--seconds", argc, argv, i))) {
    if (program_read_seconds(value, &limits->seconds))
      return true;
    fprintf(stderr, "barwright: --seconds: a time such as 60 or 5min expected, got '%s'\n", value);
    return false;
  }
  return -1;
}

bool program_read_command(int argc, char **argv, program_command *c) {
  memset(c, 0, sizeof *c);
  c->count = argc;
  c->value = argv;
  int i = 1;
  for (; i < argc && argv[i][0] == '-' && argv[i][1]; i++) {
    int limit = read_limit(argc, argv, &i, &c->limits);
    if (limit == 0)
      return false;
    if (limit == 1)
      continue;
    if (strcmp(argv[i], "-e") == 0 && i + 1 < argc)
      c->statements = argv[++i];
    else if (strcmp(argv[i], "-i") == 0)
      c->prompt = true;
    else if (strcmp(argv[i], "--gc-stress") == 0)
      c->stress = true;
    else if (strcmp(argv[i], "--mpi") == 0)
      c->mpi = true;
    else if (strcmp(argv[i], "--version") == 0 || strcmp(argv[i], "-v") == 0)
      c->version = true;
    else if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0)
      c->help = true;
    else if (strcmp(argv[i], "--") == 0) {
      i++;
      break;
    } else {
      const char *near = lbw_nearest(argv[i], known, KNOWN);
      if (near)
        fprintf(stderr, "barwright: unknown option '%s': did you mean '%s'?\n", argv[i], near);
      else
        fprintf(stderr, "barwright: unknown option '%s': `barwright --help` lists what is known\n",
                argv[i]);
      return false;
    }
  }
  if (c->mpi && c->limits.sandbox) {
    fputs("barwright: --mpi and --sandbox do not go together: ranks talk over the network\n",
          stderr);
    return false;
  }
  c->script_at = i;
  c->script = i < argc ? argv[i] : NULL;
  return true;
}
