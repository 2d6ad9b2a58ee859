/* pneulabd: accepts jobs over HTTP, keeps them in SQLite, runs pneulab-solve. */
#include "server/daemon.h"

int main(int argc, char **argv) {
  return daemon_run(argc, argv);
}
