/* Which dimensions of a bellows exclude each other. Lengths in messages are in mm. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/job/snap.h"

/* Silicone that has to be left on each side of the PET, and free radius at the inner crests. */
static const double silicone_minimum = 5e-5, bore_minimum = 2e-4;
/* What a length may miss by rounding, relative. */
static const double rounding = 1e-6;
/* The inner face of a hinge's arc is at least this part of its middle line's radius from its
 * centre: elements there would be slivers otherwise. */
static const double core = 0.05;
/* Least straight part, as a part of the wall's thickness. */
static const double slant_minimum = 0.1;

static double to_mm(double metres) {
  return metres * 1e3;
}

static double to_deg(double radians) {
  return radians * 180.0 / M_PI;
}

double snap_hinge_radius(const struct snap_spec *spec, double snapping) {
  return spec->hinge_length / (M_PI - snapping - spec->supporting_angle);
}

/* How far an arc of the radius q leads from its crest to a shell of base angle `angle`. */
static double arc_depth(double q, double angle) {
  return q * (1.0 - sin(angle));
}

/* Slant of the supporting shell above a snapping one that makes the next outer crest as wide; next:
 * angle of the next snapping shell. */
static double closing_slant(const struct snap_spec *s, double angle, double slant, double next) {
  double q = snap_hinge_radius(s, angle), beyond = snap_hinge_radius(s, next);
  double inward = slant * cos(angle) + 2.0 * arc_depth(q, angle);
  return (inward - arc_depth(q + beyond, s->supporting_angle)) / cos(s->supporting_angle);
}

static enum status check_walls(const struct snap_spec *s, struct error *error) {
  const struct snap_given *g = &s->given;
  if (g->snapping_angle >= g->supporting_angle) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/snapping_angle",
                     "the shells that snap have a base angle of %.6g deg\na smaller angle than the "
                     "%.6g deg of the supporting ones; for example \"40 deg\" and \"55 deg\"",
                     to_deg(g->snapping_angle), to_deg(g->supporting_angle));
  }
  double thinnest = fmin(s->wall, s->hinge_wall), thickest = fmax(s->wall, s->hinge_wall);
  for (int k = 0; k < s->pair_count; k++) {
    const struct snap_pair *p = &s->pair[k];
    if (p->pet_thickness + 2.0 * silicone_minimum > thinnest) {
      return error_set(error, STATUS_GEOMETRY,
                       s->hinge_wall < s->wall ? "/actuator/hinge_wall" : "/actuator/wall",
                       "PET of %.6g mm and 0.05 mm of silicone on each side of it do not fit into "
                       "a wall of %.6g mm\nit must be at least %.6g mm thick",
                       to_mm(p->pet_thickness), to_mm(thinnest),
                       to_mm(p->pet_thickness + 2.0 * silicone_minimum));
    }
    double turn = M_PI - p->snapping_angle - s->supporting_angle;
    double least = 0.5 * thickest * turn / (1.0 - core);
    if (s->hinge_length < least) {
      return error_set(error, STATUS_GEOMETRY, "/actuator/hinge_length",
                       "a hinge of %.6g mm that turns by %.6g deg is too short for a wall of %.6g "
                       "mm, whose inner face it would fold\nat least \"%.3f mm\"",
                       to_mm(s->hinge_length), to_deg(turn), to_mm(thickest),
                       ceil(to_mm(least) * 1e3) / 1e3);
    }
  }
  return STATUS_OK;
}

static enum status check_bore(const struct snap_spec *s, double radius, double inward, int k,
                              struct error *error) {
  const struct snap_pair *p = &s->pair[k];
  double half = 0.5 * fmax(s->wall, s->hinge_wall);
  double free = radius - inward - half - bore_minimum;
  if (free >= 0.0) {
    return STATUS_OK;
  }
  double most = s->given.snapping_slant + free / cos(p->snapping_angle);
  if (most <= 0.0) {
    return error_set(
        error, STATUS_GEOMETRY, "/actuator/outer_diameter",
        "a body of %.6g mm is too narrow for hinges of %.6g mm and walls of %.6g mm\na wider one: "
        "their inner crests would cross the axis",
        to_mm(s->given.outer_diameter), to_mm(s->hinge_length), to_mm(2.0 * half));
  }
  return error_set(error, STATUS_GEOMETRY, "/actuator/snapping_slant",
                   "shells of %.6g mm at %.6g deg reach across the axis\ntheir slant must be below "
                   "%.6g mm in a body of %.6g mm",
                   to_mm(p->snapping_slant), to_deg(p->snapping_angle), to_mm(most),
                   to_mm(s->given.outer_diameter));
}

/* Slant of the supporting shell of the pair k, or of the one for mounting (-1). */
static enum status support(const struct snap_spec *s, int k, double *slant, struct error *error) {
  const struct snap_given *g = &s->given;
  bool last = k + 1 == s->pair_count;
  double angle = k < 0 ? g->snapping_angle : s->pair[k].snapping_angle;
  double next = last ? (s->ends == SNAP_PERIODIC ? s->pair[0].snapping_angle : g->snapping_angle)
                     : s->pair[k + 1].snapping_angle;
  double closing =
      closing_slant(s, angle, k < 0 ? g->snapping_slant : s->pair[k].snapping_slant, next);
  *slant = isnan(g->supporting_slant) ? closing : g->supporting_slant;
  /* The shells that snap are less steep, so that their arcs lead further: (1 - sin(a)) / (pi - a -
   * b) is more than (1 - sin(b)) / (pi - 2 b) where a < b. */
  assert(*slant > 0.0);
  if (s->ends == SNAP_PERIODIC && fabs(*slant - closing) > rounding * closing) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/supporting_slant",
                     "an endless row needs equally wide crests\nsupporting shells of %.6f mm, not "
                     "%.6g mm; leave the key out, or give \"ends\": \"plates\"",
                     to_mm(closing), to_mm(*slant));
  }
  return STATUS_OK;
}

/* A straight part much shorter than the wall is thick would make slivers of elements. */
static enum status check_slant(const struct snap_spec *s, const char *pointer, double slant,
                               struct error *error) {
  double least = slant_minimum * s->wall;
  if (slant >= least) {
    return STATUS_OK;
  }
  return error_set(
      error, STATUS_GEOMETRY, pointer,
      "a straight part of %.6g mm is too short for a wall of %.6g mm\nat least %.6g mm",
      to_mm(slant), to_mm(s->wall), to_mm(least));
}

static enum status derive_supports(struct snap_spec *s, struct error *error) {
  double radius = s->crest_radius, shortest = INFINITY;
  enum status status = STATUS_OK;
  for (int k = 0; status == STATUS_OK && k < s->pair_count; k++) {
    struct snap_pair *p = &s->pair[k];
    status = support(s, k, &p->supporting_slant, error);
    double inward = p->snapping_slant * cos(p->snapping_angle) +
                    2.0 * arc_depth(snap_hinge_radius(s, p->snapping_angle), p->snapping_angle);
    if (status == STATUS_OK) {
      status = check_bore(s, radius, inward, k, error);
      radius +=
          (p->supporting_slant - closing_slant(s, p->snapping_angle, p->snapping_slant,
                                               s->pair[(k + 1) % s->pair_count].snapping_angle)) *
          cos(s->supporting_angle);
      shortest = fmin(shortest, p->supporting_slant);
    }
  }
  if (status == STATUS_OK && s->ends == SNAP_PLATES) {
    status = support(s, -1, &s->mounting_slant, error);
    shortest = fmin(shortest, s->mounting_slant);
  }
  double pet = s->given.supporting_pet;
  if (status == STATUS_OK) {
    status =
        check_slant(s, "/actuator/snapping_slant", fmin(shortest, s->given.snapping_slant), error);
  }
  if (status == STATUS_OK && !isnan(pet)) {
    status = check_slant(s, "/actuator/supporting_pet", pet, error);
  }
  if (status == STATUS_OK && !isnan(pet) && pet > shortest) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/supporting_pet",
                     "%.6g mm of PET do not fit into the supporting shells\nat most their %.6g mm",
                     to_mm(pet), to_mm(shortest));
  }
  s->supporting_pet = isnan(pet) ? INFINITY : pet;
  return status;
}

enum status snap_derive(struct snap_spec *spec, struct error *error) {
  const struct snap_given *g = &spec->given;
  spec->wall = g->wall;
  spec->hinge_wall = isnan(g->hinge_wall) ? g->wall : g->hinge_wall;
  spec->hinge_length = g->hinge_length;
  spec->supporting_angle = g->supporting_angle;
  /* The crest is not quite in the middle of the hinge. */
  double place =
      (0.5 * M_PI - g->supporting_angle) / (M_PI - g->snapping_angle - g->supporting_angle);
  double bump = sin(M_PI * place);
  double crest = spec->wall + (spec->hinge_wall - spec->wall) * bump * bump;
  spec->crest_radius = 0.5 * (g->outer_diameter - crest);
  double shear = 0.5 * g->pet_modulus / (1.0 + g->pet_poisson);
  spec->pet.model = MATERIAL_NEO_HOOKE;
  spec->pet.terms = 1;
  spec->pet.c[0] = shear;
  spec->pet.bulk_ratio = g->pet_modulus / (3.0 * (1.0 - 2.0 * g->pet_poisson)) / shear;
  for (int k = 0; k < spec->pair_count; k++) {
    spec->pair[k] = (struct snap_pair){
        .snapping_angle = g->snapping_angle * g->angle_factor[k],
        .snapping_slant = g->snapping_slant * g->slant_factor[k],
        .pet_thickness = g->pet_thickness * g->pet_factor[k],
    };
    if (spec->pair[k].snapping_angle >= g->supporting_angle) {
      char pointer[60];
      snprintf(pointer, sizeof pointer, "/actuator/imperfection/snapping_angle/%d", k);
      bool order = g->snapping_angle < g->supporting_angle;
      return order ? error_set(error, STATUS_GEOMETRY, pointer,
                               "a factor of %.6g makes the snapping shell as steep as the "
                               "supporting one\nbelow %.6g",
                               g->angle_factor[k], g->supporting_angle / g->snapping_angle)
                   : check_walls(spec, error);
    }
  }
  enum status status = check_walls(spec, error);
  return status == STATUS_OK ? derive_supports(spec, error) : status;
}

enum status snap_set(struct snap_spec *spec, double value, struct error *error) {
  memcpy((char *)&spec->given + spec->calibrate.offset, &value, sizeof value);
  return snap_derive(spec, error);
}
