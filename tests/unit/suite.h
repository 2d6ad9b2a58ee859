/* Common parts of the unit tests of solver/base and solver/job. */
#ifndef PNEULAB_TESTS_UNIT_SUITE_H
#define PNEULAB_TESTS_UNIT_SUITE_H

#include <check.h>
#include "solver/job/spec.h"

/* Runs a suite, frees it and returns the exit code of the test program. */
int suite_run(Suite *suite);

/* An unchecked fixture: one reader for all tests of a suite that read jobs by what follows, so that
 * not each of them makes its own. */
void suite_share_reader(void);
void suite_drop_reader(void);

/* Reads a valid job (7 chambers B, 5 C, channel, lateral tapers of 2 deg) after one change:
 * the member that `pointer` names (no escapes) becomes the JSON `value`, or goes when it is NULL.
 * A NULL `pointer` changes nothing. */
enum status suite_read_changed(const char *pointer, const char *value, struct job_spec *spec,
                               struct error *error);

/* The same after several changes: pairs of pointer and value, ended by a NULL pointer. */
enum status suite_read_edited(const char *const (*edits)[2], struct job_spec *spec,
                              struct error *error);

/* The same for another job than that, the text `base`. */
enum status suite_read_document(const char *base, const char *const (*edits)[2],
                                struct job_spec *spec, struct error *error);

/* The first two of them, asserting that the job is valid. */
void suite_must_read(const char *pointer, const char *value, struct job_spec *spec);
void suite_must_read_edited(const char *const (*edits)[2], struct job_spec *spec);

/* Asserts that the value is the wanted one to a relative 1e-12. */
void suite_check_near(double value, double wanted);

/* One change that has to be refused. */
struct refusal {
  const char *pointer, *value; /* as in suite_read_changed */
  enum status status;
  const char *at;     /* pointer of the error */
  const char *phrase; /* part of its message */
};

/* Asserts that the change is refused as described, with a place in the text. */
void suite_check_refusal(const struct refusal *refusal);

/* A job with a few changes, which is taken, or refused with a message that says what is allowed,
 * and maybe an example, which is JSON. */
struct variant {
  const char *base;        /* text of a job; NULL: that of suite_read_changed */
  const char *edits[5][2]; /* as in suite_read_edited */
  const char *at;          /* pointer of the error; NULL: the job is taken */
  const char *phrase;      /* part of its message */
};

/* Asserts that the job is taken or refused as described. */
void suite_check_variant(const struct variant *variant);

#endif
