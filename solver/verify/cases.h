/* The cases, as functions of the table in cases.c: see struct verify_case. */
#ifndef PNEULAB_VERIFY_CASES_H
#define PNEULAB_VERIFY_CASES_H

#include "solver/verify/report.h"

typedef enum status verify_case_run(struct verify_run *run, struct error *error);

verify_case_run case_patch, case_tangent_element, case_tangent_pressure, case_tangent_contact,
    case_newton, case_manufactured, case_manufactured_incompressible;
verify_case_run case_cylinder_neo_hooke, case_sphere_neo_hooke, case_cylinder_yeoh,
    case_sphere_yeoh, case_cylinder_limit_point, case_sphere_limit_point;
verify_case_run case_cook_sheet, case_cook_plane_strain, case_cook_incompressible, case_block,
    case_roll_up, case_elastica, case_contact_patch, case_crushed_cylinder, case_hertz,
    case_treloar_uniaxial, case_treloar_equibiaxial, case_arch, case_arch_by_arc_length,
    case_sphere_of_revolution, case_washer, case_hertz_sphere, case_friction_block, case_capstan,
    case_friction_energy, case_vibration;

#endif
