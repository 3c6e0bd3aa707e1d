// A face on a wire: takes bytes, shows frames, answers. No Arduino needed.
#pragma once

#include "protocol.h"

namespace led_face {

// Bits of a picture: rows from the top in whole bytes, the leftmost light first.
template <uint8_t Width, uint8_t Height>
struct Picture {
  static constexpr uint8_t kRowBytes = (Width + 7) / 8;
  static constexpr uint16_t kBytes = static_cast<uint16_t>(kRowBytes) * Height;

  uint8_t bytes[kBytes] = {};

  bool lit(uint8_t column, uint8_t row) const {
    return bytes[static_cast<uint16_t>(row) * kRowBytes + column / 8] >> (7 - column % 8) & 1;
  }
};

// `Display` has kWidth, kHeight, name(), show(picture, brightness 0..255); `Out` has put(byte).
template <class Display, class Out>
class Face {
 public:
  using Shown = Picture<Display::kWidth, Display::kHeight>;

  Face(Display& display, Out& out) : display_(display), out_(out) {}

  // Says who it is; also at the start, so that a computer notices a face that was reset.
  void introduce(uint8_t number) {
    uint8_t answer[3 + kNameRoom] = {kVersion, Display::kWidth, Display::kHeight};
    uint8_t size = 3;
    for (const char* letter = display_.name(); *letter && size < sizeof answer; ++letter) {
      answer[size++] = static_cast<uint8_t>(*letter);
    }
    write_packet(out_, kHere, number, answer, size);
  }

  void take(uint8_t byte) {
    if (!reader_.take(byte)) return;
    switch (reader_.type()) {
      case kHello:
        return introduce(reader_.number());
      case kFrame:
        return frame();
      default:
        return wrong(kUnknownType);
    }
  }

 private:
  static constexpr uint8_t kNameRoom = 32;

  void frame() {
    if (reader_.size() != 1 + Shown::kBytes) return wrong(kWrongSize);
    Shown picture;
    for (uint16_t i = 0; i < Shown::kBytes; ++i) picture.bytes[i] = reader_.payload()[1 + i];
    display_.show(picture, reader_.payload()[0]);
    const uint8_t damaged = reader_.damaged();
    write_packet(out_, kShown, reader_.number(), &damaged, 1);
  }

  void wrong(uint8_t why) { write_packet(out_, kWrong, reader_.number(), &why, 1); }

  Display& display_;
  Out& out_;
  Reader<1 + Shown::kBytes> reader_;
};

}  // namespace led_face
