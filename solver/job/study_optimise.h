/* The search behind a study of the sampling "optimise": which members it asks for, and what their
 * results say to it.
 *
 * The members asked for stand in the study's document, as "values" of its parameters: whoever has a
 * document with n of them has n members (study_expand). The search goes in rounds: one member of
 * each start that still runs, then their results, then the next. It keeps no state but these: a new
 * search that is told the same results asks for the same members, which is how an interrupted study
 * goes on. */
#ifndef PNEULAB_JOB_STUDY_OPTIMISE_H
#define PNEULAB_JOB_STUDY_OPTIMISE_H

#include <jansson.h>
#include "solver/job/spec.h"

struct study_search;

/* Whether the sampling of the document is "optimise". */
bool study_is_search(const json_t *document);

/* Prepares such a study whose document has passed the schema, its defaults filled in and its
 * parameters checked (study_sample): sets the derivatives that its members are to have, and asks
 * for the first round. STATUS_OK; STATUS_INVALID or STATUS_GEOMETRY with the pointer to what has to
 * change; STATUS_NO_MEMORY. */
enum status study_search_begin(const struct job_reader *reader, json_t *document,
                               struct error *error);

/* Takes up a study that study_search_begin has accepted; it may have more members already. Reader
 * and document must outlive *search, which the caller owns. The failures above. */
enum status study_search_create(const struct job_reader *reader, json_t *document,
                                struct study_search **search, struct error *error);
void study_search_destroy(struct study_search *search);

/* Tells the result document of a member, NULL for one that failed. Members in any order, each once.
 * STATUS_OK or STATUS_NO_MEMORY. */
enum status study_search_tell(struct study_search *search, size_t member, const json_t *result,
                              struct error *error);

/* Asks for the next round when all members that the search knows of have been told, and appends it
 * to the document unless it stands there already. *more: whether there is one; without, the search
 * has ended. STATUS_OK, STATUS_INVALID when the document's members are those of another search,
 * STATUS_NO_MEMORY. */
enum status study_search_next(struct study_search *search, bool *more, struct error *error);

/* Members that the search has asked for so far. */
size_t study_search_members(const struct study_search *search);

/* Members that the search may ask for at most. */
size_t study_search_budget(const struct study_search *search);

/* Sets "optimum", "starts" and "history" in the study's result. STATUS_OK or STATUS_NO_MEMORY. */
enum status study_search_report(const struct study_search *search, json_t *document);

#endif
