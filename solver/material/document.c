#include "solver/material/document.h"

#include "solver/base/clock.h"

json_t *document_make(const struct job_spec *spec, const char *kind, enum status ending,
                      const struct error *error, struct document_parts *parts) {
  bool good = ending == STATUS_OK;
  json_t *statistics =
      json_pack("{s:i, s:f, s:f, s:f}", "iterations", parts->iterations, "wall_s",
                clock_wall_s() - parts->wall_s, "cpu_s", clock_cpu_s() - parts->cpu_s,
                "peak_memory_MB", clock_peak_memory_MB());
  return json_pack("{s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:[], s:o, s:{s:s, s:s}}", "status",
                   good ? "succeeded" : "diverged", "reason", good ? "" : status_word(ending),
                   "message", good ? "" : error->message, "kind", kind, "name", spec->name,
                   "metrics", parts->metrics, "samples", parts->samples, "warnings",
                   parts->warnings, "artifacts", "statistics", statistics, "provenance", "version",
                   PNEULAB_VERSION, "spec_hash", spec->hash);
}
