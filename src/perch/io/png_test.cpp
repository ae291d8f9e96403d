#include "perch/io/png.hpp"

#include "perch/core/random.hpp"
#include "perch/io/test_files.hpp"

namespace perch {
namespace {

using namespace testing_files;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int gray = 0, rgb = 2, palette = 3, gray_alpha = 4, rgb_alpha = 6;  // colour types in the standard

TEST(Png, Reads16BitGreyscaleMadeByHand) {
  const TemporaryDirectory dir;
  const auto path = dir.write(
      "d.png", handmade_png(3, 2, 16, gray, {std::string("\0\0\0\1\1\0", 6), "\xff\xff\x12\x34\x80\x01"}));
  const auto image = read_png16_gray(path, 3, 2);
  EXPECT_EQ(image.data(), (std::vector<std::uint16_t>{0, 1, 256, 65535, 0x1234, 0x8001}));
}

TEST(Png, WritesWhatItReads) {
  const TemporaryDirectory dir;
  Random random(3);
  Image<std::uint16_t> image(37, 19);
  for (std::size_t i = 0; i < image.size(); ++i) image[i] = static_cast<std::uint16_t>(random.below(65536));
  write_png16_gray(dir.path() / "d.png", image);
  EXPECT_EQ(read_png16_gray(dir.path() / "d.png", 37, 19), image);

  Image<Rgb> color(5, 4);
  for (std::size_t i = 0; i < color.size(); ++i)
    color[i] = {static_cast<std::uint8_t>(random.below(256)), static_cast<std::uint8_t>(i), 7};
  EXPECT_EQ(read_color(dir.write("c.png", encode_png_color(color)), 5, 4), color);

  Image<std::uint8_t> levels(7, 3);
  for (std::size_t i = 0; i < levels.size(); ++i) levels[i] = static_cast<std::uint8_t>(random.below(256));
  const Image<Rgb> read = read_color(dir.write("g.png", encode_png8_gray(levels)), 7, 3);
  for (std::size_t i = 0; i < levels.size(); ++i) EXPECT_EQ(read[i], (Rgb{levels[i], levels[i], levels[i]}));
}

TEST(Png, RefusesOtherKindsAsDepth) {
  const TemporaryDirectory dir;
  const auto refusal = [&](int bits, int type, const std::string& row, const std::string& colors = {}) {
    const auto path = dir.write("other.png", handmade_png(1, 1, bits, type, {row}, colors));
    return input_error([&] { read_png16_gray(path, 1, 1); });
  };
  EXPECT_THAT(refusal(8, gray, "a"), AllOf(HasSubstr("other.png: "), HasSubstr("8-bit greyscale"),
                                           HasSubstr("save the depth as 16-bit greyscale")));
  EXPECT_THAT(refusal(16, rgb, "aabbcc"), HasSubstr("16-bit RGB colour"));
  EXPECT_THAT(refusal(8, palette, std::string(1, '\0'), "abc"), HasSubstr("8-bit palette"));
  EXPECT_THAT(refusal(16, gray_alpha, "aabb"), HasSubstr("16-bit greyscale with alpha"));
  EXPECT_THAT(refusal(16, rgb_alpha, "aabbccdd"), HasSubstr("16-bit RGB colour with alpha"));
}

TEST(Png, RefusesTheWrongSizeBeforeItTakesMemory) {
  const TemporaryDirectory dir;
  // Were it to take memory for this size first, it would find none.
  const auto path = dir.write("huge.png", handmade_png(999999, 999999, 16, gray, {"ab"}));
  EXPECT_THAT(input_error([&] { read_png16_gray(path, 640, 480); }),
              AllOf(HasSubstr("huge.png"), HasSubstr("999999 x 999999 pixels, not 640 x 480")));
  EXPECT_THAT(input_error([&] { read_mask(path, 640, 480); }), HasSubstr("not 640 x 480"));
  EXPECT_THAT(input_error([&] { read_color(path, 640, 480); }), HasSubstr("not 640 x 480"));
}

TEST(Png, RefusesEveryTruncationAndSaysNothingElse) {
  const TemporaryDirectory dir;
  const std::string whole = encode_png16_gray(Image<std::uint16_t>(9, 5, 1234));
  testing::internal::CaptureStderr();
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const auto path = dir.write("cut.png", whole.substr(0, n));
    EXPECT_THAT(input_error([&] { read_png16_gray(path, 9, 5); }), HasSubstr("cut.png: ")) << n;
    EXPECT_THAT(input_error([&] { read_mask(path, 9, 5); }), HasSubstr("cut.png: ")) << n;
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Png, RefusesWhatIsNoPng) {
  const TemporaryDirectory dir;
  EXPECT_THAT(input_error([&] { read_png16_gray(dir.write("a.png", "P5 3 2 255 abcdef"), 3, 2); }),
              HasSubstr("is not a PNG file"));
  EXPECT_THAT(input_error([&] { read_png16_gray(dir.write("b.png", ""), 3, 2); }), HasSubstr("is empty"));
  EXPECT_THAT(input_error([&] { read_png16_gray(dir.path() / "none.png", 3, 2); }),
              HasSubstr("no such file"));
  EXPECT_THAT(input_error([&] { read_png16_gray(dir.path(), 3, 2); }), HasSubstr("is a directory"));
}

TEST(Png, ReadsMasksOfAnyKind) {
  const TemporaryDirectory dir;
  const auto mask = [&](int bits, int type, const std::string& row, const std::string& colors = {}) {
    return read_mask(dir.write("m.png", handmade_png(2, 1, bits, type, {row}, colors)), 2, 1).data();
  };
  const std::vector<std::uint8_t> second{0, 1};
  EXPECT_EQ(mask(1, gray, "\x40"), second);
  EXPECT_EQ(mask(8, gray, std::string("\0\x01", 2)), second);
  EXPECT_EQ(mask(16, gray, std::string("\0\0\0\1", 4)), second);  // lost if cut to 8 bits
  EXPECT_EQ(mask(8, rgb, std::string("\0\0\0\0\0\1", 6)), second);
  EXPECT_EQ(mask(16, rgb, std::string("\0\0\0\0\0\0\0\0\0\1\0\0", 12)), second);
  EXPECT_EQ(mask(8, palette, std::string("\x02\x01", 2), std::string("\0\0\1\1\0\0\0\0\0", 9)), second);
  EXPECT_EQ(mask(8, gray_alpha, std::string("\0\xff\x05\0", 4)), second);  // alpha doesn't count
  EXPECT_EQ(mask(8, rgb_alpha, std::string("\0\0\0\xff\0\x09\0\0", 8)), second);
}

TEST(Png, ReadsColorOfAnyKind) {
  const TemporaryDirectory dir;
  const auto pixel = [&](int bits, int type, const std::string& row, const std::string& colors = {}) {
    return read_color(dir.write("c.png", handmade_png(1, 1, bits, type, {row}, colors)), 1, 1)(0, 0);
  };
  EXPECT_EQ(pixel(8, rgb, "\x01\x02\x03"), (Rgb{1, 2, 3}));
  EXPECT_EQ(pixel(8, gray, "\x07"), (Rgb{7, 7, 7}));
  EXPECT_EQ(pixel(1, gray, "\x80"), (Rgb{255, 255, 255}));
  EXPECT_EQ(pixel(16, rgb, std::string("\xff\xff\0\0\x80\x80", 6)), (Rgb{255, 0, 128}));
  EXPECT_EQ(pixel(8, palette, "\x01", "abcdef"), (Rgb{'d', 'e', 'f'}));
  EXPECT_EQ(pixel(8, rgb_alpha, std::string("\x01\x02\x03\0", 4)), (Rgb{1, 2, 3}));
}

TEST(Png, DepthIsTheProductInDoubleRoundedOnce) {
  Image<std::uint16_t> counts(3, 1);
  counts[1] = 12345;
  counts[2] = 65535;
  const DepthImage depth = depth_from_counts(counts, 0.0001);
  EXPECT_EQ(depth[0], 0.0F);
  EXPECT_EQ(depth[1], static_cast<float>(12345 * 0.0001));
  EXPECT_EQ(counts_from_depth(depth, 0.0001), counts);
  EXPECT_EQ(counts_from_depth(DepthImage(1, 1, 1e-9F), 0.001)[0], 1) << "a reading stays a reading";
  EXPECT_EQ(counts_from_depth(DepthImage(1, 1, 1e9F), 0.001)[0], 65535);
}

}  // namespace
}  // namespace perch
