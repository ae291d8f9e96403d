#include "picture_canvas.hpp"

#include <algorithm>
#include <cstdint>
#include <new>
#include <stdexcept>

#ifdef __SANITIZE_ADDRESS__
// Fontconfig keeps its caches until the process ends; the leak checker takes them for lost.
// NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_options();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libfontconfig\n";
}
extern "C" const char* __lsan_default_options() {
  return "print_suppressions=0";
}
// NOLINTEND(bugprone-reserved-identifier)
#endif

namespace perch::app {
namespace {

void check(cairo_status_t status) {
  if (status == CAIRO_STATUS_SUCCESS) return;
  if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
  throw std::runtime_error(std::string("drawing the picture failed: ") + cairo_status_to_string(status));
}

/// Bytes of the well-formed UTF-8 character that the text begins with; 0 where it begins with none.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t n = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < n) return 0;
  for (std::size_t i = 1; i < n; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  const bool overlong = (lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xF0 && byte(1) < 0x90);
  const bool surrogate = lead == 0xED && byte(1) >= 0xA0, too_high = lead == 0xF4 && byte(1) >= 0x90;
  return overlong || surrogate || too_high ? 0 : n;
}

extern "C" cairo_status_t append_bytes(void* closure, const unsigned char* data, unsigned int n) {
  try {
    static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), n);
  } catch (...) {  // cairo is C: nothing may be thrown through it
    return CAIRO_STATUS_NO_MEMORY;
  }
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

std::string printable(std::string_view text, std::size_t longest) {
  std::string out;
  for (std::size_t characters = 0; !text.empty(); ++characters) {
    if (characters == longest) return out + "…";
    const std::size_t n = character_length(text);
    const auto lead = static_cast<unsigned char>(text[0]);
    if (n == 0)
      out += '?';
    else if (lead < 0x20 || lead == 0x7F)
      out += ' ';
    else
      out += text.substr(0, n);
    text.remove_prefix(std::max<std::size_t>(n, 1));
  }
  return out;
}

Canvas::Surface Canvas::make_surface(int width, int height) {
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  check(cairo_surface_status(surface.get()));
  return surface;
}

Canvas::Canvas(int width, int height)
    : surface_(make_surface(width, height)), cairo_(cairo_create(surface_.get())) {
  fill({0, 0, static_cast<double>(width), static_cast<double>(height)}, {255, 255, 255});
}

void Canvas::set_color(Rgb color, double opacity) {
  cairo_set_source_rgba(cairo_.get(), color.r / 255.0, color.g / 255.0, color.b / 255.0, opacity);
}

void Canvas::fill(const Box& box, Rgb color, double opacity) {
  set_color(color, opacity);
  cairo_rectangle(cairo_.get(), box.x, box.y, box.width, box.height);
  cairo_fill(cairo_.get());
}

void Canvas::draw(const Image<Rgb>& image, const Box& box) {
  const Surface source = make_surface(image.width(), image.height());
  unsigned char* bytes = cairo_image_surface_get_data(source.get());
  const int stride = cairo_image_surface_get_stride(source.get());
  for (int v = 0; v < image.height(); ++v) {
    auto* row = reinterpret_cast<std::uint32_t*>(bytes + static_cast<std::ptrdiff_t>(v) * stride);
    for (int u = 0; u < image.width(); ++u) {
      const Rgb c = image(u, v);
      row[u] = static_cast<std::uint32_t>(c.r) << 16 | static_cast<std::uint32_t>(c.g) << 8 | c.b;
    }
  }
  cairo_surface_mark_dirty(source.get());
  const double scale = box.width / image.width();
  cairo_save(cairo_.get());
  cairo_rectangle(cairo_.get(), box.x, box.y, box.width, box.height);
  cairo_clip(cairo_.get());
  cairo_translate(cairo_.get(), box.x, box.y);
  cairo_scale(cairo_.get(), scale, box.height / image.height());
  cairo_set_source_surface(cairo_.get(), source.get(), 0, 0);
  cairo_pattern_set_filter(cairo_get_source(cairo_.get()),
                           scale >= 2.0 ? CAIRO_FILTER_NEAREST : CAIRO_FILTER_GOOD);
  cairo_pattern_set_extend(cairo_get_source(cairo_.get()), CAIRO_EXTEND_PAD);
  cairo_paint(cairo_.get());
  cairo_restore(cairo_.get());
}

void Canvas::draw(const std::vector<Segment>& lines, const Box& box, double unit, double width, Rgb color) {
  cairo_save(cairo_.get());
  cairo_rectangle(cairo_.get(), box.x, box.y, box.width, box.height);
  cairo_clip(cairo_.get());
  set_color(color);
  cairo_set_line_width(cairo_.get(), width);
  cairo_set_line_cap(cairo_.get(), CAIRO_LINE_CAP_SQUARE);
  // One path of very many lines takes long to fill.
  constexpr std::size_t at_once = 1000;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Segment& s = lines[i];
    cairo_move_to(cairo_.get(), box.x + unit * s.x0, box.y + unit * s.y0);
    cairo_line_to(cairo_.get(), box.x + unit * s.x1, box.y + unit * s.y1);
    if ((i + 1) % at_once == 0 || i + 1 == lines.size()) cairo_stroke(cairo_.get());
  }
  cairo_restore(cairo_.get());
}

void Canvas::line(double x0, double y0, double x1, double y1, double width, Rgb color) {
  set_color(color);
  cairo_set_line_width(cairo_.get(), width);
  cairo_set_line_cap(cairo_.get(), CAIRO_LINE_CAP_ROUND);
  cairo_move_to(cairo_.get(), x0, y0);
  cairo_line_to(cairo_.get(), x1, y1);
  cairo_stroke(cairo_.get());
}

void Canvas::select(const Font& font) const {
  cairo_select_font_face(cairo_.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         font.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo_.get(), font.size);
}

void Canvas::text(double x, double y, const std::string& text, const Font& font, Rgb color) {
  select(font);
  set_color(color);
  cairo_move_to(cairo_.get(), x, y);
  cairo_show_text(cairo_.get(), text.c_str());
}

void Canvas::rimmed_text(double x, double y, const std::string& text, const Font& font, Rgb color, Rgb rim) {
  select(font);
  set_color(rim, 0.85);
  cairo_set_line_width(cairo_.get(), 3.5);
  cairo_set_line_join(cairo_.get(), CAIRO_LINE_JOIN_ROUND);
  cairo_move_to(cairo_.get(), x, y);
  cairo_text_path(cairo_.get(), text.c_str());
  cairo_stroke(cairo_.get());
  Canvas::text(x, y, text, font, color);
}

double Canvas::text_width(const std::string& text, const Font& font) const {
  select(font);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo_.get(), text.c_str(), &extents);
  return extents.x_advance;
}

std::vector<std::string> Canvas::wrapped(const std::string& text, const Font& font, double width) const {
  std::vector<std::string> lines;
  std::string line;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const std::string longer = line.empty() ? word : line + ' ' + word;
    if (line.empty() || text_width(longer, font) <= width) {
      line = longer;
    } else {
      lines.push_back(line);
      line = word;
    }
    begin = end + 1;
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

std::string Canvas::png() const {
  check(cairo_status(cairo_.get()));
  std::string bytes;
  check(cairo_surface_write_to_png_stream(surface_.get(), append_bytes, &bytes));
  return bytes;
}

}  // namespace perch::app
