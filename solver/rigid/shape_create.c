/* The shapes from their sizes, which are checked. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/rigid/profile.h"
#include "solver/rigid/shape_internal.h"

#define PI 3.14159265358979323846
#define SIZE_SMALLEST 1e-4 /* m */
#define SIZE_LARGEST 10.0

static enum status check_size(double size, const char *name, const char *pointer,
                              struct error *error) {
  if (size >= SIZE_SMALLEST && size <= SIZE_LARGEST) {
    return STATUS_OK;
  }
  return error_set(error, STATUS_INVALID, pointer,
                   "the %s of the object is %g mm\nfrom 0.1 mm to 10 m\n\"40 mm\"", name,
                   1e3 * size);
}

/* A body of revolution of checked pieces. */
static enum status revolve(enum rigid_kind kind, const struct meridian_piece *piece, int count,
                           struct rigid_shape **shape, struct error *error) {
  enum status status = rigid_shape_allocate(kind, shape, error);
  if (status == STATUS_OK && meridian_init(&(*shape)->meridian, piece, count) != STATUS_OK) {
    rigid_shape_destroy(*shape);
    *shape = NULL;
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a body of revolution");
  }
  return status;
}

static enum status revolve_profile(enum rigid_kind kind, const double (*point)[2], int count,
                                   enum rigid_profile form, double edge, struct rigid_shape **shape,
                                   struct error *error) {
  struct meridian_piece *piece = malloc(sizeof *piece * MERIDIAN_PIECES);
  int pieces = 0;
  if (!piece) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a profile");
  }
  enum status status = profile_pieces(point, count, form, edge, piece, &pieces, error);
  if (status == STATUS_OK) {
    status = revolve(kind, piece, pieces, shape, error);
  }
  free(piece);
  return status;
}

enum status rigid_shape_create_plane(struct rigid_shape **shape, struct error *error) {
  return rigid_shape_allocate(RIGID_PLANE, shape, error);
}

enum status rigid_shape_create_sphere(double diameter, struct rigid_shape **shape,
                                      struct error *error) {
  enum status status = check_size(diameter, "diameter", "/diameter", error);
  if (status == STATUS_OK) {
    double r = 0.5 * diameter;
    struct meridian_piece half =
        meridian_piece_make((double[2]){-r, 0}, (double[2]){0, 1}, 1 / r, acos(-1) * r);
    status = revolve(RIGID_SPHERE, &half, 1, shape, error);
  }
  if (status == STATUS_OK) {
    (*shape)->radius = 0.5 * diameter;
  }
  return status;
}

/* The largest rounding of both edges that cone, base and tip have room for. */
static double largest_rim(double base, double tip, double length) {
  double slope = atan2(tip - base, length);
  double at_base = tan(0.25 * PI - 0.5 * slope), at_tip = tan(0.25 * PI + 0.5 * slope);
  double side = hypot(length, tip - base) / (at_base + at_tip);
  return fmin(side, fmin(base / at_base, tip / at_tip));
}

/* A cylinder or frustum; the rim may be the largest one but for round-off. */
static enum status create_conical(enum rigid_kind kind, double base, double tip, double length,
                                  double rim, struct rigid_shape **shape, struct error *error) {
  double most = largest_rim(base, tip, length);
  if (!(rim >= 0 && rim <= most * (1 + 1e-9))) {
    return error_set(error, STATUS_INVALID, "/rim",
                     "the rim of the %s is rounded by %g mm\nfrom 0 (sharp) to %g mm, for which it "
                     "has room\n\"%.2g mm\"",
                     kind == RIGID_CYLINDER ? "cylinder" : "frustum", 1e3 * rim, 1e3 * most,
                     0.1e3 * most);
  }
  const double point[2][2] = {{-0.5 * length, base}, {0.5 * length, tip}};
  return revolve_profile(kind, point, 2, RIGID_PROFILE_STRAIGHT, fmin(rim, most), shape, error);
}

enum status rigid_shape_create_cylinder(double diameter, double length, double rim,
                                        struct rigid_shape **shape, struct error *error) {
  enum status status = check_size(diameter, "diameter", "/diameter", error);
  if (status == STATUS_OK) {
    status = check_size(length, "length", "/length", error);
  }
  return status == STATUS_OK ? create_conical(RIGID_CYLINDER, 0.5 * diameter, 0.5 * diameter,
                                              length, rim, shape, error)
                             : status;
}

enum status rigid_shape_create_frustum(double base_diameter, double tip_diameter, double length,
                                       double rim, struct rigid_shape **shape,
                                       struct error *error) {
  enum status status = check_size(base_diameter, "base diameter", "/base_diameter", error);
  if (status == STATUS_OK) {
    status = check_size(tip_diameter, "tip diameter", "/tip_diameter", error);
  }
  if (status == STATUS_OK) {
    status = check_size(length, "length", "/length", error);
  }
  return status == STATUS_OK ? create_conical(RIGID_FRUSTUM, 0.5 * base_diameter,
                                              0.5 * tip_diameter, length, rim, shape, error)
                             : status;
}

enum status rigid_shape_create_box(const double size[3], double edge, struct rigid_shape **shape,
                                   struct error *error) {
  static const char *const names[3] = {"size along x", "size along y", "size along z"},
                           *const pointers[3] = {"/size/0", "/size/1", "/size/2"};
  enum status status = STATUS_OK;
  for (int i = 0; i < 3 && status == STATUS_OK; i++) {
    status = check_size(size[i], names[i], pointers[i], error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  double most = 0.5 * fmin(size[0], fmin(size[1], size[2]));
  if (!(edge >= 0 && edge <= most)) {
    return error_set(error, STATUS_INVALID, "/edge",
                     "the edges of the box are rounded by %g mm\nfrom 0 (sharp) to %g mm, half of "
                     "its shortest size\n\"%.2g mm\"",
                     1e3 * edge, 1e3 * most, 0.1e3 * most);
  }
  status = rigid_shape_allocate(RIGID_BOX, shape, error);
  if (status == STATUS_OK) {
    struct rounded_box *box = &(*shape)->box;
    box->edge = edge;
    for (int i = 0; i < 3; i++) {
      box->core[i] = fmax(0, 0.5 * size[i] - edge);
    }
  }
  return status;
}

enum status rigid_shape_create_revolution(const double (*point)[2], int count,
                                          enum rigid_profile form, double edge,
                                          struct rigid_shape **shape, struct error *error) {
  return revolve_profile(RIGID_REVOLUTION, point, count, form, edge, shape, error);
}

enum status rigid_shape_create_surface(const struct stl *stl, double unit, double crease,
                                       struct rigid_shape **shape, struct error *error) {
  if (!(unit > 0 && unit <= SIZE_LARGEST)) {
    return error_set(error, STATUS_INVALID, "/unit",
                     "the unit of the surface is %g mm\nabove 0, at most 10 m\n\"mm\"", 1e3 * unit);
  }
  if (!(crease >= 0 && crease <= PI)) {
    return error_set(error, STATUS_INVALID, "/crease",
                     "edges of the surface stay sharp from %g degrees on\nfrom 0 (all of them) to "
                     "180 degrees (none)\n\"40 deg\"",
                     crease * 180 / PI);
  }
  struct rigid_shape *made = NULL;
  enum status status = rigid_shape_allocate(RIGID_SURFACE, &made, error);
  if (status == STATUS_OK) {
    status = surface_create(stl, unit, crease, &made->surface, error);
  }
  if (status != STATUS_OK) {
    rigid_shape_destroy(made);
    return status;
  }
  *shape = made;
  return STATUS_OK;
}
