#include "server/plot/offer.h"

#include <math.h>
#include <string.h>

#include "server/plot/data.h"
#include "server/plot/extension.h"
#include "server/plot/grasp.h"
#include "server/plot/metric.h"
#include "server/plot/motion.h"
#include "server/plot/ranking.h"

/* What is less is round-off or the tolerance of the equilibrium. */
static const double least_mm = 1e-3, least_deg = 0.05, least_N = 1e-3;

/* Largest size of a number of the samples; -1 when no sample has it. */
static double largest(const json_t *object, const char *key) {
  const json_t *samples = json_object_get(object, "samples");
  double size = -1;
  for (size_t i = 0; i < json_array_size(samples); i++) {
    size = fmax(size, fabs(data_number(json_array_get(samples, i), key)));
  }
  return size;
}

static double largest_of_members(const json_t *result, const char *key) {
  const json_t *members = json_object_get(result, "members");
  double size = -1;
  for (size_t i = 0; i < json_array_size(members); i++) {
    size = fmax(size, largest(json_array_get(members, i), key));
  }
  return size;
}

const char *offer_spatial(const struct plot_input *input) {
  const json_t *lines = json_object_get(input->result, "midlines");
  double size = largest(input->result, "tip_y_mm");
  for (size_t i = 0; i < json_array_size(lines) && size <= least_mm; i++) {
    const json_t *points = json_object_get(json_array_get(lines, i), "points_mm");
    for (size_t k = 0; k < json_array_size(points); k++) {
      size = fmax(size, fabs(data_element(json_array_get(points, k), 1)));
    }
  }
  return size > least_mm ? NULL : "the body stays in its plane; see \"midline\" and \"tip\"";
}

const char *offer_measured(const struct plot_input *input) {
  return json_array_size(json_object_get(input->result, "measured")) > 0
             ? NULL
             : "the job gives no measured curve";
}

const char *offer_curves(const struct plot_input *input) {
  const json_t *members = json_object_get(input->result, "members");
  bool any = json_array_size(members) == 0;
  for (size_t i = 0; i < json_array_size(members) && !any; i++) {
    const json_t *member = json_array_get(members, i);
    any = json_array_size(json_object_get(member, "samples")) > 0 || extension_is_of(member);
  }
  return any ? NULL : "of the members only metrics were kept";
}

const char *offer_metric(const struct plot_input *input) {
  return metric_choose(input->result, input->metric) ? NULL : "no member has this metric";
}

const char *offer_ranking(const struct plot_input *input) {
  return ranking_list(input->result) ? NULL : "the study asked for no ranking, or ranked nothing";
}

const char *offer_workspace(const struct plot_input *input) {
  return largest_of_members(input->result, "tip_y_mm") > least_mm ? NULL
                                                                  : "no tip leaves the plane y = 0";
}

const char *offer_twist(const struct plot_input *input) {
  return largest_of_members(input->result, "twist_angle_deg") > least_deg ? NULL
                                                                          : "no member twists";
}

const char *offer_contraction(const struct plot_input *input) {
  return largest_of_members(input->result, "contraction_pct") >= 0
             ? NULL
             : "no member has recorded its contraction";
}

/* Whether a pointer is to a setting of the mesh. */
static bool is_of_mesh(const char *pointer) {
  return strcmp(pointer, "/accuracy") == 0 || strstr(pointer, "mesh") != NULL;
}

const char *offer_mesh(const struct plot_input *input) {
  const json_t *members = json_object_get(input->result, "members");
  double low = INFINITY, high = -INFINITY;
  if (input->metric && !metric_choose(input->result, input->metric)) {
    return "no member has this metric";
  }
  for (size_t i = 0; i < json_array_size(members); i++) {
    json_t *member = json_array_get(members, i), *values = json_object_get(member, "values");
    const char *pointer;
    json_t *value;
    double unknowns = data_number(json_object_get(member, "statistics"), "unknowns");
    json_object_foreach(values, pointer, value) {
      if (!is_of_mesh(pointer)) {
        return "the members differ in more than their mesh";
      }
    }
    low = fmin(low, unknowns);
    high = fmax(high, unknowns);
  }
  return high > low && low >= 1 ? NULL : "the members have one mesh";
}

const char *offer_steady(const struct plot_input *input) {
  return json_array_size(json_object_get(input->result, "holds")) >= 2
             ? NULL
             : "fewer than two set-points were held";
}

const char *offer_motion(const struct plot_input *input) {
  const json_t *motion = json_object_get(input->result, "motion");
  return json_array_size(json_object_get(motion, "samples")) > 0
             ? NULL
             : "the job does not ask for dynamics";
}

const char *offer_snap(const struct plot_input *input) {
  return motion_fastest_snap(input->result) ? NULL : "nothing snapped";
}

const char *offer_control(const struct plot_input *input) {
  return json_is_object(json_object_get(input->result, "control"))
             ? NULL
             : "the set-points were given, not found by a controller";
}

const char *offer_shapes(const struct plot_input *input) {
  return json_array_size(json_object_get(input->result, "shapes")) > 0 ? NULL
                                                                       : "no shapes were recorded";
}

const char *offer_held(const struct plot_input *input) {
  return json_array_size(json_object_get(input->result, "held")) > 0
             ? NULL
             : "the actuator was not held at its natural length";
}

const char *offer_stability(const struct plot_input *input) {
  return json_array_size(json_object_get(input->result, "harmonics")) > 0
             ? NULL
             : "no circumferential harmonics were tested";
}

const char *offer_suction(const struct plot_input *input) {
  const json_t *members = json_object_get(input->result, "members");
  for (size_t i = 0; i < json_array_size(members); i++) {
    const json_t *metrics = json_object_get(json_array_get(members, i), "metrics");
    if (isfinite(data_number(metrics, "suction_force_N"))) {
      return NULL;
    }
  }
  return "no member has suckers";
}

const char *offer_pull(const struct plot_input *input) {
  return grasp_has_stage(input->result, "pull") ? NULL : "the object was not pulled";
}

const char *offer_press(const struct plot_input *input) {
  const json_t *samples = json_object_get(input->result, "samples");
  double most = 0;
  for (size_t i = 0; i < json_array_size(samples); i++) {
    const json_t *sample = json_array_get(samples, i);
    const char *stage = json_string_value(json_object_get(sample, "stage"));
    if (stage && strcmp(stage, "inflation") == 0) {
      most = fmax(most, fabs(data_number(sample, "grasp_force_N")));
    }
  }
  return most > least_N ? NULL : "the body did not press on the object while it was inflated";
}

const char *offer_moments(const struct plot_input *input) {
  const json_t *artifacts = json_object_get(input->result, "artifacts");
  for (size_t i = 0; i < json_array_size(artifacts); i++) {
    const char *name = json_string_value(json_array_get(artifacts, i));
    if (name && strcmp(name, "moments.bin") == 0) {
      return NULL;
    }
  }
  return "the job left no pictures of the grasp";
}
