#include <functional>
#include <random>

#include "command_line_test_support.hpp"

// Files damaged at random: the program may answer or refuse, but never crash, hang or leave half of anything.
namespace perch::command_line {
namespace {

class Damage : public CommandLine {
 protected:
  /// Cuts the bytes short, or flips, overwrites, removes or doubles a few of them.
  static std::string damaged(std::string bytes, std::mt19937_64& random) {
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    if (below(5) == 0) return bytes.substr(0, below(bytes.size()));
    for (std::size_t edits = 1 + below(4); edits > 0 && !bytes.empty(); --edits) {
      // Headers and the last bytes are where a byte means most.
      const std::size_t at =
          below(2) == 0 ? below(std::min<std::size_t>(bytes.size(), 300)) : below(bytes.size());
      const std::size_t length = std::min(1 + below(20), bytes.size() - at);
      switch (below(5)) {
        case 0:
          bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
          break;
        case 1:
          bytes[at] = static_cast<char>(below(256));
          break;
        case 2:
          bytes[at] = "0123456789-.[]{}:, \n"[below(20)];
          break;
        case 3:
          bytes.erase(at, length);
          break;
        default:
          bytes.insert(at, bytes.substr(at, length));
      }
    }
    return bytes;
  }

  /// The file is what `bytes` makes of a random number generator, a number of times.
  void survives(const std::string& file, std::uint64_t first_seed, int runs,
                const std::function<std::string(std::mt19937_64&)>& bytes) const {
    for (int i = 0; i < runs; ++i) {
      const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
      SCOPED_TRACE(file + " damaged with seed " + std::to_string(seed));
      std::mt19937_64 random(seed);
      write(folder() / file, bytes(random));
      const Outcome outcome =
          run_program(folder(), coarse({"localize", "scene.yaml", "--time-limit", "0.5", "-o", "out"}),
                      std::chrono::seconds(60));
      EXPECT_EQ(outcome.signal, 0) << outcome;
      EXPECT_LE(outcome.status, 3) << outcome;
      EXPECT_EQ(outcome.err.find("internal error"), std::string::npos) << outcome;
      if (outcome.status == 2) {
        EXPECT_LE(outcome.error_lines(), 2) << outcome;
        EXPECT_EQ(outcome.err.substr(0, 7), "perch: ") << outcome;
        EXPECT_FALSE(fs::exists(folder() / "out")) << outcome;
      } else if (outcome.signal == 0) {
        EXPECT_NO_THROW(json("out/result.json")) << outcome;
        EXPECT_TRUE(fs::exists(folder() / "out/picture.png")) << outcome;
      }
      fs::remove_all(folder() / "out");
    }
  }
};

TEST_F(Damage, OfTheSceneFile) {
  survives("scene.yaml", 1000, 60, [&](auto& random) { return damaged(yaml, random); });
}

TEST_F(Damage, OfTheDepthImage) {
  const std::string whole = bytes_of(folder() / "depth.png");
  survives("depth.png", 2000, 40, [&](auto& random) { return damaged(whole, random); });
}

TEST_F(Damage, OfAMesh) {
  const std::string whole = bytes_of(folder() / "models/mug.ply");
  survives("models/mug.ply", 3000, 50, [&](auto& random) { return damaged(whole, random); });
}

// A whole PNG whose counts mean nothing, as a mistaken conversion leaves them.
TEST_F(Damage, OfTheDepthsThemselves) {
  const Image<std::uint16_t> whole = read_png16_gray(folder() / "depth.png", 160, 120);
  survives("depth.png", 4000, 10, [&](auto& random) {
    Image<std::uint16_t> counts = whole;
    const std::size_t begin = random() % counts.size(), length = 1 + random() % 3000;
    const auto kind = random() % 3;
    for (std::size_t i = begin; i < std::min(counts.size(), begin + length); ++i)
      counts[i] = static_cast<std::uint16_t>(kind == 0   ? random()
                                             : kind == 1 ? counts[i] << 8 | counts[i] >> 8
                                                         : 1 + random() % 10);
    return encode_png16_gray(counts);
  });
}

}  // namespace
}  // namespace perch::command_line
