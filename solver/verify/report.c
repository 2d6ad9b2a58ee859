#include "solver/verify/report.h"

#include <math.h>
#include <stdarg.h>

void verify_result(struct verify_run *run, double computed, double reference, double scale) {
  struct verify_report *r = &run->report;
  r->computed = computed;
  r->reference = reference;
  r->error = fabs(computed - reference) / (scale != 0 ? scale : fabs(reference));
}

void verify_row(struct verify_run *run, double size, double computed, double error,
                const struct fe_model *model, const char *format, ...) {
  struct verify_report *r = &run->report;
  if (r->row_count >= VERIFY_ROWS) {
    return;
  }
  struct verify_row *row = &r->row[r->row_count++];
  *row = (struct verify_row){.size = size,
                             .unknowns = model ? model->dof_count : 0,
                             .computed = computed,
                             .error = fabs(error),
                             .other = NAN};
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(row->label, sizeof row->label, format, arguments);
  va_end(arguments);
  if (run->events) {
    /* Every mesh costs several times the one before. */
    double left = pow(0.2, run->refinement - r->row_count);
    fprintf(run->events, "{\"event\":\"progress\",\"fraction\":%.4f,\"step\":%d}\n", fmin(left, 1),
            r->row_count);
    fflush(run->events);
  }
}

void verify_row_other(struct verify_run *run, double error) {
  run->report.row[run->report.row_count - 1].other = error;
}

void verify_points_clear(struct verify_run *run) {
  run->report.point_count = 0;
}

void verify_point(struct verify_run *run, double x, double computed, double reference) {
  struct verify_report *r = &run->report;
  if (r->point_count < VERIFY_POINTS) {
    r->point[r->point_count++] = (struct verify_point){x, computed, reference};
  }
}

double verify_points_worst(const struct verify_run *run) {
  double worst = 0;
  for (int i = 0; i < run->report.point_count; i++) {
    const struct verify_point *p = &run->report.point[i];
    worst = fmax(worst, fabs(p->computed / p->reference - 1)); /* fmax passes over a NaN */
  }
  return worst;
}

void verify_metric(struct verify_run *run, const char *name, double value) {
  struct verify_report *r = &run->report;
  if (r->metric_count < VERIFY_METRICS) {
    r->metric[r->metric_count++] = (struct verify_metric){name, value};
  }
}

double verify_order(const struct verify_run *run, int first, int last) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (int i = first; i < last; i++) {
    double x = log(run->report.row[i].size), y = log(run->report.row[i].error);
    n += 1;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

void verify_difference(struct verify_run *run, double (*error)(void *context, double h),
                       void *context, double first) {
  int rows = 4 + 3 * run->refinement, clear = 2;
  double smallest = INFINITY;
  for (int k = 0; k < rows; k++) {
    double h = first / (1 << k), e = error(context, h);
    smallest = fmin(smallest, e);
    verify_row(run, h, e, e, NULL, "step %.3g", h);
  }
  while (clear < rows && run->report.row[clear].error > 100 * smallest &&
         run->report.row[clear].error < run->report.row[clear - 1].error) {
    clear++;
  }
  verify_result(run, verify_order(run, clear > 4 ? clear - 4 : 0, clear), 2, 0);
  verify_metric(run, "smallest_difference_percent", 100 * smallest);
}

double verify_difference_error(int n, const double *a, const double *b, double h,
                               const double *exact) {
  double sum = 0, size = 0;
  for (int i = 0; i < n; i++) {
    double d = (b[i] - a[i]) / (2 * h) - exact[i];
    sum += d * d;
    size += exact[i] * exact[i];
  }
  return sqrt(sum / size);
}

enum status verify_body_open(struct verify_body *body, const struct material_spec *material,
                             bool contact, struct error *error) {
  enum status status = model_create(&body->mesh, material, contact, &body->model, error);
  if (status == STATUS_OK && state_create(body->model, &body->state) != STATUS_OK) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a state");
  }
  return status;
}

void verify_body_close(struct verify_run *run, struct verify_body *body) {
  struct verify_report *r = &run->report;
  if (body->model) {
    if (body->model->dof_count > r->unknowns) {
      r->unknowns = body->model->dof_count;
      r->elements = body->mesh.element_count;
    }
    r->factorizations += body->model->statistics.factorizations;
    r->newton_iterations += body->model->statistics.newton_iterations;
  }
  state_release(&body->state);
  model_destroy(body->model);
  mesh_release(&body->mesh);
  *body = (struct verify_body){.model = NULL};
}

enum status verify_failed(enum status status, const char *what, struct error *error) {
  return error_set(error, status, NULL, "%s: %s", what, status_sentence(status));
}
