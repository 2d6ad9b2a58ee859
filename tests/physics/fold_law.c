#include "tests/physics/fold_law.h"

#include <math.h>
#include <stdlib.h>

const struct fold fold_pair = {
    .a = 0.87e9, .x1 = 4.5e-3, .x2 = 8.45e-3, .K = 1e4, .A = 5e-4, .B = 3.1e-4, .V0 = 9e-6};

static double slope(const struct fold *f, double x) {
  return f->a * x * (x - f->x1) * (x - f->x2);
}

static double energy(const struct fold *f, double x) {
  return f->a * x * x * (x * x / 4.0 - (f->x1 + f->x2) * x / 3.0 + f->x1 * f->x2 / 2.0);
}

void fold_state(const struct fold *f, double x, double p, double state[4]) {
  double h = x + (slope(f, x) - p * f->B) / f->K;
  state[0] = h;
  state[1] = slope(f, x) - p * (f->A + f->B);
  state[2] = f->V0 + f->A * h + f->B * x;
  state[3] = energy(f, x) + 0.5 * f->K * (h - x) * (h - x);
}

/* 1 + U''/K = 0, the two roots of a quadratic. */
static double turn(const struct fold *f, int side) {
  double b = -2.0 * (f->x1 + f->x2), c = f->x1 * f->x2 + f->K / f->a;
  double root = sqrt(b * b - 12.0 * c);
  return (-b + (side ? root : -root)) / 6.0;
}

double fold_end(const struct fold *f, int side, double p) {
  double state[4];
  fold_state(f, turn(f, side), p, state);
  return state[0];
}

double fold_inner(const struct fold *f, int side, double h, double p) {
  double edge = turn(f, side), low = side ? edge : edge - 0.1, high = side ? edge + 0.1 : edge;
  for (int i = 0; i < 200; i++) {
    double middle = 0.5 * (low + high), state[4];
    fold_state(f, middle, p, state);
    if (state[0] < h) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return 0.5 * (low + high);
}

void fold_table(const struct fold *f, int levels, const double pressure[], size_t points,
                double from, double to, struct law_table *table) {
  *table = (struct law_table){.count = levels};
  for (int k = 0; k < levels; k++) {
    struct law_level *level = &table->level[k];
    level->pressure = pressure[k];
    level->count = points;
    level->h = calloc(4 * points, sizeof *level->h);
    level->force = level->h + points;
    level->volume = level->force + points;
    level->energy = level->volume + points;
    for (size_t i = 0; i < points; i++) {
      double state[4];
      fold_state(f, from + (to - from) * (double)i / (double)(points - 1), pressure[k], state);
      level->h[i] = state[0];
      level->force[i] = state[1];
      level->volume[i] = state[2];
      level->energy[i] = state[3];
    }
  }
}
