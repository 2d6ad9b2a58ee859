/* What the load clients share: sockets, times, percentiles. */
#ifndef PNEULAB_BENCH_LOAD_NET_H
#define PNEULAB_BENCH_LOAD_NET_H

#include <stddef.h>
#include <stdint.h>

/* Milliseconds of a clock that never jumps. */
double load_now_ms(void);

/* A non-blocking TCP socket that connects to host:port (numeric IPv4) from the address `from`, or
 * from any when it is NULL. -1 on failure. */
int load_connect(const char *host, int port, const char *from);

/* Raises the soft limit of open files to `wanted` if the hard limit allows it. */
void load_descriptors(size_t wanted);

/* The value below which a share of the values lies; sorts them. NAN when there are none. */
double load_percentile(double *values, size_t count, double share);

#endif
