#include "perch/io/pcd_file.hpp"

#include <fmt/format.h>
#include <lzf.h>

#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <string>

#include "perch/io/text_values.hpp"

namespace perch {
namespace {

constexpr std::uint64_t most_points = std::uint64_t{1} << 28;  // as many as the largest image has pixels
constexpr std::uint64_t widest_point = 1 << 16;                // bytes

struct PcdField {
  std::string name;
  std::uint64_t size = 4;  ///< bytes
  char type = 'F';
  std::uint64_t count = 1;

  std::uint64_t bytes() const { return size * count; }
};

enum class PcdEncoding { ascii, binary, compressed };

struct PcdHeader {
  std::vector<PcdField> fields;
  std::optional<std::uint64_t> width, height, points;
  Eigen::Isometry3d viewpoint = Eigen::Isometry3d::Identity();
  PcdEncoding encoding = PcdEncoding::ascii;
};

std::uint64_t whole_number(std::string_view word, std::string_view key, std::uint64_t most) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || value > most)
    throw FormatFault{fmt::format("has a header whose {} is \"{}\"; it must be a whole number up to {}", key,
                                  one_line(word), most)};
  return value;
}

std::vector<std::string_view> pcd_words(std::string_view line) {
  std::vector<std::string_view> words;
  while (const auto word = next_word(line)) words.push_back(*word);
  return words;
}

Eigen::Isometry3d viewpoint_of(std::string_view line) {
  std::array<double, 7> v{};  // x y z, then the quaternion w x y z
  for (double& value : v) value = next_number(line);
  const Eigen::Vector3d origin(v[0], v[1], v[2]);
  const Eigen::Quaterniond turn(v[3], v[4], v[5], v[6]);
  if (next_word(line) || !origin.allFinite() || !(std::abs(turn.norm() - 1.0) < 1e-3))
    throw FormatFault{"has a header whose VIEWPOINT is no pose (x y z, then a unit quaternion w x y z)"};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (turn.vec().isZero(0.0)) return Eigen::Isometry3d(Eigen::Translation3d(origin));
  pose.linear() = turn.normalized().toRotationMatrix();
  pose.translation() = origin;
  return pose;
}

PcdEncoding encoding_of(std::string_view word) {
  if (word == "ascii") return PcdEncoding::ascii;
  if (word == "binary") return PcdEncoding::binary;
  if (word == "binary_compressed") return PcdEncoding::compressed;
  throw FormatFault{fmt::format(
      "has a header whose DATA is \"{}\"; it must be ascii, binary or binary_compressed", one_line(word))};
}

/// One value a field, from a line of SIZE, TYPE or COUNT.
template <typename Set>
void set_fields(PcdHeader& header, const std::vector<std::string_view>& values, std::string_view key,
                const Set& set) {
  if (values.size() != header.fields.size())
    throw FormatFault{fmt::format("has a header with {} values of {} for {} FIELDS", values.size(), key,
                                  header.fields.size())};
  for (std::size_t i = 0; i < values.size(); ++i) set(header.fields[i], values[i]);
}

void check_pcd(const PcdHeader& header) {
  std::uint64_t bytes = 0;
  for (const PcdField& field : header.fields) {
    if (field.bytes() == 0) throw FormatFault{"has a header with a field of no size"};
    if ((bytes += field.bytes()) > widest_point) throw FormatFault{"has a header whose points are too large"};
  }
  for (const std::string axis : {"x", "y", "z"}) {
    const auto has_name = [&](const PcdField& f) { return f.name == axis; };
    const auto field = std::find_if(header.fields.begin(), header.fields.end(), has_name);
    if (field == header.fields.end()) throw FormatFault{fmt::format("has points without {}", axis)};
    if (field->type != 'F' || (field->size != 4 && field->size != 8) || field->count != 1)
      throw FormatFault{fmt::format("has points whose {} is no single float of 4 or 8 bytes", axis)};
  }
}

PcdHeader parse_pcd_header(Lines& lines) {
  PcdHeader header;
  for (;;) {
    const auto whole = lines.next();
    if (!whole) throw FormatFault{"is truncated: its header has no DATA"};
    std::string_view line = *whole;
    const auto key = next_word(line);
    if (!key || key->starts_with('#')) continue;
    const auto number = [&] { return whole_number(next_word(line).value_or(""), *key, most_points); };
    if (*key == "VERSION") continue;
    if (*key == "FIELDS" || *key == "COLUMNS") {
      header.fields.clear();
      for (const std::string_view name : pcd_words(line))
        header.fields.push_back({.name = std::string(name)});
    } else if (*key == "SIZE") {
      set_fields(header, pcd_words(line), *key,
                 [](PcdField& f, std::string_view word) { f.size = whole_number(word, "SIZE", 8); });
    } else if (*key == "TYPE") {
      set_fields(header, pcd_words(line), *key, [](PcdField& f, std::string_view word) { f.type = word[0]; });
    } else if (*key == "COUNT") {
      set_fields(header, pcd_words(line), *key, [](PcdField& f, std::string_view word) {
        f.count = whole_number(word, "COUNT", widest_point);
      });
    } else if (*key == "WIDTH") {
      header.width = number();
    } else if (*key == "HEIGHT") {
      header.height = number();
    } else if (*key == "POINTS") {
      header.points = number();
    } else if (*key == "VIEWPOINT") {
      header.viewpoint = viewpoint_of(line);
    } else if (*key == "DATA") {
      header.encoding = encoding_of(next_word(line).value_or(""));
      check_pcd(header);
      return header;
    } else {
      throw FormatFault{fmt::format("has a header with \"{}\"", one_line(*whole))};
    }
  }
}

/// How many points there are, as WIDTH, HEIGHT and POINTS agree.
std::uint64_t count_points(const PcdHeader& header) {
  if (!header.width && !header.points) throw FormatFault{"has a header without WIDTH and POINTS"};
  if (!header.width) return *header.points;
  const std::uint64_t count = *header.width * header.height.value_or(1);
  if (header.points && *header.points != count)
    throw FormatFault{fmt::format("has a header with {} POINTS but WIDTH {} times HEIGHT {}", *header.points,
                                  *header.width, header.height.value_or(1))};
  if (count > most_points) throw FormatFault{fmt::format("promises {} points, too many", count)};
  return count;
}

double float_at(const char* at, std::uint64_t size) {
  std::array<char, 8> raw{};
  std::memcpy(raw.data(), at, size);
  if (std::endian::native == std::endian::big) std::reverse(raw.data(), raw.data() + size);
  if (size == 8) return std::bit_cast<double>(raw);
  float value = 0.0F;
  std::memcpy(&value, raw.data(), 4);
  return static_cast<double>(value);
}

/// Which coordinate a field is: 0 to 2, or nothing.
std::optional<int> axis_of(const PcdField& field) {
  return field.name == "x"   ? std::optional(0)
         : field.name == "y" ? std::optional(1)
         : field.name == "z" ? std::optional(2)
                             : std::nullopt;
}

std::vector<Eigen::Vector3d> read_pcd_ascii(const PcdHeader& header, std::uint64_t count, Lines lines) {
  // Each point takes two bytes a value at least, the last line's end aside.
  if (count > 0 && (2 * count - 1) > lines.rest().size())
    throw FormatFault{"is truncated: its header promises more points than the file holds"};
  std::vector<Eigen::Vector3d> points;
  points.reserve(count);
  while (points.size() < count) {
    const auto next = lines.next();
    if (!next) throw FormatFault{"is truncated: its header promises more points than the file holds"};
    std::string_view line = *next;
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    Eigen::Vector3d& point = points.emplace_back();
    for (const PcdField& field : header.fields) {
      const auto axis = axis_of(field);
      if (axis) {
        point[*axis] = next_number(line);
        continue;
      }
      for (std::uint64_t i = 0; i < field.count; ++i)
        if (!next_word(line)) throw FormatFault{"has a line with too few values"};
    }
    if (next_word(line)) throw FormatFault{"has a line with too many values"};
  }
  return points;
}

/// Takes x, y and z from where each field of point 0 begins and how far the next point's lies from it.
struct PcdLayout {
  std::array<std::uint64_t, 3> first{}, stride{}, size{};
};

std::vector<Eigen::Vector3d> gather(std::string_view body, std::uint64_t count, const PcdLayout& layout) {
  std::vector<Eigen::Vector3d> points(count);
  for (std::uint64_t i = 0; i < count; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      points[i][static_cast<int>(axis)] =
          float_at(body.data() + layout.first[axis] + i * layout.stride[axis], layout.size[axis]);
  return points;
}

std::vector<Eigen::Vector3d> read_pcd_binary(const PcdHeader& header, std::uint64_t count,
                                             std::string_view body) {
  PcdLayout layout;
  std::uint64_t point = 0;
  for (const PcdField& field : header.fields) {
    if (const auto axis = axis_of(field)) {
      const auto a = static_cast<std::size_t>(*axis);
      layout.first[a] = point;
      layout.size[a] = field.size;
    }
    point += field.bytes();
  }
  layout.stride.fill(point);
  if (count * point > body.size())
    throw FormatFault{"is truncated: its header promises more points than the file holds"};
  return gather(body, count, layout);
}

/// All values of one field, then all of the next. What PCL pads a point with ("_") is left out of such files.
std::vector<Eigen::Vector3d> read_pcd_compressed(const PcdHeader& header, std::uint64_t count,
                                                 std::string_view body) {
  if (count == 0) return {};
  PcdLayout layout;
  std::uint64_t all = 0;
  for (const PcdField& field : header.fields) {
    if (field.name == "_") continue;
    if (const auto axis = axis_of(field)) {
      const auto a = static_cast<std::size_t>(*axis);
      layout.first[a] = all;
      layout.size[a] = layout.stride[a] = field.size;
    }
    all += count * field.bytes();
  }
  const auto size_at = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(body[at + i]);
    return value;
  };
  if (body.size() < 8) throw FormatFault{"is truncated: its compressed data has no sizes"};
  const std::uint32_t packed = size_at(0), unpacked = size_at(4);
  body.remove_prefix(8);
  if (packed > body.size())
    throw FormatFault{"is truncated: its header promises more compressed data than the file holds"};
  // LZF makes 264 bytes of 3 at most.
  if (unpacked != all || unpacked > std::uint64_t{88} * packed)
    throw FormatFault{fmt::format("promises {} bytes of points but {} of compressed data that hold {}", all,
                                  packed, unpacked)};
  std::string data(unpacked, '\0');
  if (lzf_decompress(body.data(), packed, data.data(), unpacked) != unpacked)
    throw FormatFault{"has compressed data that is damaged"};
  return gather(data, count, layout);
}

}  // namespace

PointCloud read_pcd(std::string_view bytes) {
  Lines lines(bytes);
  const PcdHeader header = parse_pcd_header(lines);
  const std::uint64_t count = count_points(header);
  PointCloud cloud;
  cloud.file_from_sensor = header.viewpoint;
  switch (header.encoding) {
    case PcdEncoding::ascii:
      cloud.points = read_pcd_ascii(header, count, lines);
      break;
    case PcdEncoding::binary:
      cloud.points = read_pcd_binary(header, count, lines.rest());
      break;
    case PcdEncoding::compressed:
      cloud.points = read_pcd_compressed(header, count, lines.rest());
      break;
  }
  if (header.width && header.height.value_or(1) > 1) cloud.grid = {{*header.width, *header.height}};
  return cloud;
}

}  // namespace perch
