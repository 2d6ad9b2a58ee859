/* `pneulabd token ...`: the tokens of a data directory, from a shell. */
#ifndef PNEULAB_AUTH_TOKEN_COMMAND_H
#define PNEULAB_AUTH_TOKEN_COMMAND_H

/* Runs the command whose first word is argv[0] ("token"). Prints secrets and lists on standard
 * output, what is wrong on standard error. The exit status: 0, 1 when it failed, 2 when the
 * command line is wrong. A daemon that uses the directory follows within a second. */
int token_command(int argc, char **argv);

#endif
