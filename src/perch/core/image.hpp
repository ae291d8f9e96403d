#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace perch {

/// A dense row-major image; pixel (u, v) is column u, row v, with its centre at integer coordinates.
template <typename T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, T fill = T{})
      : width_(width),
        height_(height),
        data_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}

  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t size() const { return data_.size(); }
  bool empty() const { return data_.empty(); }
  bool contains(int u, int v) const { return u >= 0 && v >= 0 && u < width_ && v < height_; }

  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u);
  }
  T& operator()(int u, int v) { return data_[index(u, v)]; }
  const T& operator()(int u, int v) const { return data_[index(u, v)]; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  T* row(int v) { return data_.data() + index(0, v); }
  const T* row(int v) const { return data_.data() + index(0, v); }
  const std::vector<T>& data() const { return data_; }

  friend bool operator==(const Image&, const Image&) = default;

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<T> data_;
};

/// Depth along the optical axis in metres, one value a pixel; 0 = no reading.
using DepthImage = Image<float>;

/// A rectangle of pixels, half open: columns [u0, u1), rows [v0, v1).
struct Window {
  int u0 = 0, v0 = 0, u1 = 0, v1 = 0;

  bool empty() const { return u0 >= u1 || v0 >= v1; }
  int width() const { return u1 - u0; }
  int height() const { return v1 - v0; }
  bool contains(int u, int v) const { return u >= u0 && u < u1 && v >= v0 && v < v1; }

  friend bool operator==(const Window&, const Window&) = default;
};

inline Window intersection(const Window& a, const Window& b) {
  return {std::max(a.u0, b.u0), std::max(a.v0, b.v0), std::min(a.u1, b.u1), std::min(a.v1, b.v1)};
}

/// The smallest window that holds both; an empty one adds nothing.
inline Window bounding(const Window& a, const Window& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.u0, b.u0), std::min(a.v0, b.v0), std::max(a.u1, b.u1), std::max(a.v1, b.v1)};
}

}  // namespace perch
