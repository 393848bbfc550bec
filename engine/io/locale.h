/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The C locale, whatever the process has set: a script in a locale with decimal commas must read
 * and write the same bytes. */
#ifndef BWI_IO_LOCALE_H
#define BWI_IO_LOCALE_H

#include <locale.h>

locale_t bwi_c_locale(void); /* made at the first call; LC_GLOBAL_LOCALE when there is no memory */

#endif
