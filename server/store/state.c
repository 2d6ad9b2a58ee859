#include "server/store/state.h"

#include <string.h>

static const struct {
  const char *word;
  bool terminal;
} states[JOB_STATE_COUNT] = {
#define JOB_STATE_ROW(name, word, terminal) {word, terminal},
    JOB_STATE_LIST(JOB_STATE_ROW)
#undef JOB_STATE_ROW
};

const char *job_state_word(enum job_state state) {
  return states[state].word;
}

bool job_state_terminal(enum job_state state) {
  return states[state].terminal;
}

bool job_state_parse(const char *word, enum job_state *state) {
  for (int i = 0; i < JOB_STATE_COUNT; i++) {
    if (strcmp(states[i].word, word) == 0) {
      *state = (enum job_state)i;
      return true;
    }
  }
  return false;
}
