/* The daemon's own log: one line an event on standard error. */
#ifndef PNEULAB_SERVER_LOG_H
#define PNEULAB_SERVER_LOG_H

/* Writes "2026-11-22T07:33:26.123Z message" in one write, safe from any thread. Control characters
 * become '?', so no input can forge a line. */
void log_line(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
