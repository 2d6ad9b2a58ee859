#include "solver/post/suction.h"

#include <math.h>

double suction_force(const struct job_spec *spec, int sucker) {
  double radius = 0.5 * spec->pneunet.sucker[sucker].diameter;
  return spec->pneunet.suction_pressure * M_PI * radius * radius;
}

json_t *suction_list(const struct job_spec *spec) {
  const struct pneunet_spec *p = &spec->pneunet;
  json_t *list = p->sucker_count > 0 ? json_array() : NULL;
  for (int k = 0; k < p->sucker_count; k++) {
    json_array_append_new(list,
                          json_pack("{s:f, s:f, s:f}", "position_mm", 1e3 * p->sucker[k].position,
                                    "diameter_mm", 1e3 * p->sucker[k].diameter, "suction_force_N",
                                    suction_force(spec, k)));
  }
  return list;
}
