/* What the process has used: clocks and memory. */
#ifndef PNEULAB_BASE_CLOCK_H
#define PNEULAB_BASE_CLOCK_H

/* CPU time of the process in s. */
double clock_cpu_s(void);
/* Monotonic wall-clock time in s from an arbitrary start. */
double clock_wall_s(void);
/* Largest resident memory of the process so far, MB (1e6 bytes). */
double clock_peak_memory_MB(void);

#endif
