#include "solver/hlpv/accumulation.h"

#include <math.h>

enum { CHATTER_EVENTS = 100, ZENO_EVENTS = 12 };

#define CHATTER_TIME 1e-9
/* The factors of a Zeno sequence agree to this part, below 1 by that, and what remains of it is
 * short against what has passed. A factor nearer to 1 ends at HLPV_EVENTS_MAX. */
#define ZENO_SPREAD 1e-3
#define ZENO_BELOW 1e-3
#define ZENO_REMAINS 1e-3

static bool is_chattering(const struct hlpv_trajectory *trajectory) {
  size_t count = trajectory->event_count;
  return count >= CHATTER_EVENTS &&
         trajectory->event[count - 1].time - trajectory->event[count - CHATTER_EVENTS].time <=
             CHATTER_TIME;
}

/* Times of the last switches by the guard of the last one, latest first. */
static int last_times(const struct hlpv_trajectory *trajectory, double time[ZENO_EVENTS]) {
  int found = 0;
  size_t last = trajectory->event_count - 1;
  for (size_t i = last + 1; i > 0 && found < ZENO_EVENTS; i--) {
    const struct hlpv_event *event = &trajectory->event[i - 1];
    if (event->transition == trajectory->event[last].transition) {
      time[found++] = event->time;
    }
  }
  return found;
}

/* Whether they shrink geometrically; *end: the limit of their times. */
static bool is_zeno(const struct hlpv_trajectory *trajectory, double *end, double *factor) {
  double time[ZENO_EVENTS], low = INFINITY, high = 0.0;
  if (last_times(trajectory, time) < ZENO_EVENTS) {
    return false;
  }
  for (int i = 0; i + 2 < ZENO_EVENTS; i++) {
    double ratio = (time[i] - time[i + 1]) / (time[i + 1] - time[i + 2]);
    low = fmin(low, ratio);
    high = fmax(high, ratio);
  }
  if (!(low > 0.0 && high < 1.0 - ZENO_BELOW && high - low <= ZENO_SPREAD * high)) {
    return false;
  }
  double last = time[0] - time[1];
  *factor = last / (time[1] - time[2]);
  *end = time[0] + last * *factor / (1.0 - *factor);
  return *end - time[0] <= ZENO_REMAINS * (*end - time[ZENO_EVENTS - 1]) ||
         *end - time[0] <= ZENO_REMAINS * *end;
}

enum status accumulation_check(const struct hlpv_trajectory *trajectory, struct error *error) {
  double end = 0.0, factor = 0.0;
  size_t count = trajectory->event_count;
  double time = trajectory->event[count - 1].time;
  if (is_chattering(trajectory)) {
    return error_set(error, STATUS_CHATTERING, NULL,
                     "at %.9g s guards send the state to and fro: %d switches within %g s", time,
                     CHATTER_EVENTS, CHATTER_TIME);
  }
  if (is_zeno(trajectory, &end, &factor)) {
    return error_set(error, STATUS_ZENO, NULL,
                     "the switches accumulate: each interval is %.4g of the one before, so that "
                     "infinitely many come before %.9g s (Zeno behaviour)",
                     factor, end);
  }
  if (count >= HLPV_EVENTS_MAX) {
    return error_set(error, STATUS_EVENTS, NULL,
                     "%d switches were made until %.9g s; no more are followed", HLPV_EVENTS_MAX,
                     time);
  }
  return STATUS_OK;
}
