#include "picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "picture_canvas.hpp"
#include "picture_labels.hpp"
#include "picture_panels.hpp"
#include "picture_shading.hpp"

namespace perch::app {
namespace {

constexpr double margin = 24, gap = 20, widest = 2000, tallest_image = 860, narrowest_panel = 340,
                 lowest_panel = 120;
constexpr double title_height = 34, legend_line = 22, footer_line = 24;
constexpr Rgb ink{25, 28, 33}, quiet_ink{95, 100, 108}, outline_color{245, 246, 248};
constexpr Font title_font{20, true}, legend_font{14, false}, name_font{14, true}, headline_font{19, true},
    footer_font{15, false}, object_font{15, true}, fractions_font{13, false};
constexpr std::size_t most_names = 60, most_table_rows = 6;

/// Where everything on the picture stands.
struct Layout {
  double scale = 1.0;  ///< picture pixels a pixel of the depth image
  double panel_width = 0.0;
  double panel_height = 0.0;
  double image_width = 0.0, image_height = 0.0;
  double legend_top = 0.0, footer_top = 0.0;
  double width = 0.0, height = 0.0;

  double panel_left(std::size_t i) const {
    return std::floor(margin + static_cast<double>(i) * (panel_width + gap));
  }
  /// The image of panel i, in the panel's middle.
  Box image(std::size_t i) const {
    return {std::floor(panel_left(i) + (panel_width - image_width) / 2),
            margin + title_height + std::floor((panel_height - image_height) / 2), image_width, image_height};
  }
};

double scale_to_fit(const Image<Rgb>& image, double width) {
  const double scale = std::min(width / image.width(), tallest_image / image.height());
  return scale >= 3.0 ? std::floor(scale) : scale;  // large pixels all of one size
}

bool contains(const Box& box, double x, double y) {
  return x >= box.x && x <= box.right() && y >= box.y && y <= box.bottom();
}

std::string status_name(Status status) {
  switch (status) {
    case Status::solved:
      return "solved";
    case Status::time_limit:
      return "stopped by its limit";
    case Status::infeasible:
      return "infeasible";
    case Status::unproven:
      return "without a bound";
  }
  return {};
}

std::string bound_clause(const Result& result) {
  const auto bound = result.suboptimality_bound();
  if (!bound) return fmt::format("lower bound {}: nothing proven yet", grouped(result.lower_bound));
  if (*bound <= 1.0) return fmt::format("lower bound {}: proven optimal", grouped(result.lower_bound));
  // Rounded up, so that the picture never promises more than was proven.
  return fmt::format("lower bound {}: at most {:.3f} times the optimum", grouped(result.lower_bound),
                     std::ceil(*bound * 1000.0) / 1000.0);
}

/// The lines below the panels but the objects' own.
std::vector<std::string> footer_text(const Result& result) {
  constexpr std::size_t longest = 300;
  std::vector<std::string> lines{printable(result.reason, longest)};
  if (!result.cost) {
    lines.push_back(fmt::format("no scene; {} observed points", grouped(result.observed_points)));
    return lines;
  }
  lines.push_back(fmt::format("cost {} = {} observed + {} rendered points unexplained, of {} observed points",
                              grouped(result.cost->cost), grouped(result.cost->cost_observed),
                              grouped(result.cost->cost_rendered), grouped(result.observed_points)));
  if (!result.has_bound()) return lines;
  std::string bound = bound_clause(result);
  if (result.search_cost && *result.search_cost != result.cost->cost)
    bound = fmt::format("the search's own scene: cost {}, {}", grouped(*result.search_cost), bound);
  lines.push_back(bound + " (over " + printable(result.guarantee.over, longest) + ")");
  return lines;
}

std::string fractions_of(const ObjectResult& object) {
  return fmt::format("{:.0f} % visible, {:.0f} % explained", 100 * object.visible_fraction,
                     100 * object.explained_fraction);
}

class Picture {
 public:
  Picture(const Scene& scene, const Result& result, Panels panels)
      : scene_(scene), result_(result), panels_(std::move(panels)), measure_(1, 1) {
    arrange();
  }

  std::string png() {
    Canvas canvas(static_cast<int>(std::ceil(layout_.width)), static_cast<int>(std::ceil(layout_.height)));
    for (std::size_t i = 0; i < panels_.panels.size(); ++i) draw_panel(canvas, i);
    draw_footer(canvas);
    return canvas.png();
  }

 private:
  void arrange() {
    const auto n = static_cast<double>(panels_.panels.size());
    const Image<Rgb>& image = panels_.panels.front().image;
    const double room = (widest - 2 * margin - (n - 1) * gap) / n;
    layout_.scale = scale_to_fit(image, std::min(room, 900.0));
    layout_.image_width = std::max(1.0, std::round(image.width() * layout_.scale));
    layout_.image_height = std::max(1.0, std::round(image.height() * layout_.scale));
    layout_.panel_width = std::max(layout_.image_width, narrowest_panel);
    layout_.panel_height = std::max(layout_.image_height, lowest_panel);
    layout_.legend_top = margin + title_height + layout_.panel_height + 10;
    std::size_t lines = 0;
    for (const Panel& panel : panels_.panels) lines = std::max(lines, draw_legend(nullptr, panel, 0.0));
    layout_.footer_top = layout_.legend_top + static_cast<double>(lines) * legend_line + 16;
    layout_.width = std::max(600.0, layout_.panel_left(panels_.panels.size()) - gap + margin);
    footer_ = wrapped_footer();
    for (std::size_t i = 0; i < panels_.names.size(); ++i)
      cell_width_ = std::max(cell_width_,
                             29 + measure_.text_width(panels_.names[i].text, object_font) +
                                 measure_.text_width(fractions_of(result_.objects[i]), fractions_font) + 30);
    layout_.height = layout_.footer_top + 8 + footer_line * (1 + static_cast<double>(footer_.size())) +
                     table_height() + margin;
  }

  double inner_width() const { return layout_.width - 2 * margin; }

  std::vector<std::string> wrapped_footer() const {
    std::vector<std::string> lines;
    for (const std::string& text : footer_text(result_))
      for (std::string& line : measure_.wrapped(text, footer_font, inner_width())) lines.push_back(line);
    return lines;
  }

  std::size_t table_columns() const {
    return static_cast<std::size_t>(std::max(1.0, std::floor(inner_width() / cell_width_)));
  }
  std::size_t shown_objects() const {
    return std::min(panels_.names.size(), table_columns() * most_table_rows);
  }
  double table_height() const {
    if (panels_.names.empty()) return 0.0;
    const std::size_t rows = (shown_objects() + table_columns() - 1) / table_columns();
    return 8 + footer_line * static_cast<double>(rows + (shown_objects() < panels_.names.size() ? 1 : 0));
  }

  void draw_panel(Canvas& canvas, std::size_t i) {
    const Panel& panel = panels_.panels[i];
    const Box image = layout_.image(i);
    const Box frame{layout_.panel_left(i), margin + title_height, layout_.panel_width, layout_.panel_height};
    canvas.text(frame.x, margin + title_font.size, panel.title, title_font, ink);
    canvas.fill(frame, panel_background);
    canvas.draw(panel.image, image);
    if (panel.shows_objects) {
      canvas.draw(panels_.outlines, image, layout_.scale, layout_.scale >= 2.0 ? 1.6 : 1.1, outline_color);
      draw_names(canvas, image, frame);
    }
    draw_legend(&canvas, panel, layout_.panel_left(i));
  }

  /// Pixels of other objects that a label standing at its place would hide.
  std::int64_t hidden_by(const Label& label, const Box& image, std::size_t own) const {
    const auto pixel = [&](double at, double from) {
      return static_cast<int>(std::floor((at - from) / layout_.scale));
    };
    const Window covered = intersection(
        {pixel(label.x - label.width / 2, image.x), pixel(label.y - label.height / 2, image.y),
         pixel(label.x + label.width / 2, image.x) + 1, pixel(label.y + label.height / 2, image.y) + 1},
        {0, 0, panels_.objects.width(), panels_.objects.height()});
    std::int64_t hidden = 0;
    for (int v = covered.v0; v < covered.v1; ++v)
      for (int u = covered.u0; u < covered.u1; ++u) {
        const std::uint32_t object = panels_.objects(u, v);
        hidden += object != SceneRendering::no_object && object != own;
      }
    return hidden;
  }

  /// A name stands on its object, or below or above one so small that it would hide it.
  Label label_of(const Canvas& canvas, std::size_t object, const Box& image) const {
    const ObjectName& name = panels_.names[object];
    Label label{image.x + name.u * layout_.scale, image.y + name.v * layout_.scale,
                canvas.text_width(name.text, name_font) + 6, name_font.size + 4, name.visible};
    const double area = static_cast<double>(name.visible) * layout_.scale * layout_.scale;
    if (area >= 5 * label.width * label.height) return label;
    label.x = image.x + 0.5 * (name.seen.u0 + name.seen.u1) * layout_.scale;
    Label below = label, above = label;
    below.y = image.y + name.seen.v1 * layout_.scale + 0.5 * label.height + 1;
    above.y = image.y + name.seen.v0 * layout_.scale - 0.5 * label.height - 1;
    return hidden_by(below, image, object) <= hidden_by(above, image, object) ? below : above;
  }

  void draw_names(Canvas& canvas, const Box& image, const Box& frame) {
    std::vector<std::size_t> seen;
    for (std::size_t i = 0; i < panels_.names.size(); ++i)
      if (panels_.names[i].visible > 0) seen.push_back(i);
    std::stable_sort(seen.begin(), seen.end(), [&](std::size_t a, std::size_t b) {
      return panels_.names[a].visible > panels_.names[b].visible;
    });
    seen.resize(std::min(seen.size(), most_names));
    std::vector<Label> labels;
    for (const std::size_t object : seen) labels.push_back(label_of(canvas, object, image));
    const std::vector<std::optional<Box>> places = place_labels(labels, frame);
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (places[i] && !contains(*places[i], labels[i].x, labels[i].y)) {
        // Pushed aside: a line leads to the object.
        const ObjectName& name = panels_.names[seen[i]];
        const double u = image.x + name.u * layout_.scale, v = image.y + name.v * layout_.scale;
        canvas.line(std::clamp(u, places[i]->x, places[i]->right()),
                    std::clamp(v, places[i]->y, places[i]->bottom()), u, v, 1.2, {255, 255, 255});
      }
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (places[i])
        canvas.rimmed_text(places[i]->x + 3, places[i]->bottom() - 5, panels_.names[seen[i]].text, name_font,
                           {255, 255, 255}, panel_background);
  }

  /// Draws the legend below a panel, in as many lines as it takes; without a canvas it only counts them.
  std::size_t draw_legend(Canvas* canvas, const Panel& panel, double left) const {
    double x = left;
    std::size_t line = 0;
    for (const LegendEntry& entry : panel.legend) {
      const double swatch = entry.swatch.empty() ? 0.0 : entry.swatch.size() == 1 ? 14.0 : 90.0;
      const double width = swatch + (swatch > 0 ? 7 : 0) + measure_.text_width(entry.text, legend_font);
      if (x > left && x + width > left + layout_.panel_width) {
        x = left;
        ++line;
      }
      if (canvas) {
        const double top = layout_.legend_top + static_cast<double>(line) * legend_line;
        const double step = swatch / static_cast<double>(std::max<std::size_t>(1, entry.swatch.size()));
        for (std::size_t i = 0; i < entry.swatch.size(); ++i)
          canvas->fill({x + static_cast<double>(i) * step, top + 1, step, 14}, entry.swatch[i]);
        canvas->text(x + swatch + (swatch > 0 ? 7 : 0), top + 13, entry.text, legend_font, ink);
      }
      x += width + 18;
    }
    return panel.legend.empty() ? 0 : line + 1;
  }

  void draw_footer(Canvas& canvas) {
    canvas.fill({margin, layout_.footer_top - 6, inner_width(), 1}, {205, 208, 212});
    double y = layout_.footer_top + footer_line;
    canvas.text(margin, y, printable(scene_.name, 60) + ": " + status_name(result_.status), headline_font,
                ink);
    for (const std::string& line : footer_) canvas.text(margin, y += footer_line, line, footer_font, ink);
    y += 8;
    const std::size_t columns = table_columns();
    for (std::size_t i = 0; i < shown_objects(); ++i) {
      const double x = margin + cell_width_ * static_cast<double>(i % columns);
      if (i % columns == 0) y += footer_line;
      draw_object(canvas, x, y, i);
    }
    if (shown_objects() < panels_.names.size())
      canvas.text(margin, y + footer_line,
                  fmt::format("and {} more objects, see result.json", panels_.names.size() - shown_objects()),
                  footer_font, quiet_ink);
  }

  void draw_object(Canvas& canvas, double x, double y, std::size_t i) const {
    const std::string& name = panels_.names[i].text;
    canvas.fill({x, y - 12, 14, 14}, object_color(i));
    canvas.text(x + 21, y, name, object_font, ink);
    canvas.text(x + 29 + canvas.text_width(name, object_font), y, fractions_of(result_.objects[i]),
                fractions_font, quiet_ink);
  }

  const Scene& scene_;
  const Result& result_;
  Panels panels_;
  Canvas measure_;
  Layout layout_;
  std::vector<std::string> footer_;
  double cell_width_ = 100.0;  ///< of an object in the footer
};

}  // namespace

std::string draw_picture(const Scene& scene, const Result& result, const SceneRendering* rendering) {
  return Picture(scene, result, make_panels(scene, result, rendering)).png();
}

}  // namespace perch::app
