/* The stress-strain curve of a job: from the text of a table to engineering strain and stress. */
#ifndef PNEULAB_JOB_TENSILE_H
#define PNEULAB_JOB_TENSILE_H

#include "solver/job/spec.h"

struct tensile_curve {
  size_t count;
  double *strain;     /* engineering, within the range of the fit, in the order of the table */
  double *stress;     /* engineering, Pa */
  bool stress_driven; /* the stresses are evenly spaced and the strains are not, which is what
                       * exchanged columns of a pulling machine look like */
};

/* Reads the curve that the fit asks for from "data" of the job's document, with the theory of the
 * incompressible body: engineering stress = true stress / stretch, stretch = 1 + engineering strain
 * = exp(true strain) = 1 + extension / gauge. The caller releases *curve.
 * STATUS_INVALID with the pointer and, where one is to blame, the line of the table: what
 * table_read refuses; values that no strain of an elastomer has (stretch not in 0 to 50); names
 * of columns that say the opposite of what they are used for; a curve that falls, that is far from
 * zero where the strain is, that is no elastomer's (secant modulus not in 100 Pa to 1 GPa), whose
 * strain goes back while its stress never does; fewer points in the range than coefficients + 2.
 * STATUS_TOO_LARGE, NO_MEMORY. */
enum status tensile_read(const json_t *document, const struct fit_spec *fit,
                         struct tensile_curve *curve, struct error *error);
void tensile_release(struct tensile_curve *curve);

#endif
