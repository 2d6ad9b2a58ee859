/* The files of a grasp:
 *   surface-NNNN.vtu   skin of finger 1: displacement, stretch, stress, contact pressure;
 *                      finger-K-surface-NNNN.vtu that of finger K, where it was computed
 *   object-NNNN.vtu    the object's surface, where it then is, in the frame of finger 1
 *   *.pvd              the lists of them by the time of the course in s
 *   grasp.bin, moments.bin   what the pages show (solver/post/grasp_frames.h)
 *   samples.csv        the samples of the result */
#ifndef PNEULAB_GRASP_FILES_H
#define PNEULAB_GRASP_FILES_H

#include <jansson.h>
#include "solver/grasp/gripper.h"

struct grasp_files;

/* Files go into `directory`, which is there. All arguments outlive the files. The caller owns *out.
 * STATUS_NO_MEMORY. */
enum status grasp_files_create(const struct gripper *gripper, const char *directory,
                               struct grasp_files **out, struct error *error);
void grasp_files_destroy(struct grasp_files *files);

/* The states to come are those of this finger, of number `number`, which outlives them. STATUS_OK
 * or NO_MEMORY. */
enum status grasp_files_begin(struct grasp_files *files, int number, const struct finger *finger,
                              struct error *error);

/* Takes in a state that the finger was just measured in. Of those recorded every so many become
 * frames, and the ends of the stages. STATUS_IO or NO_MEMORY. */
enum status grasp_files_add(struct grasp_files *files, const struct grasp_sample *sample,
                            struct error *error);

/* Writes what is written at the end, and appends the names of all files to `artifacts`. samples is
 * that of the result. STATUS_IO or NO_MEMORY. */
enum status grasp_files_finish(struct grasp_files *files, const json_t *samples, json_t *artifacts,
                               struct error *error);

#endif
