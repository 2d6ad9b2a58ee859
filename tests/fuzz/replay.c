/* Runs a fuzz target over the files of its corpus: tests/fuzz/corpus/TARGET below $srcdir, TARGET
 * from the program's name (fuzz_TARGET), or the directory that is given. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/fuzz.h"

static int replay_file(const char *path) {
  FILE *file = fopen(path, "rb");
  if (!file) {
    perror(path);
    return -1;
  }
  static uint8_t data[2 << 20];
  size_t size = fread(data, 1, sizeof data, file);
  fclose(file);
  uint8_t *exact = malloc(size + 1); /* so that a sanitizer sees reads beyond the end */
  if (!exact) {
    return -1;
  }
  memcpy(exact, data, size);
  int result = LLVMFuzzerTestOneInput(exact, size);
  free(exact);
  return result;
}

int main(int argc, char **argv) {
  char directory[1000], path[2000];
  const char *target = strrchr(argv[0], '/');
  target = strstr(target ? target : argv[0], "fuzz_");
  const char *source = getenv("srcdir");
  if (argc > 1) {
    snprintf(directory, sizeof directory, "%s", argv[1]);
  } else {
    snprintf(directory, sizeof directory, "%s/tests/fuzz/corpus/%s", source ? source : ".",
             target ? target + strlen("fuzz_") : "");
  }
  DIR *listing = opendir(directory);
  if (!listing) {
    perror(directory);
    return EXIT_FAILURE;
  }
  int replayed = 0, failed = 0;
  for (const struct dirent *entry; (entry = readdir(listing));) {
    if (entry->d_name[0] != '.') {
      snprintf(path, sizeof path, "%s/%s", directory, entry->d_name);
      failed += replay_file(path) != 0;
      replayed++;
    }
  }
  closedir(listing);
  printf("%d inputs, %d failed\n", replayed, failed);
  return replayed > 0 && failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
