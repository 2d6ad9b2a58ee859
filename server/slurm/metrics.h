/* Metrics of the Slurm engine. */
#ifndef PNEULAB_SLURM_METRICS_H
#define PNEULAB_SLURM_METRICS_H

#include <stdio.h>

/* Writes those of an engine (struct slurm) in the text form of Prometheus. */
void slurm_metrics(void *engine, FILE *out);

#endif
