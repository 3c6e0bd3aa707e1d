// What travels on the wire between a computer and a face of lights.
//
// A packet is type, sequence number, payload and CRC-16, stuffed by COBS so that it holds no zero
// byte, and ended by a zero byte. README.md describes the packets. Nothing here needs an Arduino:
// the tests compile this file for the machine they run on.
#pragma once

#include <stdint.h>

namespace led_face {

constexpr uint8_t kVersion = 1;

enum Type : uint8_t {
  kHello = 0x01,  // version
  kFrame = 0x02,  // brightness, rows
  kHere = 0x81,   // version, width, height, name
  kShown = 0x82,  // damaged packets so far
  kWrong = 0x8f,  // why
};

enum Why : uint8_t {
  kUnknownType = 1,
  kWrongSize = 2,
};

// CRC-16/CCITT-FALSE (also called CRC-16/IBM-3740): polynomial 0x1021, begins with 0xFFFF, most
// significant bit first, not inverted; "123456789" gives 0x29B1.
inline uint16_t crc16(const uint8_t* data, uint16_t size) {
  uint16_t crc = 0xffff;
  for (uint16_t i = 0; i < size; ++i) {
    crc ^= static_cast<uint16_t>(data[i]) << 8;
    for (uint8_t bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000) ? static_cast<uint16_t>(crc << 1) ^ 0x1021
                           : static_cast<uint16_t>(crc << 1);
    }
  }
  return crc;
}

// Undoes COBS in place. Returns the size of what was stuffed, or -1 if `data` was not stuffed.
inline int16_t unstuff(uint8_t* data, uint16_t size) {
  uint16_t from = 0;
  uint16_t to = 0;
  while (from < size) {
    const uint8_t code = data[from++];
    if (code == 0 || static_cast<uint16_t>(code - 1) > size - from) return -1;
    for (uint8_t i = 1; i < code; ++i) {
      if (data[from] == 0) return -1;
      data[to++] = data[from++];
    }
    if (code != 0xff && from < size) data[to++] = 0;
  }
  return static_cast<int16_t>(to);
}

// Gathers bytes into packets. `Payload` is the largest payload; what is longer is thrown away.
template <uint16_t Payload>
class Reader {
 public:
  // Takes one byte; true when it completed a sound packet, which stays until the next byte.
  bool take(uint8_t byte) {
    if (byte != 0) {
      if (stuffed_ < kRoom) data_[stuffed_] = byte;
      if (stuffed_ <= kRoom) ++stuffed_;
      return false;
    }
    const uint16_t stuffed = stuffed_;
    stuffed_ = 0;
    if (stuffed == 0) return false;  // zero bytes between packets are silence
    const int16_t size = stuffed > kRoom ? -1 : unstuff(data_, stuffed);
    if (size < kLeast || sum_at(size - 2) != crc16(data_, size - 2)) {
      ++damaged_;
      return false;
    }
    size_ = size - kLeast;
    return true;
  }

  uint8_t type() const { return data_[0]; }
  uint8_t number() const { return data_[1]; }
  const uint8_t* payload() const { return data_ + 2; }
  uint16_t size() const { return size_; }
  // Damaged packets since the start; goes round at 256.
  uint8_t damaged() const { return damaged_; }

 private:
  static constexpr int16_t kLeast = 4;  // type, number, CRC
  static constexpr uint16_t kRoom = Payload + kLeast + (Payload + kLeast) / 254 + 1;

  uint16_t sum_at(uint16_t place) const {
    return static_cast<uint16_t>(data_[place]) << 8 | data_[place + 1];
  }

  uint8_t data_[kRoom];
  uint16_t stuffed_ = 0;
  uint16_t size_ = 0;
  uint8_t damaged_ = 0;
};

// Writes one packet to `out`, which has `put(uint8_t)`; payload up to 250 bytes.
template <class Out>
void write_packet(Out& out, uint8_t type, uint8_t number, const uint8_t* payload, uint8_t size) {
  uint8_t packet[254];
  packet[0] = type;
  packet[1] = number;
  for (uint8_t i = 0; i < size; ++i) packet[2 + i] = payload[i];
  uint8_t whole = size + 2;
  const uint16_t crc = crc16(packet, whole);
  packet[whole++] = crc >> 8;
  packet[whole++] = crc & 0xff;
  // At most 254 bytes: every stretch without a zero fits the one byte that says its length.
  uint8_t begin = 0;
  while (true) {
    uint8_t end = begin;
    while (end < whole && packet[end] != 0) ++end;
    out.put(end - begin + 1);
    for (uint8_t i = begin; i < end; ++i) out.put(packet[i]);
    if (end == whole) break;
    begin = end + 1;
  }
  out.put(0);
}

}  // namespace led_face
