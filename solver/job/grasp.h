/* A grasp as its job gives it: object, course and numerics, plain data in SI units. The actuator,
 * its material and its load are in struct job_spec as those of a response job.
 *
 * Without fingers everything is in the frame of the actuator: x from its base along it, y across,
 * z up; it bends towards -z. With fingers it is in the frame of the gripper: its x axis is the axis
 * around which the fingers stand, their bases at x = 0. Finger k = 0 .. n-1 is turned about x by
 * 2 pi k / n from that at +z, where the gripper's frame is that of the finger but for a shift by
 * the radius along z and the tilt about y. */
#ifndef PNEULAB_JOB_GRASP_H
#define PNEULAB_JOB_GRASP_H

#include <stdbool.h>
#include <stddef.h>

enum { GRASP_PROFILE_MAX = 64, GRASP_FINGERS_MAX = 6, GRASP_LEGS_MAX = 16 };

enum grasp_form {
  GRASP_SPHERE,
  GRASP_CYLINDER,
  GRASP_FRUSTUM,
  GRASP_BOX,
  GRASP_REVOLUTION,
  GRASP_PLANE,
  GRASP_SURFACE
};

/* In the frame of the object: the middle of spheres, cylinders, frusta and boxes is its origin,
 * axes lie along z. Lengths in m. */
struct grasp_shape {
  enum grasp_form form;
  double diameter;                      /* of a sphere or cylinder */
  double length;                        /* of a cylinder or frustum */
  double base_diameter, tip_diameter;   /* of a frustum, at -z and at +z */
  double size[3];                       /* of a box */
  double rounding;                      /* radius of rims and edges, 0: sharp */
  int profile_count;                    /* of a body of revolution */
  double profile[GRASP_PROFILE_MAX][2]; /* z and radius */
  bool smooth;                          /* a smooth curve through its points, else straight lines */
  unsigned char *stl; /* content of a file, stl_size bytes; NULL but for surfaces */
  size_t stl_size;
  double stl_unit; /* one unit of its coordinates */
  double crease;   /* edges of its triangles stay sharp from this angle on, rad */
};

struct grasp_object {
  struct grasp_shape shape;
  double place[3];       /* of its frame, m */
  double rotation[3][3]; /* from its frame: columns are its axes */
  double friction;       /* Coulomb's coefficient */
  bool free;             /* let go after the inflation */
  double mass;           /* of a free object, kg, spread evenly over its volume */
};

struct grasp_approach {
  double from[3]; /* start less position, m; 0: there is no approach */
  double rate;    /* m/s */
  int steps;      /* recorded */
};

/* A part of the way on which a pull leads the object: it is shifted and turned at one pace. */
struct grasp_leg {
  double move[3]; /* m */
  double turn[3]; /* rotation vector about the place of its frame, rad; its length may be any */
  double seconds;
};

/* A fixed object is led along legs, a free one is drawn by a force; without either no pull. */
struct grasp_pull {
  int leg_count;
  struct grasp_leg leg[GRASP_LEGS_MAX];
  double direction[3];  /* of the force, or of a straight pull; of length 1 */
  double force;         /* N, what it rises to */
  int steps;            /* recorded, of all legs together */
  double after_contact; /* part of the pull that goes on after contact is lost */
};

struct grasp_fingers {
  int count; /* 1: there is no gripper */
  double radius, tilt;
};

struct grasp_spec {
  struct grasp_object object; /* with `blocked` the plate, which faces the tip */
  bool blocked;
  double blocked_distance;     /* m, of the plate from the end of the bottom centreline at rest */
  double blocked_direction[3]; /* of length 1 */
  struct grasp_approach approach;
  double inflation_time; /* s */
  struct grasp_pull pull;
  bool release;
  struct grasp_fingers fingers;
  double gravity[3];   /* m/s2, in the same frame */
  bool dynamics;       /* jumps are followed */
  double damping_time; /* viscosity by shear modulus, s; NAN: that of the body */
  double longest_step; /* of the object, m */
  double stiffness;    /* factor of that of the contact with the object */
};

/* Releases a spec with what it owns; NULL is fine. */
void grasp_spec_destroy(struct grasp_spec *spec);

/* The same grasp in the frame of a finger, which must be below fingers.count: object, ways and
 * gravity. What the spec owns is shared. */
struct grasp_spec grasp_of_finger(const struct grasp_spec *spec, int finger);

/* Whether the grasp has a pull. */
bool grasp_pulls(const struct grasp_spec *spec);

/* Whether two fingers see the same: object, ways and gravity in their frames agree. */
bool grasp_same(const struct grasp_spec *a, const struct grasp_spec *b);

/* Whether what is seen from a finger's frame is symmetric about y = 0. */
bool grasp_symmetric(const struct grasp_spec *spec);

#endif
