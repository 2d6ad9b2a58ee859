#include "solver/verify/materials.h"

const struct material_spec verify_materials[VERIFY_MATERIALS] = {
    {.model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {0.4}, .bulk_ratio = 1000, .name = "neo-Hooke"},
    {.model = MATERIAL_YEOH,
     .terms = 3,
     .c = {0.25, -0.05, 0.005},
     .bulk_ratio = 1000,
     .name = "Yeoh"},
    {.model = MATERIAL_MOONEY_RIVLIN,
     .terms = 2,
     .c = {0.293, 0.177},
     .bulk_ratio = 1000,
     .name = "Mooney-Rivlin"},
    {.model = MATERIAL_OGDEN,
     .terms = 3,
     .c = {0.63, 0.0012, -0.01},
     .alpha = {1.3, 5, -2},
     .bulk_ratio = 1000,
     .name = "Ogden"},
};
