/* Mesh of a bistable bellows: a strip along the meridian, layers of silicone, PET and silicone
 * through the wall.
 *
 * Rows of nodes run through the wall from the cavity outwards, straight and normal to its middle
 * line; columns run along it upwards. In the hinges the middle layer is silicone, too. */
#ifndef PNEULAB_SNAP_BELLOWS_H
#define PNEULAB_SNAP_BELLOWS_H

#include "solver/axi/mesh.h"
#include "solver/job/snap.h"
#include "solver/snap/meridian.h"

enum { BELLOWS_SILICONE, BELLOWS_PET, BELLOWS_REGIONS };

/* A PET sheet: rows of nodes, both ends included. */
struct bellows_sheet {
  int pair; /* -1: the one for mounting */
  bool snapping;
  int from, to;
};

/* Two shells of a pair and of the row's ends, each in two pieces at most. */
enum { BELLOWS_SHEETS_MAX = 2 * SNAP_PAIRS_MAX + 2 };

struct bellows {
  struct axi_mesh mesh;
  int row_count, column_count;
  int core_from, core_to; /* columns of the faces of the PET */
  int sheet_count;
  struct bellows_sheet sheet[BELLOWS_SHEETS_MAX];
  struct meridian line;
  int row[MERIDIAN_PARTS_MAX + 1]; /* where the parts of the line start and end */
};

/* Elements through a layer of silicone and through the PET, and their length along the wall
 * relative to its thickness. */
struct bellows_fineness {
  int silicone, pet;
  double length;
};

struct bellows_fineness bellows_fineness(enum accuracy accuracy);

/* Builds the mesh. bellows_release it, also after a failure. STATUS_NO_MEMORY. */
enum status bellows_create(const struct snap_spec *spec, const struct bellows_fineness *fineness,
                           struct bellows *bellows, struct error *error);
void bellows_release(struct bellows *bellows);

/* Number of a node. */
int bellows_node(const struct bellows *bellows, int row, int column);

/* Where, as a share of the part, its element `cell` of `cells` starts. */
double bellows_boundary(const struct meridian_part *part, int cells, int cell);

/* Angle of the snapping shell of a pair to the base plane, rad, from end to end, at the
 * displacements u (2 node + i; NULL: as moulded): positive as moulded, negative inverted. */
double bellows_shell_angle(const struct bellows *bellows, int pair, const double *u);

/* Number of snapping shells that are inverted. */
int bellows_inverted(const struct bellows *bellows, int pair_count, const double *u);

#endif
