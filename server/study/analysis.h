/* What the members of a study say together. Each function makes the answer of one request as a JSON
 * object (schema/openapi.yaml describes them), a new reference in *answer; failed members are left
 * out and counted. STATUS_OK, STATUS_INVALID for a request that cannot be answered, or
 * STATUS_NO_MEMORY. All are the same for the same data. */
#ifndef PNEULAB_STUDY_ANALYSIS_H
#define PNEULAB_STUDY_ANALYSIS_H

#include "server/study/criteria.h"
#include "server/study/model.h"

enum {
  ANALYSIS_LAYERS_MAX = 100,
  ANALYSIS_RESOLUTION_MAX = 65,
  ANALYSIS_DESIGNS_MAX = 10000,
  ANALYSIS_FOUND_MAX = 20
};

/* ---- parts of answers ---------------------------------------------------------------------- */

/* A number, or null for one that is not finite. */
json_t *analysis_number(double value);

/* { "value", "low", "high" } */
struct share;
json_t *analysis_share(const struct share *share);

/* { "key", "title", "unit" } */
json_t *analysis_column(const struct study_column *column);

/* { "member", "job", "name" } of a row. */
json_t *analysis_member(const struct study_table *table, size_t row);

/* STATUS_OK, or STATUS_NO_MEMORY when *answer is NULL. */
enum status analysis_made(json_t *answer, struct error *error);

/* ---- over what is stored ------------------------------------------------------------------- */

/* Members by the weighted mean of their normalised metrics, best first: (v - least) / (most -
 * least) over the members, one less that where the least is best, 0 where all agree. A criterion
 * without a number weighs 1. Members that agree to 1e-9 share a rank. */
enum status analysis_ranking(const struct study_table *table, const struct criterion *criteria,
                             size_t count, size_t limit, json_t **answer, struct error *error);

/* The same form from the block "ranking" of the study's result document: the formula of the paper
 * on the multi-chamber actuator (see solver/explore/ranking.h). STATUS_INVALID when there is none.
 */
enum status analysis_ranking_stored(const struct study_table *table, const json_t *result,
                                    size_t limit, json_t **answer, struct error *error);

/* The first `layers` fronts of the members, and the hypervolume that they dominate up to the
 * references, which are the worst values unless given. Exact as long as that takes little;
 * otherwise an estimate by 2^15 scrambled Sobol' points with its standard error. */
enum status analysis_pareto(const struct study_table *table, const struct criterion *objectives,
                            size_t count, int layers, json_t **answer, struct error *error);

/* ---- by a surrogate ------------------------------------------------------------------------ */

/* Sobol' indices of the surrogate over the ranges of the parameters, which are taken as independent
 * and evenly distributed (of logarithmic ones the logarithm), with 95 % intervals of the
 * integration; and correlations of the members. */
enum status analysis_importance(const struct study_table *table, const struct model *model,
                                size_t metric, json_t **answer, struct error *error);

/* The mean of the surrogate against each parameter over all others, with its 10 % and 90 %
 * quantiles, and the share of the variance that is of pairs of parameters together. */
enum status analysis_effects(const struct study_table *table, const struct model *model,
                             size_t metric, json_t **answer, struct error *error);

/* How good the surrogate is: coefficients, lengths, every point predicted without itself. */
enum status analysis_surrogate(const struct study_table *table, const struct model *model,
                               size_t metric, json_t **answer, struct error *error);

/* Mean and standard deviation along x, or over x and y (columns of parameters; y < 0: none) on
 * `resolution` values each, or all words, the other parameters as in at[parameters], of which those
 * that are NaN are at their middle. */
enum status analysis_slice(const struct study_table *table, const struct model *model,
                           size_t metric, size_t x, int y, int resolution, const double *at,
                           json_t **answer, struct error *error);

#endif
