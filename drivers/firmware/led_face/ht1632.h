// Holtek HT1632C with 24 outputs and 16 commons (data sheet rev. 1.70): 96 addresses of 4 bits.
//
// Address = 4 * output + common / 4, bit = common % 4. Commands and addresses are sent with their
// highest bit first, data with the lowest first; further data go to the next addresses.
#pragma once

#include "face.h"

namespace led_face {

// How a board's lights are joined to the chip.
enum class Ht1632Board : uint8_t {
  kPlain,   // column x on output x, row y on common y
  kBlocks,  // six blocks of 8 x 8 with outputs downwards and commons across (Adafruit 555)
};

// `Bus` has chosen(bool): chip select, and clock(bool): one bit. begin() comes first.
template <class Bus, Ht1632Board Board>
class Ht1632 {
 public:
  static constexpr uint8_t kWidth = 24;
  static constexpr uint8_t kHeight = 16;

  explicit Ht1632(Bus& bus) : bus_(bus) {}

  static const char* name() { return "HT1632C 24x16"; }

  void begin() {
    command(kSystemOff);
    command(kSixteenCommonsNmos);
    command(kMasterRc);
    command(kSystemOn);
    show(Picture<kWidth, kHeight>(), 0);
    command(kBlinkOff);
  }

  void show(const Picture<kWidth, kHeight>& picture, uint8_t brightness) {
    bus_.chosen(true);
    bits(kWrite, 3);
    bits(0, 7);
    for (uint8_t output = 0; output < kWidth; ++output) {
      for (uint8_t common = 0; common < kHeight; ++common) {
        bus_.clock(picture.lit(column(output, common), row(output, common)));
      }
    }
    bus_.chosen(false);
    // 16 steps from 1/16 to 16/16; the darkest is not dark, so 0 switches the lights off.
    if (brightness > 0) command(kDuty | brightness >> 4);
    command(brightness > 0 ? kLightsOn : kLightsOff);
  }

 private:
  enum : uint8_t {
    kCommand = 4,  // 1 0 0
    kWrite = 5,    // 1 0 1
    kSystemOff = 0x00,
    kSystemOn = 0x01,
    kLightsOff = 0x02,
    kLightsOn = 0x03,
    kBlinkOff = 0x08,
    kMasterRc = 0x18,
    kSixteenCommonsNmos = 0x24,
    kDuty = 0xa0,
  };

  static uint8_t column(uint8_t output, uint8_t common) {
    return Board == Ht1632Board::kPlain ? output : output / 8 * 8 + common % 8;
  }

  static uint8_t row(uint8_t output, uint8_t common) {
    return Board == Ht1632Board::kPlain ? common : common / 8 * 8 + output % 8;
  }

  void command(uint8_t code) {
    bus_.chosen(true);
    bits(kCommand, 3);
    bits(code, 8);
    bits(0, 1);  // its value does not matter
    bus_.chosen(false);
  }

  void bits(uint8_t value, uint8_t count) {
    while (count-- > 0) bus_.clock(value >> count & 1);
  }

  Bus& bus_;
};

}  // namespace led_face
