#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace perch {

enum class PlyScalar { i8, u8, i16, u16, i32, u32, f32, f64 };

struct PlyProperty {
  std::string name;
  PlyScalar type = PlyScalar::f32;
  std::optional<PlyScalar> count_type;  ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyEncoding { ascii, little, big };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<std::string> notes;  ///< what stands behind each `obj_info`
  std::vector<PlyElement> elements;

  /// Of the elements of that name together.
  std::uint64_t count(std::string_view element) const;
};

/// The x, y and z of a vertex.
Eigen::Vector3d ply_point(const PlyElement& vertex, std::span<const double> values);

/// What is made of a PLY file, one element after another in the file's order. Each call may throw
/// FormatFault.
class PlyVisitor {
 public:
  virtual ~PlyVisitor() = default;
  virtual void header(const PlyHeader&) {}
  /// A list of an element, before its instance(). \param number of the element among those of its kind.
  virtual void list(const PlyElement&, const PlyProperty&, std::uint64_t number,
                    std::span<const double> values) = 0;
  /// \param values one a property; that of a list is its length.
  virtual void instance(const PlyElement&, std::uint64_t number, std::span<const double> values) = 0;
};

/// Reads a PLY file, ASCII or binary. Throws FormatFault: a header that promises more than the file holds, or
/// whose vertices have no x, y or z.
void read_ply_elements(std::string_view bytes, PlyVisitor& visitor);

}  // namespace perch
