#include "perch/io/ply_elements.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "perch/io/text_values.hpp"

namespace perch {
namespace {

using Scalar = PlyScalar;

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

PlyProperty parse_property(std::string_view line) {
  PlyProperty property;
  auto word = next_word(line);
  const auto type = [&] {
    const auto t = word ? scalar_type(*word) : std::nullopt;
    if (!t)
      throw FormatFault{fmt::format("has a header with an unknown type \"{}\"", one_line(word.value_or("")))};
    return *t;
  };
  if (word == "list") {
    word = next_word(line);
    property.count_type = type();
    word = next_word(line);
  }
  property.type = type();
  const auto name = next_word(line);
  if (!name) throw FormatFault{"has a header with a property without a name"};
  property.name = *name;
  return property;
}

PlyHeader parse_header(Lines& lines) {
  PlyHeader header;
  if (lines.next() != "ply") throw FormatFault{"does not begin with \"ply\""};
  bool has_format = false;
  for (;;) {
    const auto whole = lines.next();
    if (!whole) throw FormatFault{"is truncated: its header has no end"};
    std::string_view line = *whole;
    const auto word = next_word(line);
    if (!word || word == "comment") continue;
    if (word == "end_header") break;
    if (word == "obj_info") {
      header.notes.emplace_back(line);
      continue;
    }
    if (word == "format") {
      const std::string_view encoding = next_word(line).value_or("");
      has_format =
          encoding == "ascii" || encoding == "binary_little_endian" || encoding == "binary_big_endian";
      header.encoding = encoding == "ascii"                  ? PlyEncoding::ascii
                        : encoding == "binary_little_endian" ? PlyEncoding::little
                                                             : PlyEncoding::big;
    } else if (word == "element") {
      PlyElement element;
      element.name = next_word(line).value_or("");
      const std::string_view count = next_word(line).value_or("");
      const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
      if (error != std::errc{} || end != count.data() + count.size())
        throw FormatFault{fmt::format("has a header with \"{}\"", one_line(*whole))};
      header.elements.push_back(std::move(element));
    } else if (word == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(parse_property(line));
    } else {
      throw FormatFault{fmt::format("has a header with \"{}\"", one_line(*whole))};
    }
  }
  if (!has_format) throw FormatFault{"has a header without a known format"};
  for (const PlyElement& element : header.elements)
    for (const char* axis : {"x", "y", "z"})
      if (element.name == "vertex" && std::none_of(element.properties.begin(), element.properties.end(),
                                                   [&](const PlyProperty& p) { return p.name == axis; }))
        throw FormatFault{fmt::format("has vertices without {}", axis)};
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
    if (rest_.size() < n) throw FormatFault{"is truncated: its header promises more than the file holds"};
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
      if (!line) throw FormatFault{"is truncated: its header promises more lines than the file holds"};
      line_ = *line;
    } while (line_.find_first_not_of(" \t\r") == std::string_view::npos);
  }
  double take(Scalar) { return next_number(line_); }
  void end_instance() {
    if (next_word(line_)) throw FormatFault{"has a line with too many values"};
  }

 private:
  Lines lines_;
  std::string_view line_;
};

/// Reads the elements of a body one after another.
template <typename Body>
void read_body(const PlyHeader& header, Body body, PlyVisitor& visitor) {
  std::vector<double> values, list;
  const auto read_list = [&](const PlyElement& element, const PlyProperty& property, std::uint64_t number) {
    const double n = body.take(*property.count_type);
    if (!(n >= 0.0) || n != std::floor(n))
      throw FormatFault{fmt::format("has a list of {} values (in {} {})", n, one_line(element.name), number)};
    list.clear();
    for (double k = 0; k < n; ++k) list.push_back(body.take(property.type));
    visitor.list(element, property, number, list);
    return n;
  };
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty() && element.count > 0)
      throw FormatFault{
          fmt::format("has a header whose element \"{}\" has no properties", one_line(element.name))};
    for (std::uint64_t i = 0; i < element.count; ++i) {
      body.begin_instance();
      values.clear();
      for (const PlyProperty& property : element.properties)
        values.push_back(property.count_type ? read_list(element, property, i) : body.take(property.type));
      body.end_instance();
      visitor.instance(element, i, values);
    }
  }
}

}  // namespace

std::uint64_t PlyHeader::count(std::string_view element) const {
  std::uint64_t sum = 0;
  for (const PlyElement& e : elements)
    if (e.name == element) sum += e.count;
  return sum;
}

Eigen::Vector3d ply_point(const PlyElement& vertex, std::span<const double> values) {
  Eigen::Vector3d point = Eigen::Vector3d::Constant(std::nan(""));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string& name = vertex.properties[i].name;
    if (vertex.properties[i].count_type) continue;
    if (name.size() == 1 && name[0] >= 'x' && name[0] <= 'z') point[name[0] - 'x'] = values[i];
  }
  return point;
}

void read_ply_elements(std::string_view bytes, PlyVisitor& visitor) {
  Lines lines(bytes);
  const PlyHeader header = parse_header(lines);
  visitor.header(header);
  if (header.encoding == PlyEncoding::ascii) return read_body(header, AsciiBody(lines), visitor);
  read_body(header, BinaryBody(lines.rest(), header.encoding == PlyEncoding::big), visitor);
}

}  // namespace perch
