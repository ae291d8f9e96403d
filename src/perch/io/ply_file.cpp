#include "perch/io/ply_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "perch/io/mesh_text.hpp"

namespace perch {
namespace {

enum class Scalar { i8, u8, i16, u16, i32, u32, f32, f64 };

std::optional<Scalar> scalar_type(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, Scalar>, 16> names{{{"char", Scalar::i8},
                                                                              {"int8", Scalar::i8},
                                                                              {"uchar", Scalar::u8},
                                                                              {"uint8", Scalar::u8},
                                                                              {"short", Scalar::i16},
                                                                              {"int16", Scalar::i16},
                                                                              {"ushort", Scalar::u16},
                                                                              {"uint16", Scalar::u16},
                                                                              {"int", Scalar::i32},
                                                                              {"int32", Scalar::i32},
                                                                              {"uint", Scalar::u32},
                                                                              {"uint32", Scalar::u32},
                                                                              {"float", Scalar::f32},
                                                                              {"float32", Scalar::f32},
                                                                              {"double", Scalar::f64},
                                                                              {"float64", Scalar::f64}}};
  for (const auto& [known, type] : names)
    if (known == name) return type;
  return std::nullopt;
}

std::size_t bytes_of(Scalar type) {
  static constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

struct Property {
  std::string name;
  Scalar type = Scalar::f32;
  std::optional<Scalar> count_type;  ///< of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding { ascii, little, big };

struct PlyHeader {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
};

Property parse_property(std::string_view line) {
  Property property;
  auto word = next_word(line);
  const auto type = [&] {
    const auto t = word ? scalar_type(*word) : std::nullopt;
    if (!t)
      throw MeshFault{fmt::format("has a header with an unknown type \"{}\"", one_line(word.value_or("")))};
    return *t;
  };
  if (word == "list") {
    word = next_word(line);
    property.count_type = type();
    word = next_word(line);
  }
  property.type = type();
  const auto name = next_word(line);
  if (!name) throw MeshFault{"has a header with a property without a name"};
  property.name = *name;
  return property;
}

PlyHeader parse_header(Lines& lines) {
  PlyHeader header;
  if (lines.next() != "ply") throw MeshFault{"does not begin with \"ply\""};
  bool has_format = false;
  for (;;) {
    const auto whole = lines.next();
    if (!whole) throw MeshFault{"is truncated: its header has no end"};
    std::string_view line = *whole;
    const auto word = next_word(line);
    if (!word || word == "comment" || word == "obj_info") continue;
    if (word == "end_header") break;
    if (word == "format") {
      const std::string_view encoding = next_word(line).value_or("");
      has_format =
          encoding == "ascii" || encoding == "binary_little_endian" || encoding == "binary_big_endian";
      header.encoding = encoding == "ascii"                  ? Encoding::ascii
                        : encoding == "binary_little_endian" ? Encoding::little
                                                             : Encoding::big;
    } else if (word == "element") {
      Element element;
      element.name = next_word(line).value_or("");
      const std::string_view count = next_word(line).value_or("");
      const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
      if (error != std::errc{} || end != count.data() + count.size())
        throw MeshFault{fmt::format("has a header with \"{}\"", one_line(*whole))};
      header.elements.push_back(std::move(element));
    } else if (word == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(parse_property(line));
    } else {
      throw MeshFault{fmt::format("has a header with \"{}\"", one_line(*whole))};
    }
  }
  if (!has_format) throw MeshFault{"has a header without a known format"};
  for (const Element& element : header.elements)
    for (const char* axis : {"x", "y", "z"})
      if (element.name == "vertex" && std::none_of(element.properties.begin(), element.properties.end(),
                                                   [&](const Property& p) { return p.name == axis; }))
        throw MeshFault{fmt::format("has vertices without {}", axis)};
  return header;
}

/// One value after another out of a binary body.
class BinaryBody {
 public:
  BinaryBody(std::string_view bytes, bool big_endian)
      : rest_(bytes), swap_(big_endian != (std::endian::native == std::endian::big)) {}

  void begin_instance() {}
  double take(Scalar type) {
    std::array<char, 8> raw{};
    const std::size_t n = bytes_of(type);
    if (rest_.size() < n) throw MeshFault{"is truncated: its header promises more than the file holds"};
    std::copy_n(rest_.data(), n, raw.data());
    rest_.remove_prefix(n);
    if (swap_) std::reverse(raw.data(), raw.data() + n);
    switch (type) {
      case Scalar::i8:
        return as<std::int8_t>(raw);
      case Scalar::u8:
        return as<std::uint8_t>(raw);
      case Scalar::i16:
        return as<std::int16_t>(raw);
      case Scalar::u16:
        return as<std::uint16_t>(raw);
      case Scalar::i32:
        return as<std::int32_t>(raw);
      case Scalar::u32:
        return as<std::uint32_t>(raw);
      case Scalar::f32:
        return static_cast<double>(as<float>(raw));
      case Scalar::f64:
        break;
    }
    return as<double>(raw);
  }
  void end_instance() {}

 private:
  template <typename T>
  static T as(const std::array<char, 8>& raw) {
    T value;
    std::memcpy(&value, raw.data(), sizeof(T));
    return value;
  }
  std::string_view rest_;
  bool swap_;
};

/// One value after another out of an ASCII body, one instance a line.
class AsciiBody {
 public:
  explicit AsciiBody(Lines lines) : lines_(lines) {}

  void begin_instance() {
    do {
      const auto line = lines_.next();
      if (!line) throw MeshFault{"is truncated: its header promises more lines than the file holds"};
      line_ = *line;
    } while (line_.find_first_not_of(" \t\r") == std::string_view::npos);
  }
  double take(Scalar) { return next_number(line_); }
  void end_instance() {
    if (next_word(line_)) throw MeshFault{"has a line with too many values"};
  }

 private:
  Lines lines_;
  std::string_view line_;
};

/// Reads the elements of a body one after another.
template <typename Body>
class BodyReader {
 public:
  BodyReader(const PlyHeader& header, Body body) : header_(header), body_(std::move(body)) {
    for (const Element& element : header_.elements)
      if (element.name == "vertex") vertices_ += element.count;
  }

  PolygonMesh read() {
    for (const Element& element : header_.elements) {
      if (element.properties.empty() && element.count > 0)
        throw MeshFault{
            fmt::format("has a header whose element \"{}\" has no properties", one_line(element.name))};
      for (std::uint64_t i = 0; i < element.count; ++i) {
        body_.begin_instance();
        read_instance(element, i);
        body_.end_instance();
      }
    }
    return std::move(mesh_);
  }

 private:
  void read_instance(const Element& element, std::uint64_t number) {
    const bool vertex = element.name == "vertex", face = element.name == "face";
    Eigen::Vector3d point = Eigen::Vector3d::Constant(std::nan(""));
    for (const Property& property : element.properties) {
      if (property.count_type) {
        const bool corners = face && (property.name == "vertex_indices" || property.name == "vertex_index");
        read_list(element, property, number, corners);
        continue;
      }
      const double value = body_.take(property.type);
      if (property.name == "x") point.x() = value;
      if (property.name == "y") point.y() = value;
      if (property.name == "z") point.z() = value;
    }
    if (!vertex) return;
    if (!point.cast<float>().allFinite())
      throw MeshFault{fmt::format("has a vertex that is not finite (number {})", number)};
    mesh_.vertices.push_back(point);
  }

  void read_list(const Element& element, const Property& property, std::uint64_t number, bool corners) {
    const double n = body_.take(*property.count_type);
    if (!(n >= 0.0) || n != std::floor(n))
      throw MeshFault{fmt::format("has a list of {} values (in {} {})", n, one_line(element.name), number)};
    for (double k = 0; k < n; ++k) {
      const double value = body_.take(property.type);
      if (!corners) continue;
      if (!(value >= 0.0 && value < static_cast<double>(vertices_) && value == std::floor(value)))
        throw MeshFault{
            fmt::format("has a face (number {}) that names vertex {} of {}", number, value, vertices_)};
      mesh_.corners.push_back(static_cast<std::uint32_t>(value));
    }
    if (corners) mesh_.ends.push_back(mesh_.corners.size());
  }

  const PlyHeader& header_;
  Body body_;
  std::uint64_t vertices_ = 0;
  PolygonMesh mesh_;
};

}  // namespace

PolygonMesh read_ply(std::string_view bytes) {
  Lines lines(bytes);
  const PlyHeader header = parse_header(lines);
  if (header.encoding == Encoding::ascii) return BodyReader(header, AsciiBody(lines)).read();
  return BodyReader(header, BinaryBody(lines.rest(), header.encoding == Encoding::big)).read();
}

}  // namespace perch
