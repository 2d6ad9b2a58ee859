#include "solver/mesh/actuator.h"

#include "solver/mesh/oblique.h"
#include "solver/mesh/pneunet.h"

enum status actuator_mesh(const struct job_spec *spec, struct mesh *mesh, struct error *error) {
  if (spec->family == FAMILY_PNEUNET) {
    return pneunet_mesh(spec, mesh, error);
  }
  struct oblique_cells cells = oblique_resolution(spec);
  return oblique_mesh(spec, &cells, mesh, error);
}

enum status actuator_mesh_finer(const struct job_spec *spec, struct mesh *mesh,
                                struct error *error) {
  if (spec->family == FAMILY_PNEUNET) {
    struct pneunet_cells cells = pneunet_resolution(spec);
    pneunet_refine(spec, &cells);
    return pneunet_mesh_cells(spec, &cells, mesh, error);
  }
  struct oblique_cells cells = oblique_resolution(spec);
  oblique_refine(&cells);
  return oblique_mesh(spec, &cells, mesh, error);
}

double actuator_length(const struct job_spec *spec) {
  return spec->family == FAMILY_PNEUNET ? spec->pneunet.length : spec->oblique.length;
}
