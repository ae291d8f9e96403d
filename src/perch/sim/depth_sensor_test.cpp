#include "perch/sim/depth_sensor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "perch/core/error.hpp"
#include "perch/core/random.hpp"

namespace perch {
namespace {

const Intrinsics camera{640, 480, 525, 525, 319.5, 239.5};

DepthImage wall(float depth) {
  return {camera.width, camera.height, depth};
}

/// One effect at a time.
DepthSensorSettings only_quantization() {
  DepthSensorSettings s = DepthSensorSettings::clean();
  s.disparity_step = 0.125;
  return s;
}
DepthSensorSettings only_shadow() {
  DepthSensorSettings s = DepthSensorSettings::clean();
  s.projector_shadow = true;
  return s;
}

TEST(DepthSensor, CleanReturnsItsInput) {
  DepthImage ideal(camera.width, camera.height);
  Random random(1);
  for (std::size_t i = 0; i < ideal.size(); ++i)
    if (random.uniform() < 0.7) ideal[i] = static_cast<float>(random.uniform(0.05, 20));
  EXPECT_EQ(sense_depth(ideal, camera, DepthSensorSettings::clean(), 3), ideal);
}

TEST(DepthSensor, StepsOfDepthFollowTheDisparity) {
  // Neighbouring readings around z lie z^2 / (8 f b) apart, and each is the nearest one to its depth.
  for (const double z : {0.5, 0.9, 1.5, 3.0}) {
    DepthImage ideal = wall(0);
    const double step = z * z / (8 * camera.fx * 0.075);
    for (int u = 0; u < camera.width; ++u)
      for (int v = 0; v < camera.height; ++v)
        ideal(u, v) = static_cast<float>(z + 4 * step * (u - 320) / 320.0);
    const DepthImage read = sense_depth(ideal, camera, only_quantization(), 5);
    std::set<float> readings;
    for (std::size_t i = 0; i < read.size(); ++i) {
      readings.insert(read[i]);
      EXPECT_LE(std::abs(read[i] - ideal[i]), 0.5 * step * 1.1);
    }
    ASSERT_GE(readings.size(), 8U);
    for (auto a = readings.begin(), b = std::next(a); b != readings.end(); ++a, ++b)
      EXPECT_NEAR((*b - *a) / (static_cast<double>(*a) * *b / (8 * camera.fx * 0.075)), 1.0, 1e-3);
  }
}

TEST(DepthSensor, ThinnedImagesKeepTheSensorsSteps) {
  const Intrinsics small{160, 120, 525.0 / 4, 525.0 / 4, 79.5, 59.5};
  DepthSensorSettings s = only_quantization();
  s.focal_length = 525;
  const DepthImage read = sense_depth(DepthImage(160, 120, 0.9137F), small, s, 1);
  EXPECT_EQ(read(3, 4), sense_depth(wall(0.9137F), camera, only_quantization(), 1)(3, 4));
}

TEST(DepthSensor, AnOffsetMovesTheSteps) {
  DepthSensorSettings s = only_quantization();
  const double between = 525 * 0.075 / 45.0625;  // half way between two steps
  s.disparity_offset = 0.0625;
  EXPECT_NEAR(sense_depth(wall(static_cast<float>(between)), camera, s, 1)(9, 9), between, 1e-5);
}

TEST(DepthSensor, NoiseHasItsStandardDeviationInDisparity) {
  DepthSensorSettings s = DepthSensorSettings::clean();
  s.disparity_noise = 0.1;
  for (const float z : {0.6F, 1.2F, 2.4F}) {
    const DepthImage read = sense_depth(wall(z), camera, s, 11);
    double sum = 0, squares = 0, depth_squares = 0;
    for (std::size_t i = 0; i < read.size(); ++i) {
      const double error = 525 * 0.075 * (1.0 / read[i] - 1.0 / z);
      sum += error;
      squares += error * error;
      depth_squares += (read[i] - z) * (read[i] - z);
    }
    const auto n = static_cast<double>(read.size());
    EXPECT_NEAR(sum / n, 0, 5 * 0.1 / std::sqrt(n));
    EXPECT_NEAR(std::sqrt(squares / n), 0.1, 5 * 0.1 / std::sqrt(2 * n));
    // sigma_z = z^2 sigma_d / (f b) [K]
    EXPECT_NEAR(std::sqrt(depth_squares / n) / (z * z * 0.1 / (525 * 0.075)), 1.0, 0.02);
  }
}

/// A screen before a wall, columns [320, 420).
DepthImage screen_and_wall(float near, float far) {
  DepthImage ideal = wall(far);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 320; u < 420; ++u) ideal(u, v) = near;
  return ideal;
}

TEST(DepthSensor, ShadowFallsAwayFromTheProjectorAsWideAsTheDisparitiesDiffer) {
  for (const auto& [near, far] : {std::pair{0.8F, 1.2F}, {0.6F, 0.7F}, {1.0F, 3.0F}}) {
    const double width = 525 * 0.075 * (1 / near - 1 / far);
    for (const double baseline : {0.075, -0.075}) {
      DepthSensorSettings s = only_shadow();
      s.baseline = baseline;
      const DepthImage read = sense_depth(screen_and_wall(near, far), camera, s, 1);
      for (int v = 0; v < camera.height; v += 37) {
        int left = 0, right = 0, elsewhere = 0;
        for (int u = 0; u < camera.width; ++u) {
          if (read(u, v) > 0) continue;
          if (u < 320 && u > 320 - width - 2)
            ++left;
          else if (u >= 420 && u < 420 + width + 2)
            ++right;
          else
            ++elsewhere;
        }
        EXPECT_NEAR(baseline > 0 ? left : right, width, 0.501);  // the projector is on the other side
        EXPECT_EQ(baseline > 0 ? right : left, 0);
        EXPECT_EQ(elsewhere, 0);
      }
    }
  }
}

TEST(DepthSensor, ShadowOfAPoleIsAsWideAsThePole) {
  // A shift by the disparities' difference moves the pole's shadow clear of it: what lies between is lit.
  DepthImage ideal = wall(2.0F);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 400; u < 406; ++u) ideal(u, v) = 0.8F;
  const double shift = 525 * 0.075 * (1 / 0.8 - 1 / 2.0);  // 29.5 pixels
  const DepthImage read = sense_depth(ideal, camera, only_shadow(), 1);
  int lost = 0;
  for (int u = 0; u < camera.width; ++u) {
    if (read(u, 100) > 0) continue;
    ++lost;
    EXPECT_NEAR(u, 402.5 - shift, 3.5);
  }
  EXPECT_EQ(lost, 6);
}

TEST(DepthSensor, SlantedSurfacesDontShadowThemselves) {
  DepthImage ideal = wall(0);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      // Planes turned by 60 degrees to either side, joined in a ridge in the middle of the image.
      const double x = std::abs(u - 319.5) / 525;
      ideal(u, v) = static_cast<float>(0.8 / (1 - 0.4 * std::tan(std::numbers::pi / 3) * x));
    }
  EXPECT_EQ(sense_depth(ideal, camera, only_shadow(), 1), ideal);
}

TEST(DepthSensor, JitterMovesEdgesByAboutItsDeviationAndLeavesSurfacesAlone) {
  DepthSensorSettings s = DepthSensorSettings::clean();
  s.edge_jitter = 0.8;
  const DepthImage ideal = screen_and_wall(0.8F, 1.2F);
  const DepthImage read = sense_depth(ideal, camera, s, 4);
  std::vector<int> strangers(640, 0);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      EXPECT_TRUE(read(u, v) == 0.8F || read(u, v) == 1.2F);
      strangers[static_cast<std::size_t>(u)] += read(u, v) != ideal(u, v);
    }
  const auto normal_above = [](double x) { return 0.5 * std::erfc(x / std::sqrt(2.0)); };
  // At k pixels from the border a pixel looks across it when its jitter is above k - 1/2.
  for (int k = 1; k <= 3; ++k) {
    const double expected = camera.height * normal_above((k - 0.5) / 0.8);
    EXPECT_NEAR(strangers[static_cast<std::size_t>(319 + k)], expected, 5 * std::sqrt(expected + 1));
    EXPECT_NEAR(strangers[static_cast<std::size_t>(320 - k)], expected, 5 * std::sqrt(expected + 1));
  }
  EXPECT_EQ(strangers[300], 0);
  EXPECT_EQ(strangers[370], 0);
}

TEST(DepthSensor, DropOutsAtRandomAreBinomial) {
  DepthSensorSettings s = DepthSensorSettings::clean();
  for (const double rate : {0.0, 0.01, 0.3, 1.0}) {
    s.dropout_rate = rate;
    const DepthImage read = sense_depth(wall(1), camera, s, 8);
    const auto lost = static_cast<double>(std::count(read.data().begin(), read.data().end(), 0.0F));
    const auto n = static_cast<double>(read.size());
    EXPECT_NEAR(lost, n * rate, 5 * std::sqrt(n * rate * (1 - rate)));
  }
}

TEST(DepthSensor, GrazingReadingsGetLostInProportion) {
  DepthSensorSettings s = DepthSensorSettings::clean();
  s.grazing_start = 1.0;
  s.grazing_end = 1.4;
  for (const double angle : {0.5, 1.1, 1.3, 1.45}) {
    // A plane through (0, 0, 1) turned about the y axis; the middle column sees it at that angle.
    DepthImage ideal = wall(0);
    for (int v = 0; v < camera.height; ++v)
      for (int u = 300; u < 340; ++u)
        ideal(u, v) = static_cast<float>(1.0 / (1.0 - std::tan(angle) * (u - 319.5) / 525));
    int lost = 0, seen = 0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      const DepthImage read = sense_depth(ideal, camera, s, seed);
      for (int v = 200; v < 280; ++v)  // rows near the axis, where no second slant adds to the angle
        for (int u = 318; u < 322; ++u) (read(u, v) > 0 ? seen : lost)++;
    }
    const double n = lost + seen, share = std::clamp((angle - 1.0) / 0.4, 0.0, 1.0);
    EXPECT_NEAR(lost / n, share, 5 * std::sqrt(share * (1 - share) / n) + 0.01);
  }
}

TEST(DepthSensor, ReadsNothingOutsideItsRange) {
  DepthSensorSettings s = DepthSensorSettings::clean();
  s.nearest = 0.4;
  s.farthest = 5;
  EXPECT_EQ(sense_depth(wall(0.39F), camera, s, 1), wall(0));
  EXPECT_EQ(sense_depth(wall(5.01F), camera, s, 1), wall(0));
  EXPECT_EQ(sense_depth(wall(0.41F), camera, s, 1), wall(0.41F));
}

TEST(DepthSensor, TheSeedDecides) {
  const DepthImage ideal = screen_and_wall(0.8F, 1.2F);
  const DepthImage read = sense_depth(ideal, camera, {}, 42);
  EXPECT_EQ(read, sense_depth(ideal, camera, {}, 42));
  EXPECT_NE(read, sense_depth(ideal, camera, {}, 43));
}

TEST(DepthSensor, OneEffectDoesNotReshuffleAnother) {
  DepthSensorSettings drop = DepthSensorSettings::clean();
  drop.dropout_rate = 0.1;
  DepthSensorSettings both = drop;
  both.disparity_noise = 0.1;
  const DepthImage a = sense_depth(wall(1), camera, drop, 6), b = sense_depth(wall(1), camera, both, 6);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i] > 0, b[i] > 0);
}

TEST(DepthSensor, TimeOfFlightNoiseGrowsWithTheSquareOfTheDistanceAndTheSlant) {
  const Intrinsics small{64, 64, 525, 525, 31.5, 31.5};
  DepthSensorSettings s = DepthSensorSettings::clean();
  s.depth_noise = 0.0005;
  s.amplitude_noise = 0.001;
  for (const double slant : {0.0, 1.0})
    for (const double z : {0.6, 2.0}) {
      // A plane through (0, 0, z) turned about the y axis by the slant; near the middle it is seen at that
      // angle.
      DepthImage ideal(64, 64);
      for (int v = 0; v < 64; ++v)
        for (int u = 0; u < 64; ++u)
          ideal(u, v) = static_cast<float>(z / (1.0 - std::tan(slant) * (u - 31.5) / 525));
      double squares = 0;
      int n = 0;
      for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const DepthImage read = sense_depth(ideal, small, s, seed);
        for (int v = 1; v < 63; ++v)
          for (int u = 24; u < 40; ++u, ++n) squares += std::pow(read(u, v) - ideal(u, v), 2);
      }
      const double expected = 0.0005 + 0.001 * z * z / std::cos(slant);
      EXPECT_NEAR(std::sqrt(squares / n) / expected, 1.0, 0.05) << z << " m at " << slant;
    }
}

TEST(DepthSensor, FlyingPixelsLieBetweenTheSurfacesAndOnlyAtTheirBorder) {
  DepthSensorSettings s = DepthSensorSettings::clean();
  s.flying_pixels = 0.5;
  const double near = 0.8, far = 1.2;
  const DepthImage ideal = screen_and_wall(0.8F, 1.2F), read = sense_depth(ideal, camera, s, 4);
  // At half of the area each, the nearer surface sends (far / near)^2 times as much light back.
  const double half = (1 / near + 1 / far) / (1 / (near * near) + 1 / (far * far));
  int flying = 0;
  double nearest_of_wall = far, farthest_of_screen = near;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      if (read(u, v) == ideal(u, v)) continue;
      ++flying;
      EXPECT_TRUE(u == 319 || u == 320 || u == 419 || u == 420) << u;
      if (ideal(u, v) == 1.2F)
        nearest_of_wall = std::min(nearest_of_wall, double{read(u, v)});
      else
        farthest_of_screen = std::max(farthest_of_screen, double{read(u, v)});
    }
  EXPECT_NEAR(flying, 0.5 * 4 * camera.height, 5 * std::sqrt(0.25 * 4 * camera.height));
  EXPECT_GE(nearest_of_wall, half - 1e-6);
  EXPECT_LE(farthest_of_screen, half + 1e-6);
  EXPECT_NEAR(nearest_of_wall, half, 0.005);
  EXPECT_NEAR(farthest_of_screen, half, 0.005);
}

TEST(DepthSensor, SaysWhereAReadingWasMade) {
  DepthSensorSettings s = DepthSensorSettings::clean();
  s.edge_jitter = 0.8;
  const DepthImage ideal = screen_and_wall(0.8F, 1.2F);
  const SensedDepth read = sense(ideal, camera, s, 4, Image<std::uint16_t>(camera.width, camera.height, 1));
  int elsewhere = 0;
  for (std::size_t i = 0; i < ideal.size(); ++i) {
    EXPECT_EQ(read.depth[i], ideal[read.source[i]]);
    elsewhere += read.source[i] != i;
  }
  EXPECT_GT(elsewhere, 100);
}

TEST(DepthSensor, ShortBaselinesAreNoisierInDepth) {
  // sigma_z = z^2 sigma_d / (f b), of Intel's D435 at 0.9 m: 0.08 pixels of 848 across 90 degrees, 50 mm.
  DepthSensorSettings s = DepthSensorSettings::structured_light();
  s.dropout_rate = 0;
  const DepthImage read = sense_depth(wall(0.9F), camera, s, 2);
  double squares = 0;
  for (std::size_t i = 0; i < read.size(); ++i) squares += std::pow(read[i] - 0.9, 2);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(read.size())), 0.81 * 0.08 / (424 * 0.05), 2e-4);
}

/// A wall at 1 m with dark patches, seen by a thinned image.
struct DarkWall {
  double share = 0.0;     ///< without a reading
  double mean_run = 0.0;  ///< of pixels without one along the rows, metres
  Image<std::uint8_t> dark;
};

DarkWall dark_wall(double share, double size, std::uint64_t seed) {
  const Intrinsics thinned{200, 150, 164, 164, 99.5, 74.5};
  DepthSensorSettings s = DepthSensorSettings::clean();
  s.dark_patches = share;
  s.dark_patch_size = size;
  const DepthImage read = sense_depth(DepthImage(200, 150, 1.0F), thinned, s, seed);
  DarkWall out{0.0, 0.0, Image<std::uint8_t>(200, 150, 0)};
  double pixels = 0, runs = 0;
  for (int v = 0; v < read.height(); ++v)
    for (int u = 0; u < read.width(); ++u) {
      out.dark(u, v) = read(u, v) == 0.0F;
      pixels += out.dark(u, v);
      runs += out.dark(u, v) != 0 && (u == 0 || out.dark(u - 1, v) == 0);
    }
  out.share = pixels / static_cast<double>(read.size());
  out.mean_run = pixels / runs / thinned.fx;
  return out;
}

TEST(DepthSensor, DarkPatchesHaveTheirShareAndLieWithinThoseOfALargerOne) {
  const DarkWall few = dark_wall(0.1, 0.05, 3), many = dark_wall(0.4, 0.05, 3);
  EXPECT_NEAR(few.share, 0.1, 2e-5);
  EXPECT_NEAR(many.share, 0.4, 2e-5);
  for (std::size_t i = 0; i < few.dark.size(); ++i) EXPECT_LE(few.dark[i], many.dark[i]);
  EXPECT_NE(dark_wall(0.4, 0.05, 4).dark, many.dark);
  EXPECT_EQ(dark_wall(0.0, 0.05, 3).share, 0.0);
  EXPECT_EQ(dark_wall(1.0, 0.05, 3).share, 1.0);
}

TEST(DepthSensor, DarkPatchesHaveTheirSize) {
  // Rice's formula: a line is in dark for 2 pi l p exp(t^2 / 2) at a time, where the share p of a standard
  // normal field lies above t; the size is pi l.
  for (const double size : {0.06, 0.09})
    for (const auto& [share, threshold] : {std::pair(0.5, 0.0), {0.2, 0.8416}}) {
      double mean = 0.0;
      constexpr int seeds = 6;
      for (std::uint64_t seed = 1; seed <= seeds; ++seed)
        mean += dark_wall(share, size, seed).mean_run / seeds;
      EXPECT_NEAR(mean / (2 * size * share * std::exp(0.5 * threshold * threshold)), 1.0, 0.15);
    }
}

TEST(DepthSensor, RefusesWhatMakesNoSense) {
  const auto refused = [](auto change) {
    DepthSensorSettings s;
    change(s);
    EXPECT_THROW(s.check(), InvalidSetting);
  };
  EXPECT_NO_THROW(DepthSensorSettings{}.check());
  refused([](auto& s) { s.baseline = 0; });
  refused([](auto& s) { s.focal_length = -1; });
  refused([](auto& s) { s.disparity_noise = -0.1; });
  refused([](auto& s) { s.disparity_step = std::nan(""); });
  refused([](auto& s) { s.disparity_offset = std::nan(""); });
  refused([](auto& s) { s.edge_jitter = -1; });
  refused([](auto& s) { s.dropout_rate = 1.1; });
  refused([](auto& s) { s.dark_patches = 1.01; });
  refused([](auto& s) { s.dark_patch_size = 0; });
  refused([](auto& s) { s.grazing_start = 2; });
  refused([](auto& s) { s.grazing_end = 0.1; });
  refused([](auto& s) { s.surface_gap = -1; });
  refused([](auto& s) { s.nearest = 6; });
  refused([](auto& s) { s.depth_noise = -1; });
  refused([](auto& s) { s.amplitude_noise = std::nan(""); });
  refused([](auto& s) { s.flying_pixels = 1.5; });
  EXPECT_THROW(sense_depth(DepthImage(3, 4), camera, {}, 1), InvalidSetting);
}

}  // namespace
}  // namespace perch
