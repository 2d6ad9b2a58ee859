#include "solver/post/vtu.h"

#include <stdbool.h>
#include <stdlib.h>
#include <zlib.h>

#include "solver/base/base64.h"

const int *vtu_order_hex27(void) {
  /* Corners of z- and z+, edges of z-, of z+, upright; faces x- x+ y- y+ z- z+; centre. */
  static const int order[27] = {0,  18, 24, 6,  2,  20, 26, 8,  9,  21, 15, 3,  11, 23,
                                17, 5,  1,  19, 25, 7,  4,  22, 10, 16, 12, 14, 13};
  return order;
}

const int *vtu_order_quad9(int flipped) {
  /* Corners, edge middles, centre. */
  static const int order[2][9] = {{0, 6, 8, 2, 3, 7, 5, 1, 4}, {0, 2, 8, 6, 1, 5, 7, 3, 4}};
  return order[flipped != 0];
}

static const char *byte_order(void) {
  const uint16_t one = 1;
  return *(const unsigned char *)&one ? "LittleEndian" : "BigEndian";
}

static enum status write_base64(FILE *file, const void *data, size_t size) {
  size_t length;
  char *text = base64_encode(data, size, &length);
  if (text) {
    fwrite(text, 1, length, file);
  }
  free(text);
  return text ? STATUS_OK : STATUS_NO_MEMORY;
}

/* Compresses into *packed, which the caller frees; returns the size, or 0 when memory runs out.
 * Floats repeat bytes, hardly ever sequences of them: without the search for those the files grow
 * by 2 % and are written three times as fast. */
static size_t compress_block(const void *data, size_t size, unsigned char **packed) {
  z_stream stream = {0};
  *packed = NULL;
  if (deflateInit2(&stream, 1, Z_DEFLATED, MAX_WBITS, MAX_MEM_LEVEL, Z_RLE) != Z_OK) {
    return 0;
  }
  uLong bound = deflateBound(&stream, (uLong)size), written = 0;
  *packed = malloc(bound);
  if (*packed) {
    stream.next_in = (z_const Bytef *)data;
    stream.avail_in = (uInt)size;
    stream.next_out = *packed;
    stream.avail_out = (uInt)bound;
    written = deflate(&stream, Z_FINISH) == Z_STREAM_END ? stream.total_out : 0;
  }
  deflateEnd(&stream);
  if (written == 0) {
    free(*packed);
    *packed = NULL;
  }
  return written;
}

/* The content of one DataArray: number of blocks, their size, size of a shorter last block (0:
 * none), compressed size; then the block. */
static enum status write_block(FILE *file, const void *data, size_t size) {
  unsigned char *packed;
  size_t compressed = compress_block(data, size, &packed);
  if (compressed == 0) {
    return STATUS_NO_MEMORY;
  }
  uint64_t header[4] = {1, size, 0, compressed};
  enum status status = write_base64(file, header, sizeof header);
  if (status == STATUS_OK) {
    status = write_base64(file, packed, compressed);
  }
  free(packed);
  return status;
}

static enum status write_array(FILE *file, const char *type, const char *name, int components,
                               const void *data, size_t size) {
  static const char *const tensor[6] = {"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
  fprintf(file, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\"", type, name,
          components);
  for (int c = 0; components == 6 && c < components; c++) {
    fprintf(file, " ComponentName%d=\"%s\"", c, tensor[c]);
  }
  fputs(" format=\"binary\">", file);
  enum status status = write_block(file, data, size);
  fputs("</DataArray>\n", file);
  return status;
}

static enum status write_cells(FILE *file, const struct vtu_grid *grid) {
  size_t cells = (size_t)grid->cell_count, nodes = (size_t)grid->cell_nodes;
  int32_t *offset = malloc(sizeof *offset * (cells + 1));
  unsigned char *type = malloc(cells + 1);
  enum status status = offset && type ? STATUS_OK : STATUS_NO_MEMORY;
  for (size_t c = 0; status == STATUS_OK && c < cells; c++) {
    offset[c] = (int32_t)(nodes * (c + 1));
    type[c] = (unsigned char)grid->cell_type;
  }
  fputs("<Cells>\n", file);
  if (status == STATUS_OK) {
    status = write_array(file, "Int32", "connectivity", 1, grid->connectivity,
                         sizeof *grid->connectivity * cells * nodes);
  }
  if (status == STATUS_OK) {
    status = write_array(file, "Int32", "offsets", 1, offset, sizeof *offset * cells);
  }
  if (status == STATUS_OK) {
    status = write_array(file, "UInt8", "types", 1, type, cells);
  }
  fputs("</Cells>\n", file);
  free(offset);
  free(type);
  return status;
}

enum status vtu_write(FILE *file, const struct vtu_grid *grid, const struct vtu_array *arrays,
                      int array_count) {
  size_t points = (size_t)grid->point_count;
  fprintf(file,
          "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
          "byte_order=\"%s\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n"
          "<UnstructuredGrid><Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n<Points>\n",
          byte_order(), grid->point_count, grid->cell_count);
  enum status status =
      write_array(file, "Float32", "points", 3, grid->point, sizeof *grid->point * 3 * points);
  fputs("</Points>\n", file);
  if (status == STATUS_OK) {
    status = write_cells(file, grid);
  }
  fputs("<PointData>\n", file);
  for (int a = 0; status == STATUS_OK && a < array_count; a++) {
    size_t size = sizeof *arrays[a].value * points * (size_t)arrays[a].components;
    status =
        write_array(file, "Float32", arrays[a].name, arrays[a].components, arrays[a].value, size);
  }
  fputs("</PointData>\n</Piece></UnstructuredGrid></VTKFile>\n", file);
  return status;
}

void vtu_write_collection(FILE *file, const char *const *names, const double *time, size_t count) {
  fprintf(file,
          "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
          "byte_order=\"%s\">\n<Collection>\n",
          byte_order());
  for (size_t k = 0; k < count; k++) {
    fprintf(file, "<DataSet timestep=\"%.10g\" group=\"\" part=\"0\" file=\"%s\"/>\n", time[k],
            names[k]);
  }
  fputs("</Collection>\n</VTKFile>\n", file);
}
