#pragma once

#include <cairo.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "perch/core/image.hpp"
#include "perch/localize/scene.hpp"

namespace perch::app {

/// A rectangle on a picture: left, top, width, height, pixels.
struct Box {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;

  double right() const { return x + width; }
  double bottom() const { return y + height; }
};

/// A horizontal or vertical line; the unit is the caller's.
struct Segment {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct Font {
  double size = 14.0;  ///< pixels
  bool bold = false;
};

/// The text as a picture can show it: control characters become spaces, bytes that are no UTF-8 question
/// marks, and what exceeds `longest` characters an ellipsis.
std::string printable(std::string_view text, std::size_t longest);

/// A picture in memory that is drawn on, x to the right and y down, pixels.
class Canvas {
 public:
  /// A white one. Throws std::bad_alloc where there is no memory for it.
  Canvas(int width, int height);

  void fill(const Box& box, Rgb color, double opacity = 1.0);
  /// Stretched over the box: each of its pixels a block where that enlarges it well, averaged where it
  /// shrinks.
  void draw(const Image<Rgb>& image, const Box& box);
  /// Lines given in units of `unit` pixels from the box's corner, drawn `width` pixels wide.
  void draw(const std::vector<Segment>& lines, const Box& box, double unit, double width, Rgb color);
  void line(double x0, double y0, double x1, double y1, double width, Rgb color);
  /// One line of text that begins at x, on the baseline y. \param text printable.
  void text(double x, double y, const std::string& text, const Font& font, Rgb color);
  /// The same with a dark rim, legible on anything.
  void rimmed_text(double x, double y, const std::string& text, const Font& font, Rgb color, Rgb rim);

  double text_width(const std::string& text, const Font& font) const;
  /// The text in lines no wider than `width`, broken at spaces where there are any.
  std::vector<std::string> wrapped(const std::string& text, const Font& font, double width) const;

  /// The bytes of a PNG file. Throws std::bad_alloc or std::runtime_error where drawing failed.
  std::string png() const;

 private:
  struct Destroy {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* cairo) const { cairo_destroy(cairo); }
  };
  using Surface = std::unique_ptr<cairo_surface_t, Destroy>;

  static Surface make_surface(int width, int height);
  void select(const Font& font) const;
  void set_color(Rgb color, double opacity = 1.0);

  Surface surface_;
  std::unique_ptr<cairo_t, Destroy> cairo_;
};

}  // namespace perch::app
