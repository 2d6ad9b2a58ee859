/* The visible surface of the deformed body. */
#ifndef PNEULAB_POST_SKIN_H
#define PNEULAB_POST_SKIN_H

#include <jansson.h>
#include <stdint.h>
#include "solver/fe/model.h"

/* Outer surface of the whole body, mirrored when half of it was modelled. Every 9-node face
 * gives four quadrilaterals with outward normals. */
struct skin {
  int point_count;
  int *node;               /* node of each point */
  unsigned char *mirrored; /* 1 for a point of the mirrored half */
  int face_count;
  int (*face)[QUAD9_NODES]; /* points of each 9-node face, order of mesh_face_nodes */
  unsigned char *inward;    /* 1 where that order's normal points into the body */
};

/* Collects the faces of FACE_OUTER and FACE_BASE, and with `cavities` also FACE_CAVITY. On
 * success the caller releases *skin. */
enum status skin_create(const struct mesh *mesh, bool cavities, struct skin *skin,
                        struct error *error);
void skin_release(struct skin *skin);

/* The four quadrilaterals of a face: points of their corners, in turn. */
void skin_face_quads(const struct skin *skin, int face, int quads[4][4]);

/* The quadrilaterals as a JSON array of [a, b, c, d]. NULL when memory runs out. */
json_t *skin_quads(const struct skin *skin);

/* One state as a JSON object: pressure_kPa, points_mm, stretch. NULL when memory runs out. */
json_t *skin_state(const struct mesh *mesh, const struct skin *skin, const double *u,
                   const double *node_stretch, double pressure);

/* The 9-node faces as cells VTU_QUAD9 with outward normals: point numbers into
 * connectivity[face_count x 9]. */
void skin_connectivity(const struct skin *skin, int32_t *connectivity);

#endif
