/* Tells systemd how the daemon is, when it asked for that (Type=notify): datagrams to the socket
 * that NOTIFY_SOCKET names. */
#ifndef PNEULAB_SERVER_NOTIFY_H
#define PNEULAB_SERVER_NOTIFY_H

#include <stdint.h>

/* Sends "READY=1", "STOPPING=1", "WATCHDOG=1" or "STATUS=...". Nothing happens when nobody asked.
 */
void notify_send(const char *state);

/* How often WATCHDOG=1 is to be sent, in ms: half of what systemd waits; 0: never. */
int64_t notify_watchdog_ms(void);

#endif
