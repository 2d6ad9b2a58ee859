#include <png.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "server/plot/canvas.h"

/* Level 3 takes half the time of the default for a few percent of size. */
enum { COMPRESSION_LEVEL = 3, NOTE_LIMIT = 8, NOTE_TEXT = 128 };

struct buffer {
  unsigned char *bytes;
  size_t size, room;
};

static void buffer_write(png_structp png, png_bytep bytes, size_t count) {
  struct buffer *buffer = png_get_io_ptr(png);
  if (buffer->size + count > buffer->room) {
    size_t room = 2 * (buffer->size + count) + 4096;
    unsigned char *grown = realloc(buffer->bytes, room);
    if (!grown) {
      png_error(png, "out of memory");
    }
    buffer->bytes = grown;
    buffer->room = room;
  }
  memcpy(buffer->bytes + buffer->size, bytes, count);
  buffer->size += count;
}

static void buffer_flush(png_structp png) {
  (void)png;
}

static void on_error(png_structp png, png_const_charp message) {
  (void)message;
  longjmp(*(jmp_buf *)png_get_error_ptr(png), 1);
}

static void on_warning(png_structp png, png_const_charp message) {
  (void)png;
  (void)message;
}

/* Copies the notes as PNG texts; the characters live in `copies`. */
static int fill_texts(const struct canvas_note *notes, size_t count, png_text *texts,
                      char (*copies)[NOTE_TEXT]) {
  int filled = 0;
  for (size_t i = 0; i < count && filled < NOTE_LIMIT; i++) {
    if (!notes[i].text) {
      continue;
    }
    char *copy = copies[filled];
    size_t length = 0;
    for (; notes[i].text[length] && length + 1 < NOTE_TEXT; length++) {
      char c = notes[i].text[length];
      copy[length] = c >= ' ' && c <= '~' ? c : '?';
    }
    copy[length] = '\0';
    texts[filled] = (png_text){.compression = PNG_TEXT_COMPRESSION_NONE,
                               .key = (char *)(uintptr_t)notes[i].key,
                               .text = copy,
                               .text_length = length};
    filled++;
  }
  return filled;
}

/* Writes one line of the surface (native 32-bit words, 0x00RRGGBB) as RGB bytes. */
static void pack_row(const unsigned char *from, int width, unsigned char *to) {
  for (int i = 0; i < width; i++) {
    uint32_t pixel;
    memcpy(&pixel, from + 4 * (size_t)i, sizeof pixel);
    *to++ = (unsigned char)(pixel >> 16 & 255);
    *to++ = (unsigned char)(pixel >> 8 & 255);
    *to++ = (unsigned char)(pixel & 255);
  }
}

/* The part that libpng may leave by longjmp: it keeps no local that must survive it. */
static int write_picture(png_structp png, png_infop info, jmp_buf *trap, struct canvas *canvas,
                         png_text *texts, int text_count, unsigned char *row) {
  if (setjmp(*trap)) {
    return 0;
  }
  const unsigned char *pixels = cairo_image_surface_get_data(canvas->surface);
  int stride = cairo_image_surface_get_stride(canvas->surface);
  png_set_compression_level(png, canvas->busy ? 1 : COMPRESSION_LEVEL);
  if (canvas->busy) {
    png_set_compression_strategy(png, Z_RLE);
  }
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_set_IHDR(png, info, (png_uint_32)canvas->width, (png_uint_32)canvas->height, 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_text(png, info, texts, text_count);
  png_write_info(png, info);
  for (int y = 0; y < canvas->height; y++) {
    pack_row(pixels + (ptrdiff_t)stride * y, canvas->width, row);
    png_write_row(png, row);
  }
  png_write_end(png, info);
  return 1;
}

enum status canvas_encode(struct canvas *canvas, const struct canvas_note *notes, size_t note_count,
                          unsigned char **png, size_t *size, struct error *error) {
  enum status status = STATUS_OK;
  struct buffer buffer = {0};
  png_text texts[NOTE_LIMIT];
  char copies[NOTE_LIMIT][NOTE_TEXT];
  int text_count = fill_texts(notes, note_count, texts, copies);
  jmp_buf trap;
  png_infop info = NULL;
  unsigned char *row = malloc(3 * (size_t)canvas->width);
  png_structp writer = png_create_write_struct(PNG_LIBPNG_VER_STRING, &trap, on_error, on_warning);
  if (writer) {
    info = png_create_info_struct(writer);
  }
  if (!row || !writer || !info) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out while writing a picture");
    goto done;
  }
  if (cairo_status(canvas->cr) != CAIRO_STATUS_SUCCESS) {
    status = error_set(error, STATUS_INTERNAL, NULL, "drawing failed: %s",
                       cairo_status_to_string(cairo_status(canvas->cr)));
    goto done;
  }
  cairo_surface_flush(canvas->surface);
  png_set_write_fn(writer, &buffer, buffer_write, buffer_flush);
  if (!write_picture(writer, info, &trap, canvas, texts, text_count, row)) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "the picture could not be encoded");
    goto done;
  }
  *png = buffer.bytes;
  *size = buffer.size;
  buffer.bytes = NULL;
done:
  png_destroy_write_struct(&writer, &info);
  free(row);
  free(buffer.bytes);
  return status;
}
