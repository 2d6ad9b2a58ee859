/* What a fuzz target consists of. Built with --enable-fuzzers, libFuzzer calls it; otherwise
 * replay.c does, with the files of the target's corpus. */
#ifndef PNEULAB_TESTS_FUZZ_FUZZ_H
#define PNEULAB_TESTS_FUZZ_FUZZ_H

#include <stddef.h>
#include <stdint.h>

/* Feeds `size` bytes to the code under test; aborts when it misbehaves. Returns 0. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#endif
