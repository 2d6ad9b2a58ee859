/* Where a rigid object is: x = place + rotation X for the point X of its own frame. */
#ifndef PNEULAB_RIGID_POSE_H
#define PNEULAB_RIGID_POSE_H

struct rigid_pose {
  double place[3];    /* the origin of the object's frame, m */
  double rotation[9]; /* orthonormal, row-major */
};

/* No shift, no turn. */
struct rigid_pose rigid_pose_identity(void);

/* At `place`, turned by `angle` (rad) about the line through it along `axis` (not zero, any
 * length), right-handed. */
struct rigid_pose rigid_pose_turned(const double place[3], const double axis[3], double angle);

/* At `place`, with the object's z axis along `axis` (not zero, any length): the shortest turn that
 * brings it there; half a turn about x when axis is -z. */
struct rigid_pose rigid_pose_upright(const double place[3], const double axis[3]);

/* The pose in the outer frame of what has the pose `inner` in a frame that has the pose `outer`. */
struct rigid_pose rigid_pose_compose(const struct rigid_pose *outer,
                                     const struct rigid_pose *inner);

/* Shifts the object by `shift` (m) and turns it about its place by the rotation vector `turn` (rad,
 * in the outer frame). The rotation stays orthonormal to round-off over any number of moves. */
void rigid_pose_move(struct rigid_pose *pose, const double shift[3], const double turn[3]);

/* A point of the object's frame in the outer frame, and back. `out` may be `in`. */
void rigid_pose_outward(const struct rigid_pose *pose, const double in[3], double out[3]);
void rigid_pose_inward(const struct rigid_pose *pose, const double in[3], double out[3]);

/* The same for directions. */
void rigid_pose_turn_outward(const struct rigid_pose *pose, const double in[3], double out[3]);
void rigid_pose_turn_inward(const struct rigid_pose *pose, const double in[3], double out[3]);

/* Turns a tensor t of the object's frame into the outer frame: R t R^T. */
void rigid_pose_tensor_outward(const struct rigid_pose *pose, double tensor[3][3]);

#endif
