#include "perch/eval/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "perch/eval/gnuplot.hpp"
#include "perch/io/message.hpp"

namespace perch {
namespace {

struct Color {
  int r, g, b;
};

/// Okabe and Ito (2008): told apart also by people who don't see all colours.
Color color_of(std::size_t method) {
  constexpr std::array<Color, 7> palette{{{0, 114, 178},
                                          {230, 159, 0},
                                          {0, 158, 115},
                                          {204, 121, 167},
                                          {213, 94, 0},
                                          {86, 180, 233},
                                          {0, 0, 0}}};
  return palette[method % palette.size()];
}

Color paler(Color color) {
  const auto mixed = [](int channel) { return 255 - (255 - channel) * 3 / 10; };
  return {mixed(color.r), mixed(color.g), mixed(color.b)};
}

std::string hex(Color color) {
  return fmt::format("'#{:02x}{:02x}{:02x}'", color.r, color.g, color.b);
}

constexpr const char* dark = "'#404040'";
constexpr const char* grey = "'#808080'";

/// gnuplot's point types.
struct Mark {
  int full, hollow;
};

Mark mark_of(std::size_t method) {
  constexpr std::array<Mark, 4> marks{{{7, 6}, {5, 4}, {9, 8}, {13, 12}}};
  return marks[method % marks.size()];
}

/// What a figure's places are counted in: pixels of its SVG. The PNG has twice as many each way.
class Sheet {
 public:
  Sheet(double width, double height) : width_(width), height_(height) {}

  double x(double from_left) const { return from_left / width_; }
  double y(double from_top) const { return 1.0 - from_top / height_; }
  double width() const { return width_; }

  std::string terminal(FigureFormat format) const {
    const std::string start =
        format == FigureFormat::svg
            ? fmt::format(
                  "set terminal svg size {},{} font 'DejaVu Sans,13' background '#ffffff'\n"
                  "set pointsize 0.8\n",
                  width_, height_)
            : fmt::format(
                  "set terminal pngcairo size {},{} font 'DejaVu Sans,13' fontscale 1.5 linewidth 2 "
                  "pointscale 2\n",
                  2.0 * width_, 2.0 * height_);
    return start + fmt::format(
                       "set encoding utf8\nset border 3 lc rgb {0}\nset tics nomirror out textcolor rgb {0}\n"
                       "set xtics scale 0\nset grid ytics lc rgb '#e4e4e4' lt 1\nset style fill solid "
                       "noborder\nunset key\n",
                       dark);
  }

  /// Where the next plot lies: distances of its sides from the sheet's left and top.
  std::string plot_area(double left, double right, double top, double bottom) const {
    return fmt::format(
        "set lmargin at screen {}\nset rmargin at screen {}\nset tmargin at screen {}\nset bmargin at "
        "screen {}\n",
        x(left), x(right), y(top), y(bottom));
  }

  std::string text(double from_left, double from_top, const std::string& text) const {
    return fmt::format("set label '{}' at screen {},{} center textcolor rgb {} font ',11'\n", text,
                       x(from_left), y(from_top), grey);
  }

 private:
  double width_, height_;
};

/// The names of the methods and how each is drawn, in rows across the top.
class Legend {
 public:
  Legend(const std::vector<MethodSummary>& summaries, double width) {
    constexpr double per_character = 7.5, mark_and_gap = 46.0;
    double used = 0.0;
    for (const MethodSummary& summary : summaries) {
      std::string name = one_line(summary.method);
      if (name.size() > most_bytes) name = "..." + name.substr(name.size() - most_bytes);
      const double needed = mark_and_gap + per_character * static_cast<double>(name.size());
      if (rows_.empty() || used + needed > width) {
        rows_.emplace_back();
        used = 0.0;
      }
      rows_.back().entries.push_back({name, used});
      used += needed;
      rows_.back().width = used;
    }
  }

  double height() const { return row_height * static_cast<double>(rows_.size()); }

  /// \param mark the point type of a method.
  template <typename MarkOf>
  std::string script(const Sheet& sheet, const MarkOf& mark) const {
    std::string script;
    std::size_t method = 0;
    for (std::size_t row = 0; row < rows_.size(); ++row)
      for (const Entry& entry : rows_[row].entries) {
        script += fmt::format(
            "set label {} noenhanced at screen {},{} left offset 0.9,-0.15 textcolor rgb {} "
            "point pt {} lc rgb {}\n",
            quoted_for_gnuplot(entry.name),
            sheet.x(0.5 * (sheet.width() - rows_[row].width) + 20.0 + entry.left),
            sheet.y(20.0 + row_height * static_cast<double>(row)), dark, mark(method), hex(color_of(method)));
        ++method;
      }
    return script;
  }

 private:
  static constexpr std::size_t most_bytes = 30;
  static constexpr double row_height = 22.0;
  struct Entry {
    std::string name;
    double left;
  };
  struct Row {
    std::vector<Entry> entries;
    double width = 0.0;
  };
  std::vector<Row> rows_;
};

/// A name for data that the script holds itself, and the data.
std::string block(const std::string& name, const std::vector<std::string>& lines) {
  return fmt::format("{} << END\n{}\nEND\n", name, fmt::join(lines, "\n"));
}

bool any_ambiguous(const std::vector<MethodSummary>& summaries) {
  return std::any_of(summaries.begin(), summaries.end(), [](const MethodSummary& summary) {
    return std::any_of(summary.thresholds.begin(), summary.thresholds.end(), [](const auto& tallies) {
      return std::any_of(tallies.begin(), tallies.end(), [](const Tally& t) { return t.ambiguous > 0; });
    });
  });
}

/// Where method i of n stands beside the middle of its group.
double place(std::size_t i, std::size_t n, double width) {
  return (static_cast<double>(i) + 0.5 - 0.5 * static_cast<double>(n)) * width;
}

std::string bars_name(std::size_t translation, std::size_t method) {
  return fmt::format("$bars_{}_{}", translation, method);
}

/// Middle of the bar, height of its full part, height of it all.
std::string bars(const MethodSummary& summary, std::size_t translation, const std::string& name,
                 double beside) {
  std::vector<std::string> lines;
  for (std::size_t y = 0; y < paper_yaws_deg.size(); ++y) {
    const Tally& tally = summary.thresholds[translation][y];
    lines.push_back(fmt::format("{} {} {}", static_cast<double>(y) + beside, tally.within,
                                tally.within + tally.ambiguous));
  }
  return block(name, lines);
}

std::string bar_plot(std::size_t translation, std::size_t methods, std::size_t total) {
  std::vector<std::string> plots{fmt::format("{} with lines dt (6,4) lw 1 lc rgb {}", total, grey)};
  for (std::size_t m = 0; m < methods; ++m) {
    const std::string data = bars_name(translation, m);
    plots.push_back(fmt::format("{} using 1:3 with boxes lc rgb {}", data, hex(paler(color_of(m)))));
    plots.push_back(fmt::format("{} using 1:2 with boxes lc rgb {}", data, hex(color_of(m))));
  }
  for (std::size_t m = 0; m < methods; ++m)
    plots.push_back(fmt::format("{} using 1:2:2 with labels offset 0,0.5 font ',{}' textcolor rgb {}",
                                bars_name(translation, m), methods <= 2 ? 11 : 9, dark));
  return fmt::format("plot {}\n", fmt::join(plots, ", \\\n     "));
}

/// Middle of the mark, share within, its interval, share with the ambiguous ones; percent.
std::string shares(const MethodSummary& summary, const std::string& name, double beside) {
  std::vector<std::string> lines;
  for (std::size_t b = 0; b < summary.visibility.size(); ++b) {
    const Tally& tally = summary.visibility[b].tally;
    if (tally.objects == 0) continue;
    const auto [low, high] = wilson_interval(tally.within, tally.objects);
    const double percent = 100.0 / static_cast<double>(tally.objects);
    lines.push_back(fmt::format("{} {} {} {} {}", static_cast<double>(b) + beside,
                                percent * static_cast<double>(tally.within), 100.0 * low, 100.0 * high,
                                percent * static_cast<double>(tally.within + tally.ambiguous)));
  }
  return block(name, lines);
}

}  // namespace

std::string threshold_figure(const std::vector<MethodSummary>& summaries, FigureFormat format) {
  const std::size_t n = std::max<std::size_t>(1, summaries.size());
  const double bar = std::min(0.5, 0.84 / static_cast<double>(n));
  std::size_t total = 1;
  for (const MethodSummary& summary : summaries) total = std::max(total, summary.right.objects);
  constexpr double width = 1100.0;
  const Legend legend(summaries, width);
  const double top = legend.height() + 48.0, bottom = top + 280.0;
  const Sheet sheet(width, bottom + 82.0);

  std::string script = sheet.terminal(format);
  for (std::size_t m = 0; m < summaries.size(); ++m)
    for (std::size_t t = 0; t < paper_translations.size(); ++t)
      script += bars(summaries[m], t, bars_name(t, m), place(m, n, bar));
  std::vector<std::string> tics;
  for (std::size_t y = 0; y < paper_yaws_deg.size(); ++y)
    tics.push_back(fmt::format(
        "'{}' {}", paper_yaws_deg[y] >= 180.0 ? "180° (any)" : fmt::format("{}°", paper_yaws_deg[y]), y));
  script += fmt::format(
      "set multiplot\nset xrange [-0.6:3.6]\nset yrange [0:{}]\nset boxwidth {}\nset xtics ({})\n"
      "set xlabel 'yaw error below' textcolor rgb {}\nset ylabel 'objects recognized' textcolor rgb {}\n",
      1.13 * static_cast<double>(total), 0.94 * bar, fmt::join(tics, ", "), dark, dark);
  for (std::size_t t = 0; t < paper_translations.size(); ++t) {
    const double left = 76.0 + 343.0 * static_cast<double>(t);
    script += sheet.plot_area(left, left + 315.0, top, bottom);
    script += fmt::format(
        "set title 'translation error below {:.0f} cm' textcolor rgb {}\nunset label\n"
        "set label 'all {}' at -0.55,{} offset 0,0.45 textcolor rgb {} font ',11'\n",
        100.0 * paper_translations[t], dark, total, total, grey);
    if (t == 0) script += legend.script(sheet, [](std::size_t) { return mark_of(1).full; });
    if (t == 0 && any_ambiguous(summaries))
      script +=
          sheet.text(0.5 * width, bottom + 68.0,
                     "paler: ambiguous, that is, not within, but the pose found fits the depth image as "
                     "well as the true one");
    script += bar_plot(t, summaries.size(), total) + "unset ylabel\n";
  }
  return script + "unset multiplot\n";
}

std::string visibility_figure(const std::vector<MethodSummary>& summaries, FigureFormat format) {
  const std::size_t n = std::max<std::size_t>(1, summaries.size());
  const double apart = std::min(0.16, 0.7 / static_cast<double>(n));
  constexpr double width = 760.0;
  const Legend legend(summaries, width);
  const double top = legend.height() + 24.0, bottom = top + 290.0;
  const Sheet sheet(width, bottom + 104.0);

  std::string script =
      sheet.terminal(format) + legend.script(sheet, [](std::size_t m) { return mark_of(m).full; });
  std::vector<std::string> tics, plots;
  if (!summaries.empty())
    for (const VisibilityBin& bin : summaries.front().visibility)
      tics.push_back(fmt::format("\"{:.0f} to {:.0f} %%\\n{} object{}\" {}", 100.0 * bin.low,
                                 100.0 * bin.high, bin.tally.objects, bin.tally.objects == 1 ? "" : "s",
                                 tics.size()));
  for (std::size_t m = 0; m < summaries.size(); ++m) {
    const std::string data = fmt::format("$recall_{}", m), color = hex(color_of(m));
    script += shares(summaries[m], data, place(m, n, apart));
    plots.push_back(fmt::format("{} using 1:2 with lines lw 1.5 lc rgb {}", data, hex(paler(color_of(m)))));
    plots.push_back(fmt::format("{} using 1:5 with points pt {} lc rgb {}", data, mark_of(m).hollow, color));
    plots.push_back(
        fmt::format("{} using 1:2:3:4 with yerrorbars lw 1.2 pt {} lc rgb {}", data, mark_of(m).full, color));
  }
  script += sheet.plot_area(98.0, width - 20.0, top, bottom);
  script +=
      sheet.text(0.5 * width, bottom + 90.0,
                 any_ambiguous(summaries) ? "hollow: ambiguous ones counted as well; bars: 95 % intervals"
                                          : "bars: 95 % intervals");
  return script +
         fmt::format(
             "set xrange [-0.5:4.5]\nset yrange [0:105]\nset ytics 20\nset format y '%g %%'\n"
             "set xtics ({})\nset xlabel 'visible part of the object' textcolor rgb {} offset 0,-0.6\n"
             "set ylabel 'within 1 cm and 10°' textcolor rgb {}\nplot {}\n",
             fmt::join(tics, ", "), dark, dark, fmt::join(plots, ", \\\n     "));
}

}  // namespace perch
