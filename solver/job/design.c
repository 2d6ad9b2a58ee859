#include "solver/job/design.h"

#include <math.h>
#include <string.h>

#define PNEUNET(member) offsetof(struct job_spec, pneunet.member)
#define OBLIQUE(member) offsetof(struct job_spec, oblique.member)
#define MATERIAL(member) offsetof(struct job_spec, material.member)
#define LOAD(member) offsetof(struct job_spec, load.member)

static const size_t pneunet_numbers[] = {
    PNEUNET(length),         PNEUNET(cavity_length), PNEUNET(width),     PNEUNET(height_base),
    PNEUNET(height_tip),     PNEUNET(chamber_gap),   PNEUNET(gap_root),  PNEUNET(gap_round),
    PNEUNET(side_wall),      PNEUNET(gap_wall),      PNEUNET(top_wall),  PNEUNET(bottom_layer),
    PNEUNET(slit),           PNEUNET(slit_floor),    PNEUNET(stem),      PNEUNET(channel_width),
    PNEUNET(channel_height), PNEUNET(channel_cover), PNEUNET(taper_top), PNEUNET(taper_bottom),
    PNEUNET(taper_left),     PNEUNET(taper_right)};

static const size_t oblique_numbers[] = {
    OBLIQUE(length),        OBLIQUE(width),          OBLIQUE(height),       OBLIQUE(angle),
    OBLIQUE(cavity),        OBLIQUE(chamber_gap),    OBLIQUE(gap_wall),     OBLIQUE(centre_wall),
    OBLIQUE(side_wall),     OBLIQUE(top_wall),       OBLIQUE(bottom_layer), OBLIQUE(end),
    OBLIQUE(channel_width), OBLIQUE(channel_height), OBLIQUE(channel_cover)};

static const size_t other_numbers[] = {
    MATERIAL(density_kg_m3), MATERIAL(bulk_ratio), LOAD(pressure_to), LOAD(cavity_share[0]),
    LOAD(cavity_share[1]),   LOAD(gravity[0]),     LOAD(gravity[1]),  LOAD(gravity[2])};

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

_Static_assert(COUNT(pneunet_numbers) + COUNT(oblique_numbers) + COUNT(other_numbers) +
                       2 * MATERIAL_TERMS_MAX <=
                   DESIGN_NUMBERS,
               "a point has room for every number");

/* Appends the numbers at these places of the spec. */
static void append(const struct job_spec *spec, const size_t *offset, int count, double *number,
                   int *filled) {
  for (int i = 0; i < count; i++) {
    double value;
    memcpy(&value, (const char *)spec + offset[i], sizeof value);
    number[(*filled)++] = isfinite(value) ? value : 0;
  }
}

void design_numbers(const struct job_spec *spec, double number[DESIGN_NUMBERS]) {
  const struct material_spec *m = &spec->material;
  int filled = 0;
  memset(number, 0, sizeof *number * DESIGN_NUMBERS);
  append(spec, other_numbers, COUNT(other_numbers), number, &filled);
  for (int i = 0; i < MATERIAL_TERMS_MAX; i++, filled += 2) {
    number[filled] = m->c[i];
    number[filled + 1] = m->alpha[i];
  }
  if (spec->family == FAMILY_PNEUNET) {
    append(spec, pneunet_numbers, COUNT(pneunet_numbers), number, &filled);
  } else {
    append(spec, oblique_numbers, COUNT(oblique_numbers), number, &filled);
  }
}
