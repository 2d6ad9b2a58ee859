/* The order of numbers. */
#ifndef PNEULAB_BASE_NUMBERS_H
#define PNEULAB_BASE_NUMBERS_H

/* For qsort of doubles, none of which is NAN: rising. */
int numbers_compare(const void *a, const void *b);

#endif
