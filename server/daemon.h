/* The program pneulabd, as a function. */
#ifndef PNEULAB_SERVER_DAEMON_H
#define PNEULAB_SERVER_DAEMON_H

/* Does what the arguments of the program ask for and returns its exit status: serves until SIGTERM
 * or SIGINT, runs a command on tokens or the database, or prints a text. Changes of the process:
 * the umask, blocked signals, SIGPIPE ignored, OPENBLAS_NUM_THREADS set. */
int daemon_run(int argc, char **argv);

#endif
