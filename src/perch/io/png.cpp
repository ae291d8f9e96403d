#include "perch/io/png.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <string_view>
#include <vector>

#include "perch/core/error.hpp"
#include "perch/io/atomic_write.hpp"
#include "perch/io/message.hpp"
#include "perch/io/read_file.hpp"

namespace perch {
namespace {

/// What libpng had to say; plain data, since it is written just before a longjmp.
struct Complaint {
  std::array<char, 200> text{};
};

extern "C" void on_png_error(png_structp png, png_const_charp message) {
  auto* complaint = static_cast<Complaint*>(png_get_error_ptr(png));
  std::snprintf(complaint->text.data(), complaint->text.size(), "%s", message);
  png_longjmp(png, 1);
}
extern "C" void on_png_warning(png_structp, png_const_charp) {}

/// Runs calls into libpng; false where one of them failed. libpng leaves them by longjmp, so `calls` must own
/// nothing that has a destructor.
template <typename Calls>
bool guarded(png_structp png, const Calls& calls) {
  if (setjmp(png_jmpbuf(png))) return false;
  calls();
  return true;
}

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// A PNG file whose header has been read.
class PngReader {
 public:
  explicit PngReader(const std::filesystem::path& path) : path_(path) {
    check_file(path, std::uintmax_t{4} << 30);
    file_.reset(std::fopen(path.c_str(), "rb"));
    if (!file_) fail("can't be opened; check its permissions");
    std::array<png_byte, 8> signature{};
    const std::size_t n = std::fread(signature.data(), 1, signature.size(), file_.get());
    if (n < signature.size() || png_sig_cmp(signature.data(), 0, signature.size()) != 0)
      fail("is not a PNG file; convert it to PNG");
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &complaint_, on_png_error, on_png_warning);
    info_ = png_ ? png_create_info_struct(png_) : nullptr;
    if (!info_) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw std::bad_alloc();
    }
    try {
      call([this] {
        png_init_io(png_, file_.get());
        png_set_sig_bytes(png_, 8);
        png_read_info(png_, info_);
      });
    } catch (...) {
      png_destroy_read_struct(&png_, &info_, nullptr);
      throw;
    }
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  png_structp png() const { return png_; }
  int bit_depth() const { return png_get_bit_depth(png_, info_); }
  int color_type() const { return png_get_color_type(png_, info_); }

  PngSize size() const {
    return {static_cast<int>(png_get_image_width(png_, info_)),
            static_cast<int>(png_get_image_height(png_, info_))};
  }
  void require_size(int width, int height) const {
    const png_uint_32 w = png_get_image_width(png_, info_), h = png_get_image_height(png_, info_);
    if (w != static_cast<png_uint_32>(width) || h != static_cast<png_uint_32>(height))
      fail(fmt::format("is {} x {} pixels, not {} x {}; give an image of the size that the intrinsics state",
                       w, h, width, height));
  }

  std::string kind() const {
    const auto color = [this]() -> std::string_view {
      switch (color_type()) {
        case PNG_COLOR_TYPE_GRAY:
          return "greyscale";
        case PNG_COLOR_TYPE_PALETTE:
          return "palette";
        case PNG_COLOR_TYPE_RGB:
          return "RGB colour";
        case PNG_COLOR_TYPE_RGB_ALPHA:
          return "RGB colour with alpha";
        default:
          return "greyscale with alpha";
      }
    };
    return fmt::format("{}-bit {}", bit_depth(), color());
  }

  template <typename Calls>
  void call(const Calls& calls) const {
    if (!guarded(png_, calls))
      fail(fmt::format("is a truncated or damaged PNG ({}); write it again",
                       one_line(complaint_.text.data())));
  }

  /// All rows after the transforms set so far, `height` rows of row_bytes() each, one after another.
  std::vector<png_byte> rows(std::size_t bytes_per_row_expected) {
    call([this] {
      png_set_interlace_handling(png_);
      png_read_update_info(png_, info_);
    });
    const std::size_t row_bytes = png_get_rowbytes(png_, info_);
    const png_uint_32 height = png_get_image_height(png_, info_);
    if (bytes_per_row_expected != 0 && row_bytes != bytes_per_row_expected)
      fail("is a PNG whose rows have an unexpected length; write it again");
    std::vector<png_byte> bytes(row_bytes * height);
    std::vector<png_bytep> row(height);
    for (png_uint_32 v = 0; v < height; ++v) row[v] = bytes.data() + v * row_bytes;
    call([this, &row] {
      png_read_image(png_, row.data());
      png_read_end(png_, nullptr);  // a file cut after its last pixel is cut all the same
    });
    return bytes;
  }
  int channels() const { return png_get_channels(png_, info_); }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", shown(path_), what));
  }

 private:
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  mutable Complaint complaint_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

extern "C" void append_png_bytes(png_structp png, png_bytep data, png_size_t n) {
  auto* out = static_cast<std::string*>(png_get_io_ptr(png));
  bool failed = false;
  try {
    out->append(reinterpret_cast<const char*>(data), n);
  } catch (...) {
    failed = true;  // an exception may not pass through libpng, which is C
  }
  if (failed) png_error(png, "out of memory");
}
extern "C" void flush_png_bytes(png_structp) {}

std::string encode(int width, int height, int bit_depth, int color_type, const png_byte* pixels,
                   std::size_t row_bytes) {
  if (width < 1 || height < 1) throw std::invalid_argument("a PNG holds at least one pixel");
  Complaint complaint;
  std::string out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &complaint, on_png_error, on_png_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  const bool written =
      info && guarded(png, [&] {
        png_set_write_fn(png, &out, append_png_bytes, flush_png_bytes);
        png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bit_depth,
                     color_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
        png_write_info(png, info);
        if (bit_depth == 16 && std::endian::native == std::endian::little) png_set_swap(png);
        for (int v = 0; v < height; ++v) png_write_row(png, pixels + static_cast<std::size_t>(v) * row_bytes);
        png_write_end(png, info);
      });
  png_destroy_write_struct(&png, &info);
  if (!written) throw std::bad_alloc();  // nothing else can go wrong in memory
  return out;
}

}  // namespace

PngSize png_size(const std::filesystem::path& path) {
  return PngReader(path).size();
}

Image<std::uint16_t> read_png16_gray(const std::filesystem::path& path, int width, int height) {
  PngReader reader(path);
  if (reader.bit_depth() != 16 || reader.color_type() != PNG_COLOR_TYPE_GRAY)
    reader.fail(fmt::format("is a {} PNG; save the depth as 16-bit greyscale", reader.kind()));
  reader.require_size(width, height);
  const std::size_t row_bytes = static_cast<std::size_t>(width) * 2;
  const std::vector<png_byte> bytes = reader.rows(row_bytes);
  Image<std::uint16_t> image(width, height);
  for (std::size_t i = 0; i < image.size(); ++i)
    image[i] = static_cast<std::uint16_t>(bytes[2 * i] << 8 | bytes[2 * i + 1]);  // PNG is big-endian
  return image;
}

Image<std::uint8_t> read_mask(const std::filesystem::path& path, int width, int height) {
  PngReader reader(path);
  reader.require_size(width, height);
  // 16-bit values stay 16-bit: cut to their high byte, small ones would turn to zero.
  reader.call([&] {
    png_set_palette_to_rgb(reader.png());
    png_set_expand_gray_1_2_4_to_8(reader.png());
  });
  const std::vector<png_byte> bytes = reader.rows(0);
  const auto channels = static_cast<std::size_t>(reader.channels());
  const std::size_t color_channels = channels >= 3 ? 3 : 1;
  const std::size_t bytes_per_channel = reader.bit_depth() == 16 ? 2 : 1;
  Image<std::uint8_t> mask(width, height);
  if (bytes.size() != mask.size() * channels * bytes_per_channel)
    reader.fail("is a PNG whose rows have an unexpected length; write it again");
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const png_byte* pixel = bytes.data() + i * channels * bytes_per_channel;
    mask[i] =
        std::any_of(pixel, pixel + color_channels * bytes_per_channel, [](png_byte b) { return b != 0; });
  }
  return mask;
}

Image<Rgb> read_color(const std::filesystem::path& path, int width, int height) {
  PngReader reader(path);
  reader.require_size(width, height);
  reader.call([&] {
    png_set_scale_16(reader.png());
    png_set_palette_to_rgb(reader.png());
    png_set_expand_gray_1_2_4_to_8(reader.png());
    png_set_gray_to_rgb(reader.png());
    png_set_strip_alpha(reader.png());
  });
  const std::vector<png_byte> bytes = reader.rows(static_cast<std::size_t>(width) * 3);
  Image<Rgb> image(width, height);
  for (std::size_t i = 0; i < image.size(); ++i)
    image[i] = {bytes[3 * i], bytes[3 * i + 1], bytes[3 * i + 2]};
  return image;
}

std::string encode_png16_gray(const Image<std::uint16_t>& image) {
  return encode(image.width(), image.height(), 16, PNG_COLOR_TYPE_GRAY,
                reinterpret_cast<const png_byte*>(image.data().data()),
                static_cast<std::size_t>(image.width()) * 2);
}

std::string encode_png8_gray(const Image<std::uint8_t>& image) {
  return encode(image.width(), image.height(), 8, PNG_COLOR_TYPE_GRAY, image.data().data(),
                static_cast<std::size_t>(image.width()));
}

std::string encode_png_color(const Image<Rgb>& image) {
  static_assert(sizeof(Rgb) == 3);
  return encode(image.width(), image.height(), 8, PNG_COLOR_TYPE_RGB,
                reinterpret_cast<const png_byte*>(image.data().data()),
                static_cast<std::size_t>(image.width()) * 3);
}

void write_png16_gray(const std::filesystem::path& path, const Image<std::uint16_t>& image) {
  write_atomically(path, encode_png16_gray(image));
}

DepthImage depth_from_counts(const Image<std::uint16_t>& counts, double depth_scale) {
  DepthImage depth(counts.width(), counts.height());
  for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = static_cast<float>(counts[i] * depth_scale);
  return depth;
}

Image<std::uint16_t> counts_from_depth(const DepthImage& depth, double depth_scale) {
  Image<std::uint16_t> counts(depth.width(), depth.height());
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (depth[i] > 0.0F)
      counts[i] =
          static_cast<std::uint16_t>(std::clamp(std::round(double{depth[i]} / depth_scale), 1.0, 65535.0));
  return counts;
}

}  // namespace perch
