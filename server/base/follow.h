/* Follows a file of lines to which another process appends. */
#ifndef PNEULAB_SERVER_BASE_FOLLOW_H
#define PNEULAB_SERVER_BASE_FOLLOW_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* Takes a line, without its end; it is the taker's for the time of the call. */
typedef void follow_taker(void *context, const char *line, size_t size);

/* Hands the complete lines from *offset on to the taker and moves *offset behind them; at most
 * 64 KiB a call, and a line longer than that is skipped. The file is opened anew each time, not
 * through a symbolic link. False when nothing whole was added, or there is no such file. */
bool follow_lines(const char *path, off_t *offset, follow_taker *take, void *context);

#endif
