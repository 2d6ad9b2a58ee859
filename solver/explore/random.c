#include "solver/explore/random.h"

uint64_t random_mix(uint64_t x) {
  x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
  return x ^ (x >> 31);
}

uint64_t random_next(uint64_t *state) {
  *state += UINT64_C(0x9e3779b97f4a7c15);
  return random_mix(*state);
}

double random_uniform(uint64_t *state) {
  return (double)(random_next(state) >> 11) * 0x1p-53;
}

uint64_t random_below(uint64_t *state, uint64_t count) {
  /* Numbers beyond the last whole multiple of `count` would favour the small ones. */
  uint64_t limit = UINT64_MAX - UINT64_MAX % count, drawn;
  do {
    drawn = random_next(state);
  } while (drawn >= limit);
  return drawn % count;
}

void random_permutation(uint64_t *state, int count, int order[]) {
  for (int i = 0; i < count; i++) {
    order[i] = i;
  }
  for (int i = count - 1; i > 0; i--) {
    int other = (int)random_below(state, (uint64_t)i + 1), kept = order[i];
    order[i] = order[other];
    order[other] = kept;
  }
}
