#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace perch {

using Bytes = std::vector<std::byte>;

/// Writes numbers one after the other, for a ByteReader in another process of the same program on a machine
/// of the same kind: values go as they lie in memory.
class ByteWriter {
 public:
  void raw(const void* data, std::size_t size) {
    if (size == 0) return;
    const std::size_t before = bytes_.size();
    bytes_.resize(before + size);
    std::memcpy(bytes_.data() + before, data, size);
  }
  template <typename T>
  void value(const T& x) {
    static_assert(std::is_trivially_copyable_v<T>);
    raw(&x, sizeof x);
  }
  /// A number that is mostly small: seven bits a byte.
  void count(std::uint64_t n) {
    for (; n >= 0x80; n >>= 7) bytes_.push_back(static_cast<std::byte>(n | 0x80));
    bytes_.push_back(static_cast<std::byte>(n));
  }
  void text(const std::string& s) {
    count(s.size());
    raw(s.data(), s.size());
  }
  /// A length and as many bytes: ByteReader::part.
  void part(std::span<const std::byte> bytes) {
    count(bytes.size());
    raw(bytes.data(), bytes.size());
  }
  template <typename T>
  void values(const std::vector<T>& all) {
    static_assert(std::is_trivially_copyable_v<T>);
    count(all.size());
    raw(all.data(), all.size() * sizeof(T));
  }

  std::size_t size() const { return bytes_.size(); }
  const Bytes& bytes() const { return bytes_; }
  Bytes take() { return std::move(bytes_); }
  void clear() { bytes_.clear(); }

 private:
  Bytes bytes_;
};

/// Reads what a ByteWriter wrote, in the same order. Throws std::runtime_error where there is less than is
/// asked for. Refers to the bytes.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool done() const { return bytes_.empty(); }
  std::span<const std::byte> raw(std::size_t size) {
    if (size > bytes_.size()) throw std::runtime_error("a message between processes ends early");
    const auto front = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return front;
  }
  template <typename T>
  T value() {
    static_assert(std::is_trivially_copyable_v<T>);
    T x;
    read(x);
    return x;
  }
  template <typename T>
  void read(T& x) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::memcpy(static_cast<void*>(&x), raw(sizeof(T)).data(), sizeof(T));
  }
  std::uint64_t count() {
    std::uint64_t n = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const auto byte = std::to_integer<std::uint64_t>(raw(1).front());
      n |= (byte & 0x7f) << shift;
      if (byte < 0x80) return n;
    }
    throw std::runtime_error("a message between processes holds a number of more than 64 bits");
  }
  std::string text() {
    const auto bytes = raw(count());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  ByteReader part() { return ByteReader(raw(count())); }
  template <typename T>
  std::vector<T> values() {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::uint64_t n = count();
    if (n > bytes_.size() / sizeof(T)) throw std::runtime_error("a message between processes ends early");
    std::vector<T> all(n);
    const auto bytes = raw(n * sizeof(T));
    if (n > 0) std::memcpy(static_cast<void*>(all.data()), bytes.data(), bytes.size());
    return all;
  }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace perch
