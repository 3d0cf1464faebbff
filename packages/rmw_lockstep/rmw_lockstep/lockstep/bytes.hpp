// Frames: a length, a kind and fields, little-endian.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace lockstep {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "frames are written as they lie in memory");

class Writer {
public:
  Writer(std::vector<uint8_t> & out, char kind) : out_(out), start_(out.size()) { put<uint32_t>(0); put<char>(kind); }
  // The length is only known at the end.
  ~Writer() {
    const auto size = static_cast<uint32_t>(out_.size() - start_ - sizeof(uint32_t));
    memcpy(&out_[start_], &size, sizeof size);
  }
  Writer(const Writer &) = delete;
  Writer & operator=(const Writer &) = delete;

  template<typename T> Writer & put(T value) { return raw(&value, sizeof value); }
  Writer & text(const std::string & value) { put<uint32_t>(value.size()); return raw(value.data(), value.size()); }
  Writer & raw(const void * data, size_t size) {
    auto bytes = static_cast<const uint8_t *>(data);
    out_.insert(out_.end(), bytes, bytes + size);
    return *this;
  }

private:
  std::vector<uint8_t> & out_;
  size_t start_;
};

// Reads what follows the kind of a frame. If a frame is too short, `ok` becomes false and everything else is 0.
class Reader {
public:
  Reader(const uint8_t * data, size_t size) : at_(data), end_(data + size) {}

  template<typename T> T get() {
    T value{};
    raw(&value, sizeof value);
    return value;
  }
  std::string text() {
    const auto size = get<uint32_t>();
    if (!has(size)) return {};
    std::string value(reinterpret_cast<const char *>(at_), size);
    at_ += size;
    return value;
  }
  void raw(void * to, size_t size) {
    if (!has(size)) return;
    memcpy(to, at_, size);
    at_ += size;
  }
  const uint8_t * rest() const { return at_; }
  size_t left() const { return end_ - at_; }
  bool ok() const { return ok_; }

private:
  bool has(size_t size) { return ok_ = ok_ && left() >= size; }
  const uint8_t * at_, * end_;
  bool ok_ = true;
};

}  // namespace lockstep
