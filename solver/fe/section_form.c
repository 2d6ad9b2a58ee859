#include "solver/fe/section_form.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/retraction.h"
#include "solver/base/vec3.h"

enum status section_form_create(const struct mesh *mesh, struct section_form *form) {
  size_t sections = (size_t)mesh->section_count + 1, nodes = (size_t)mesh->node_count + 1;
  form->rotation = calloc(9 * sections, sizeof *form->rotation);
  form->step = calloc(3 * sections, sizeof *form->step);
  form->length = calloc(sections, sizeof *form->length);
  form->local = calloc(3 * nodes, sizeof *form->local);
  if (!form->rotation || !form->step || !form->length || !form->local) {
    section_form_release(form);
    return STATUS_NO_MEMORY;
  }
  return STATUS_OK;
}

void section_form_release(struct section_form *form) {
  free(form->rotation);
  free(form->step);
  free(form->length);
  free(form->local);
  *form = (struct section_form){0};
}

/* r^T x */
static void turn_back(const double r[9], const double x[3], double out[3]) {
  double a[3] = {x[0], x[1], x[2]};
  for (int i = 0; i < 3; i++) {
    out[i] = r[i] * a[0] + r[3 + i] * a[1] + r[6 + i] * a[2];
  }
}

/* Centres of all sections of the undeformed body. */
static enum status rest_centres(const struct mesh *mesh, struct retraction *frames, double *rest) {
  double *zero = calloc(3 * (size_t)mesh->node_count + 1, sizeof *zero), identity[9];
  for (int s = 0; zero && s < mesh->section_count; s++) {
    retraction_frame(frames, zero, s, identity, rest + 3 * (size_t)s);
  }
  free(zero);
  return zero ? STATUS_OK : STATUS_NO_MEMORY;
}

/* Steps of the form from the centres at rest and now. */
static void take_steps(const struct mesh *mesh, const double *rest, const double *now,
                       struct section_form *form) {
  for (int i = 0; i < 3; i++) {
    form->step[i] = now[i] - rest[i];
  }
  for (int s = 1; s < mesh->section_count; s++) {
    double was[3], is[3], *step = form->step + 3 * s;
    for (int i = 0; i < 3; i++) {
      was[i] = rest[3 * s + i] - rest[3 * s - 3 + i];
      is[i] = now[3 * s + i] - now[3 * s - 3 + i];
    }
    turn_back(form->rotation + 9 * (s - 1), is, step);
    for (int i = 0; i < 3; i++) {
      step[i] -= was[i];
    }
    form->length[s] = vec3_norm(was);
  }
}

enum status section_form_take(const struct mesh *mesh, const double *u, struct section_form *form) {
  struct retraction *frames = retraction_create(mesh);
  double *rest = calloc(6 * (size_t)mesh->section_count + 1, sizeof *rest);
  enum status status = frames && rest ? rest_centres(mesh, frames, rest) : STATUS_NO_MEMORY;
  if (status == STATUS_OK) {
    double *now = rest + 3 * (size_t)mesh->section_count;
    for (int s = 0; s < mesh->section_count; s++) {
      retraction_frame(frames, u, s, form->rotation + 9 * s, now + 3 * s);
    }
    take_steps(mesh, rest, now, form);
    for (int n = 0; n < mesh->node_count; n++) {
      int s = mesh->node_section[n];
      double arm[3], *local = form->local + 3 * n;
      for (int i = 0; i < 3; i++) {
        arm[i] = mesh->x[3 * n + i] + u[3 * n + i] - now[3 * s + i];
      }
      turn_back(form->rotation + 9 * s, arm, local);
      for (int i = 0; i < 3; i++) {
        local[i] -= mesh->x[3 * n + i] - rest[3 * s + i];
      }
    }
  }
  retraction_destroy(frames);
  free(rest);
  return status;
}

/* Chains the centres: every step is scaled to the body's own distance and turned with the
 * section that it starts from. */
static void chain(const struct mesh *mesh, const struct section_form *form, const double *rest,
                  double *now) {
  for (int i = 0; i < 3; i++) {
    now[i] = rest[i] + form->step[i];
  }
  for (int s = 1; s < mesh->section_count; s++) {
    double step[3], turned[3];
    for (int i = 0; i < 3; i++) {
      step[i] = rest[3 * s + i] - rest[3 * s - 3 + i];
    }
    double scale = form->length[s] > 0 ? vec3_norm(step) / form->length[s] : 1;
    for (int i = 0; i < 3; i++) {
      step[i] += scale * form->step[3 * s + i];
    }
    mat3_apply(form->rotation + 9 * (s - 1), step, turned);
    for (int i = 0; i < 3; i++) {
      now[3 * s + i] = now[3 * s - 3 + i] + turned[i];
    }
  }
}

enum status section_form_give(const struct mesh *mesh, const struct section_form *form, double *u) {
  struct retraction *frames = retraction_create(mesh);
  double *rest = calloc(6 * (size_t)mesh->section_count + 1, sizeof *rest);
  enum status status = frames && rest ? rest_centres(mesh, frames, rest) : STATUS_NO_MEMORY;
  if (status == STATUS_OK) {
    double *now = rest + 3 * (size_t)mesh->section_count;
    chain(mesh, form, rest, now);
    for (int n = 0; n < mesh->node_count; n++) {
      int s = mesh->node_section[n];
      double arm[3], turned[3];
      for (int i = 0; i < 3; i++) {
        arm[i] = mesh->x[3 * n + i] - rest[3 * s + i] + form->local[3 * n + i];
      }
      mat3_apply(form->rotation + 9 * s, arm, turned);
      for (int i = 0; i < 3; i++) {
        bool held = mesh->fixed[3 * n + i];
        u[3 * n + i] = held ? 0 : now[3 * s + i] + turned[i] - mesh->x[3 * n + i];
      }
    }
  }
  retraction_destroy(frames);
  free(rest);
  return status;
}

void section_form_extrapolate(const struct mesh *mesh, struct section_form *form, double share,
                              const struct section_form *from, const struct section_form *to) {
  for (int s = 0; s < mesh->section_count; s++) {
    double spin[3], turn[9], before[9], *rotation = form->rotation + 9 * s;
    rotation_between(from->rotation + 9 * s, to->rotation + 9 * s, spin);
    for (int i = 0; i < 3; i++) {
      spin[i] *= share;
      form->step[3 * s + i] += share * (to->step[3 * s + i] - from->step[3 * s + i]);
    }
    rotation_matrix(spin, turn);
    memcpy(before, rotation, sizeof before);
    for (int i = 0; i < 9; i++) {
      rotation[i] = 0;
      for (int k = 0; k < 3; k++) {
        rotation[i] += before[i / 3 * 3 + k] * turn[3 * k + i % 3];
      }
    }
  }
  for (int i = 0; i < 3 * mesh->node_count; i++) {
    form->local[i] += share * (to->local[i] - from->local[i]);
  }
}
