#include "solver/post/spatial.h"

#include "solver/fe/retraction.h"
#include "solver/base/vec3.h"

/* Twist about the first axis of the swing-twist decomposition of a rotation: 2 atan2(q1, q0) of its
 * quaternion q, between -pi and pi. From the matrix, (q0, q1) is proportional to the larger of two
 * columns of the outer product q q^T. */
static double twist_of(const double r[9]) {
  double real[2] = {1 + r[0] + r[4] + r[8], r[7] - r[5]}; /* 4 q0 (q0, q1) */
  double axis[2] = {r[7] - r[5], 1 + r[0] - r[4] - r[8]}; /* 4 q1 (q0, q1) */
  const double *q = real[0] >= axis[1] ? real : axis;
  double twist = 2 * atan2(q[1], q[0]);
  return remainder(twist, 2 * M_PI);
}

static double reach_of(const struct mesh *mesh, const double *u) {
  int base = mesh->centreline[0], tip = mesh->centreline[mesh->section_count - 1];
  double line[3];
  for (int i = 0; i < 3; i++) {
    line[i] = mesh->x[3 * tip + i] - mesh->x[3 * base + i];
    line[i] += u ? u[3 * tip + i] - u[3 * base + i] : 0;
  }
  return vec3_norm(line);
}

enum status spatial_measure(const struct mesh *mesh, const double *u, struct spatial *spatial) {
  struct retraction *frames = retraction_create(mesh);
  if (!frames) {
    return STATUS_NO_MEMORY;
  }
  double before[9], now[9], centre[3], turn[3];
  *spatial = (struct spatial){.reach = reach_of(mesh, u)};
  spatial->contraction = 1 - spatial->reach / reach_of(mesh, NULL);
  retraction_frame(frames, u, mesh->station[0], now, centre);
  for (int s = 1; s < mesh->station_count; s++) {
    for (int i = 0; i < 9; i++) {
      before[i] = now[i];
    }
    retraction_frame(frames, u, mesh->station[s], now, centre);
    rotation_between(before, now, turn);
    spatial->twist += turn[0];
    spatial->bending += turn[1];
    spatial->side_bending += turn[2];
    spatial->turn += hypot(turn[1], turn[2]);
  }
  spatial->end_bending = acos(fmax(-1, fmin(1, now[0])));
  double twist = twist_of(now);
  spatial->end_twist = twist + 2 * M_PI * round((spatial->twist - twist) / (2 * M_PI));
  retraction_destroy(frames);
  return STATUS_OK;
}
