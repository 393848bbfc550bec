/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Numbers of a factor are double or float. What works on them (front.c, front_assemble.c,
 * triangular.c, fields.c) is written in terms of `real` and compiled twice: as it stands for
 * double, and from single.c, which defines BWI_SINGLE and includes these files, for float. The
 * names that other files see are then other names; bwi_kernels (internal.h) has both. */
#ifndef BWI_LINEAR_REAL_H
#define BWI_LINEAR_REAL_H

#ifdef BWI_SINGLE

typedef float real;
#define KERNELS bwi_kernels_single
#define bwi_matrix_to_panel bwi_matrix_to_panel_single
#define bwi_add_child bwi_add_child_single
#define bwi_front_eliminate bwi_front_eliminate_single
#define bwi_factor_solve bwi_factor_solve_single
#define bwi_solve_fields_of bwi_solve_fields_of_single
#define GEMM sgemm_
#define SYRK ssyrk_
#define POTRF spotrf_
#define FUSED __builtin_fmaf
#define FUSED_512 _mm512_fnmadd_ps
#define FUSED_256 _mm256_fnmadd_ps

#else

typedef double real;
#define KERNELS bwi_kernels_double
#define GEMM dgemm_
#define SYRK dsyrk_
#define POTRF dpotrf_
#define FUSED __builtin_fma
#define FUSED_512 _mm512_fnmadd_pd
#define FUSED_256 _mm256_fnmadd_pd

#endif

#endif
