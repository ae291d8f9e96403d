#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "perch/core/error.hpp"

// What the tests of this layer share; all inputs are made by the tests themselves.
namespace perch::testing_files {

/// A directory of its own, removed with all that is in it.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "perch-io-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary directory");
    path_ = name;
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The message of the InputError that `call` must throw; it must be one line.
template <typename Call>
std::string input_error(const Call& call) {
  try {
    call();
  } catch (const InputError& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    return e.what();
  } catch (const std::exception& e) {
    ADD_FAILURE() << "not an InputError: " << e.what();
    return {};
  }
  ADD_FAILURE() << "nothing thrown";
  return {};
}

inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("not in the text: " + std::string(from));
  return text.replace(at, from.size(), to);
}

/// The bytes of a value, least significant first.
template <typename T>
std::string little(T value) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));
  if (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  return {raw.begin(), raw.end()};
}
template <typename T>
std::string big(T value) {
  const std::string raw = little(value);
  return {raw.rbegin(), raw.rend()};
}

/// A PNG made by hand, after the specification: one uncompressed block, so that no library of ours is in it.
/// \param rows the bytes of all rows, each without its filter byte.
/// \param palette RGB triples, or empty.
inline std::string handmade_png(std::uint32_t width, std::uint32_t height, int bit_depth, int color_type,
                                const std::vector<std::string>& rows, const std::string& palette = {}) {
  const auto crc = [](const std::string& data) {
    std::uint32_t c = 0xffffffffU;
    for (const char byte : data) {
      c ^= static_cast<unsigned char>(byte);
      for (int k = 0; k < 8; ++k) c = (c & 1U) ? 0xedb88320U ^ (c >> 1) : c >> 1;
    }
    return ~c;
  };
  const auto chunk = [&](const std::string& type, const std::string& data) {
    return big(static_cast<std::uint32_t>(data.size())) + type + data + big(crc(type + data));
  };
  std::string raw;
  for (const std::string& row : rows) raw += std::string(1, '\0') + row;
  std::uint32_t a = 1, b = 0;
  for (const char byte : raw) {
    a = (a + static_cast<unsigned char>(byte)) % 65521;
    b = (b + a) % 65521;
  }
  const auto length = static_cast<std::uint16_t>(raw.size());
  const std::string stored = std::string("\x78\x01\x01", 3) + little(length) +
                             little(static_cast<std::uint16_t>(~length)) + raw + big(b << 16 | a);
  std::string header = big(width) + big(height);
  header += static_cast<char>(bit_depth);
  header += static_cast<char>(color_type);
  header += std::string(3, '\0');
  return std::string("\x89PNG\r\n\x1a\n") + chunk("IHDR", header) +
         (palette.empty() ? "" : chunk("PLTE", palette)) + chunk("IDAT", stored) + chunk("IEND", "");
}

/// The corners of a box of 100 x 60 x 40 mm, in millimetres, and its faces as quads that look outwards.
inline const std::array<std::array<float, 3>, 8> box_corners{{{-50, -30, -10},
                                                              {50, -30, -10},
                                                              {50, 30, -10},
                                                              {-50, 30, -10},
                                                              {-50, -30, 30},
                                                              {50, -30, 30},
                                                              {50, 30, 30},
                                                              {-50, 30, 30}}};
inline const std::array<std::array<int, 4>, 6> box_quads{
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};

inline std::vector<std::array<int, 3>> box_triangles() {
  std::vector<std::array<int, 3>> out;
  for (const auto& q : box_quads) {
    out.push_back({q[0], q[1], q[2]});
    out.push_back({q[0], q[2], q[3]});
  }
  return out;
}

/// The box in each format; `unit` is 1 for millimetres, 0.001 for metres.
inline std::string ply_ascii_box(float unit) {
  std::string out =
      "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 8\nproperty float x\nproperty float y\n"
      "property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& p : box_corners)
    out += fmt::format("{:.6f} {:.6f} {:.6f}\n", p[0] * unit, p[1] * unit, p[2] * unit);
  for (const auto& q : box_quads) {
    out += "4";
    for (const int i : q) out += fmt::format(" {}", i);
    out += "\n";
  }
  return out;
}

inline std::string ply_binary_box(float unit, bool big_endian = false) {
  std::string out =
      std::string("ply\nformat ") + (big_endian ? "binary_big_endian" : "binary_little_endian") +
      " 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& p : box_corners) {
    for (const float c : p) out += big_endian ? big(c * unit) : little(c * unit);
    out += '\x7f';
  }
  for (const auto& t : box_triangles()) {
    out += '\x03';
    for (const std::int32_t i : t) out += big_endian ? big(i) : little(i);
  }
  return out;
}

inline std::string obj_box(float unit) {
  std::string out = "mtllib there_is_none.mtl\no box\n";
  for (const auto& p : box_corners)
    out += fmt::format("v {:.6f} {:.6f} {:.6f}\n", p[0] * unit, p[1] * unit, p[2] * unit);
  out += "usemtl nothing\n";
  for (const auto& q : box_quads) {
    out += "f";
    for (const int i : q) out += fmt::format(" {}", i + 1);
    out += "\n";
  }
  return out;
}

inline std::string stl_ascii_box(float unit) {
  std::string out = "solid box\n";
  for (const auto& t : box_triangles()) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const int i : t) {
      const auto& p = box_corners[static_cast<std::size_t>(i)];
      out += fmt::format("vertex {:.6f} {:.6f} {:.6f}\n", p[0] * unit, p[1] * unit, p[2] * unit);
    }
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid box\n";
}

inline std::string stl_binary_box(float unit) {
  // A header that begins with "solid", as some programs write, is binary all the same.
  std::string out = "solid but binary";
  out.resize(80, '\0');
  out += little(std::uint32_t{12});
  for (const auto& t : box_triangles()) {
    out += std::string(12, '\0');
    for (const int i : t)
      for (const float c : box_corners[static_cast<std::size_t>(i)]) out += little(c * unit);
    out += std::string(2, '\0');
  }
  return out;
}

/// The box as half a box under a node that doubles it, under a node that moves it 5 units along x.
inline std::string glb_box(float unit) {
  std::string data;
  for (const auto& p : box_corners) {
    data += little((p[0] - 5) * unit / 2);
    data += little(p[1] * unit / 2) + little(p[2] * unit / 2);
  }
  for (const auto& t : box_triangles())
    for (const int i : t) data += little(static_cast<std::uint16_t>(i));
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
      R"("nodes":[{"translation":[)" +
      std::to_string(5 * unit) +
      R"(,0,0],"children":[1]},{"scale":[2,2,2],"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3"},)"
      R"({"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}],)"
      R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":72}],)"
      R"("buffers":[{"byteLength":168}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto size = [](const std::string& s) { return static_cast<std::uint32_t>(s.size()); };
  const std::string chunks =
      little(size(json)) + "JSON" + json + little(size(data)) + std::string("BIN\0", 4) + data;
  return std::string("glTF") + little(std::uint32_t{2}) + little(size(chunks) + 12) + chunks;
}

}  // namespace perch::testing_files
