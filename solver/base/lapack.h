/* LAPACK as the BLAS library brings it, which has no header of its own: the routines in use.
 * Matrices column by column. */
#ifndef PNEULAB_BASE_LAPACK_H
#define PNEULAB_BASE_LAPACK_H

/* Eigenvalues to be sorted first, for dgges_. */
typedef int lapack_select(const double *alpha_r, const double *alpha_i, const double *beta);

/* General systems. */
void dgesv_(const int *n, const int *columns, double *a, const int *lead, int *pivot, double *b,
            const int *lead_b, int *info);

/* Symmetric positive definite systems, by Cholesky factors. */
void dposv_(const char *triangle, const int *n, const int *columns, double *a, const int *lead,
            double *b, const int *lead_b, int *info);

/* Symmetric indefinite systems. */
void dsysv_(const char *triangle, const int *n, const int *columns, double *a, const int *lead,
            int *pivot, double *b, const int *lead_b, double *work, const int *work_size,
            int *info);

/* Eigenvalues of symmetric matrices, ascending. */
void dsyev_(const char *job, const char *triangle, const int *n, double *a, const int *lead,
            double *value, double *work, const int *work_size, int *info);

/* Eigenvalues of general matrices. */
void dgeev_(const char *left, const char *right, const int *n, double *a, const int *lead,
            double *real, double *imaginary, double *vl, const int *lead_l, double *vr,
            const int *lead_r, double *work, const int *work_size, int *info);

/* Generalised Schur form. */
void dgges_(const char *left, const char *right, const char *sort, lapack_select *select,
            const int *n, double *a, const int *lead_a, double *b, const int *lead_b, int *selected,
            double *alpha_r, double *alpha_i, double *beta, double *vsl, const int *lead_l,
            double *vsr, const int *lead_r, double *work, const int *work_size, int *flags,
            int *info);

#endif
