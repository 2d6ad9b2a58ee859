/* What the parts of the contact with rigid objects share. */
#ifndef PNEULAB_FE_OBSTACLE_INTERNAL_H
#define PNEULAB_FE_OBSTACLE_INTERNAL_H

#include "solver/fe/obstacle.h"

/* What one point gives to the body, in the frame of the model. */
struct obstacle_law {
  double residual[3];  /* minus the force on the body, N */
  double matrix[3][3]; /* d residual / d x, symmetric, N/m */
};

/* Evaluates the point at its place x: renews gap, tractions and slip; `law` receives the residual
 * and, with `tangent`, the matrix. Returns false when the point
 * carries no traction: law is then not written. */
bool obstacle_point_evaluate(const struct obstacle *obstacle, struct obstacle_point *point,
                             bool tangent, struct obstacle_law *law);

/* The point is far from the object: no gap, no traction. */
void obstacle_point_clear(struct obstacle_point *point);

/* Evaluates the 9 points of a face at current node positions x[9][3]: renews them, and writes the
 * residual r[3 a + i] (N) and, unless NULL, the tangent's upper triangle stiffness[row][column],
 * row <= column (N/m). Returns false when no point carries traction: nothing is then written. */
bool obstacle_face_evaluate(const struct obstacle *obstacle, const struct quad9_tables *tables,
                            struct obstacle_point point[QUAD9_POINTS], double x[QUAD9_NODES][3],
                            double r[3 * QUAD9_NODES], double (*stiffness)[3 * QUAD9_NODES]);

/* Place of point q of a face with nodes x, m. */
void obstacle_point_place(const struct quad9_tables *tables, int q, double x[QUAD9_NODES][3],
                          double place[3]);

/* Current area of the surface around point q of a face, m2. */
double obstacle_current_area(const struct quad9_tables *tables, int q, double x[QUAD9_NODES][3]);

/* Current positions of the nodes of face f of model->contact. */
void obstacle_face_positions(const struct fe_model *model, const double *u, int f,
                             int nodes[QUAD9_NODES], double x[QUAD9_NODES][3]);

/* Whether a face with these nodes may carry traction from the object. */
bool obstacle_reaches(const struct obstacle *obstacle, double x[QUAD9_NODES][3]);

/* Renews box and margin after the pose, the multipliers or eps have changed. */
void obstacle_renew_reach(const struct fe_model *model, struct obstacle *obstacle);

/* Renews all points at displacements u. */
void obstacles_look(struct fe_model *model, const double *u);

/* Adds all objects to the residual and, with `tangent`, to the elements' tangents. */
void model_evaluate_obstacles(struct fe_model *model, const double *u, bool tangent);

/* The points take over the memory of the state, and the state that of the points. */
void obstacles_use(struct fe_model *model, const struct fe_state *state);
void obstacles_keep(const struct fe_model *model, struct fe_state *state);

/* Number of points and objects in a state's memory. */
size_t obstacles_memory_count(const struct fe_model *model);

enum {
  OBSTACLE_VALUES = 4, /* multipliers of a point: lambda and the vector tau, Pa */
  OBSTACLE_ROOM = 5
};

/* Fills point->wanted of an object: the pressures, made continuous and bilinear over the faces that
 * touch with all their points. They have more points than their nodes can keep apart from a curved
 * object, and pressures that jump from face to face would bend a thin wall to and fro; what the
 * pressure does beyond that is left to eps. Every face keeps its force. room: OBSTACLE_ROOM times
 * mesh->node_count. */
void obstacle_smooth(const struct fe_model *model, struct obstacle *obstacle, double *room);

/* Multipliers of the points of face f, and by how much they have to change to be the tractions that
 * are wanted. */
void obstacle_face_multipliers(const struct obstacle *obstacle, int f,
                               double value[QUAD9_POINTS][OBSTACLE_VALUES],
                               double change[QUAD9_POINTS][OBSTACLE_VALUES]);

/* Gives the points of face f these multipliers, lambda at least 0 and tau turned into the tangent
 * plane at the present place of the point. Points that have come into contact get a stick point. */
void obstacle_face_set(const struct obstacle *obstacle, int f,
                       double value[QUAD9_POINTS][OBSTACLE_VALUES]);

/* Deepest overlap at the last evaluation, m, >= 0. */
double obstacles_intrusion(const struct fe_model *model);

void obstacles_release(struct fe_model *model);

#endif
