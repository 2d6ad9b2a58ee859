/* What solvers have of the daemon's environment, here and on a cluster alike: what decides which
 * kernels of the BLAS run has to be the same, or the last bits of results differ. */
#ifndef PNEULAB_LAUNCH_ENVIRONMENT_H
#define PNEULAB_LAUNCH_ENVIRONMENT_H

/* Names of variables, for the list of an array. */
#define WORKER_VARIABLES                                                                           \
  "PATH", "LANG", "TZ", "OPENBLAS_NUM_THREADS", "OPENBLAS_CORETYPE", "UDUNITS2_XML_PATH",          \
      "ASAN_OPTIONS", "LSAN_OPTIONS", "UBSAN_OPTIONS", "TSAN_OPTIONS"

#endif
