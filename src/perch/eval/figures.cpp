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

/// \param width,height of the SVG; the PNG has twice as many pixels.
std::string terminal(FigureFormat format, int width, int height) {
  const std::string start =
      format == FigureFormat::svg
          ? fmt::format("set terminal svg size {},{} font 'DejaVu Sans,13' background '#ffffff'\n", width,
                        height)
          : fmt::format(
                "set terminal pngcairo size {},{} font 'DejaVu Sans,13' fontscale 1.5 linewidth 2 "
                "pointscale 2\n",
                2 * width, 2 * height);
  return start + fmt::format(
                     "set encoding utf8\n"
                     "set border 3 lc rgb {0}\n"
                     "set tics nomirror out textcolor rgb {0}\n"
                     "set xtics scale 0\n"
                     "set grid ytics lc rgb '#e4e4e4' lt 1\n"
                     "set key noenhanced textcolor rgb {0}\n"
                     "set style fill solid noborder\n",
                     dark);
}

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

/// Where method i of n stands in a group of width 1, from -0.5 to 0.5.
double place(std::size_t i, std::size_t n, double width) {
  return (static_cast<double>(i) + 0.5 - 0.5 * static_cast<double>(n)) * width;
}

}  // namespace

std::string threshold_figure(const std::vector<MethodSummary>& summaries, FigureFormat format) {
  const std::size_t n = std::max<std::size_t>(1, summaries.size());
  const double bar = std::min(0.5, 0.84 / static_cast<double>(n));
  std::size_t total = 1;
  for (const MethodSummary& summary : summaries) total = std::max(total, summary.right.objects);

  std::string script = terminal(format, 1100, 420);
  for (std::size_t m = 0; m < summaries.size(); ++m)
    for (std::size_t t = 0; t < paper_translations.size(); ++t) {
      std::vector<std::string> lines;
      for (std::size_t y = 0; y < paper_yaws_deg.size(); ++y) {
        const Tally& tally = summaries[m].thresholds[t][y];
        lines.push_back(fmt::format("{} {} {}", static_cast<double>(y) + place(m, n, bar), tally.within,
                                    tally.within + tally.ambiguous));
      }
      script += block(fmt::format("$bars_{}_{}", t, m), lines);
    }
  script += fmt::format(
      "set multiplot\n"
      "set tmargin at screen 0.80\nset bmargin at screen 0.15\n"
      "set xrange [-0.6:3.6]\nset yrange [0:{}]\nset boxwidth {}\n",
      1.13 * static_cast<double>(total), 0.94 * bar);
  std::vector<std::string> tics;
  for (std::size_t y = 0; y < paper_yaws_deg.size(); ++y)
    tics.push_back(fmt::format(
        "'{}' {}", paper_yaws_deg[y] >= 180.0 ? "180° (any)" : fmt::format("{}°", paper_yaws_deg[y]), y));
  script += fmt::format("set xtics ({})\nset xlabel 'yaw error below' textcolor rgb {}\n",
                        fmt::join(tics, ", "), dark);

  for (std::size_t t = 0; t < paper_translations.size(); ++t) {
    const double left = 0.06 + 0.315 * static_cast<double>(t);
    script += fmt::format("set lmargin at screen {}\nset rmargin at screen {}\n", left, left + 0.29);
    script += fmt::format("set title 'translation error below {:.0f} cm' textcolor rgb {}\n",
                          100.0 * paper_translations[t], dark);
    script +=
        t == 0 ? fmt::format(
                     "set ylabel 'objects recognized' textcolor rgb {}\n"
                     "set key at screen 0.5,0.97 center top horizontal maxrows 1 reverse Left samplen 1.5\n",
                     dark)
               : "unset ylabel\nunset key\n";
    script += fmt::format(
        "unset label\nset label 'all {0}' at -0.55,{0} offset 0,0.45 textcolor rgb {1} font ',11'\n", total,
        grey);
    std::vector<std::string> plots;
    plots.push_back(fmt::format("{} with lines dt (6,4) lw 1 lc rgb {} notitle", total, grey));
    for (std::size_t m = 0; m < summaries.size(); ++m) {
      const std::string data = fmt::format("$bars_{}_{}", t, m);
      plots.push_back(
          fmt::format("{} using 1:3 with boxes lc rgb {} notitle", data, hex(paler(color_of(m)))));
      plots.push_back(fmt::format("{} using 1:2 with boxes lc rgb {} title {}", data, hex(color_of(m)),
                                  quoted_for_gnuplot(one_line(summaries[m].method))));
    }
    for (std::size_t m = 0; m < summaries.size(); ++m)
      plots.push_back(
          fmt::format("$bars_{}_{} using 1:2:2 with labels offset 0,0.5 font ',{}' textcolor rgb {} notitle",
                      t, m, n <= 2 ? 11 : 9, dark));
    if (t == 0 && any_ambiguous(summaries))
      plots.push_back(
          "keyentry with boxes lc rgb '#d0d0d0' title 'paler: the view fits the pose found as well as the "
          "true one'");
    script += fmt::format("plot {}\n", fmt::join(plots, ", \\\n     "));
  }
  return script + "unset multiplot\n";
}

std::string visibility_figure(const std::vector<MethodSummary>& summaries, FigureFormat format) {
  const std::size_t n = std::max<std::size_t>(1, summaries.size());
  const double apart = std::min(0.16, 0.6 / static_cast<double>(n));
  std::string script = terminal(format, 760, 440);
  std::vector<std::string> tics;
  for (std::size_t m = 0; m < summaries.size(); ++m) {
    std::vector<std::string> lines;
    for (std::size_t b = 0; b < summaries[m].visibility.size(); ++b) {
      const VisibilityBin& bin = summaries[m].visibility[b];
      const Tally& tally = bin.tally;
      if (m == 0)
        tics.push_back(fmt::format("\"{:.0f} to {:.0f} %%\\n{} object{}\" {}", 100.0 * bin.low,
                                   100.0 * bin.high, tally.objects, tally.objects == 1 ? "" : "s", b));
      if (tally.objects == 0) continue;
      const auto [low, high] = wilson_interval(tally.within, tally.objects);
      const double percent = 100.0 / static_cast<double>(tally.objects);
      lines.push_back(fmt::format("{} {} {} {} {}", static_cast<double>(b) + place(m, n, apart),
                                  percent * static_cast<double>(tally.within), 100.0 * low, 100.0 * high,
                                  percent * static_cast<double>(tally.within + tally.ambiguous)));
    }
    script += block(fmt::format("$recall_{}", m), lines);
  }
  script += fmt::format(
      "set tmargin at screen 0.86\nset bmargin at screen 0.21\nset lmargin at screen 0.10\nset rmargin at "
      "screen 0.97\n"
      "set xrange [-0.5:4.5]\nset yrange [0:105]\nset ytics 20\nset format y '%g %%'\nset xtics ({})\n"
      "set xlabel 'visible part of the object' textcolor rgb {} offset 0,-0.8\n"
      "set ylabel 'within 1 cm and 10°' textcolor rgb {}\n"
      "set key at screen 0.53,0.975 center top horizontal maxrows 1 reverse Left samplen 1.5\n",
      fmt::join(tics, ", "), dark, dark);
  constexpr std::array<std::array<int, 2>, 4> marks{{{7, 6}, {5, 4}, {9, 8}, {13, 12}}};  // full and hollow
  std::vector<std::string> plots;
  for (std::size_t m = 0; m < summaries.size(); ++m) {
    const std::string data = fmt::format("$recall_{}", m), full = hex(color_of(m));
    const auto& mark = marks[m % marks.size()];
    plots.push_back(
        fmt::format("{} using 1:2 with lines lw 1.5 lc rgb {} notitle", data, hex(paler(color_of(m)))));
    plots.push_back(
        fmt::format("{} using 1:5 with points pt {} ps 0.9 lc rgb {} notitle", data, mark[1], full));
    plots.push_back(fmt::format("{} using 1:2:3:4 with yerrorbars lw 1.2 pt {} ps 0.9 lc rgb {} title {}",
                                data, mark[0], full, quoted_for_gnuplot(one_line(summaries[m].method))));
  }
  if (any_ambiguous(summaries))
    plots.push_back(fmt::format(
        "keyentry with points pt 6 ps 0.9 lc rgb {} title 'hollow: ambiguous ones counted too'", grey));
  return script + fmt::format("plot {}\n", fmt::join(plots, ", \\\n     "));
}

}  // namespace perch
