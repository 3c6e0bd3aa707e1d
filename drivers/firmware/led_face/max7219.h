// Chains of Maxim MAX7219 with a block of 8 x 8 lights each (data sheet 19-4452).
//
// A chip has 16 registers of 8 bits, written by words of 16: four idle bits, address, data. Words
// shift through the chain, so the first word sent ends in the last chip. Digit registers 1 to 8
// are a block's rows from the top; the data's highest bit (segment DP) is its leftmost light.
#pragma once

#include "face.h"

namespace led_face {

// How the blocks are joined.
struct Max7219Board {
  // The chain begins at the upper right instead of the upper left.
  bool from_right;
  // A row of blocks begins where the one above ended, instead of below its beginning.
  bool winding;
  // A block's lowest data bit is its leftmost light.
  bool mirrored;
};

// The usual modules of four, with their input on the right.
constexpr Max7219Board kFc16 = {true, false, false};

// `Across` and `Down` count blocks. `Bus` has chosen(bool): load, and clock(bool): one bit.
template <class Bus, uint8_t Across, uint8_t Down>
class Max7219 {
 public:
  static constexpr uint8_t kWidth = 8 * Across;
  static constexpr uint8_t kHeight = 8 * Down;

  Max7219(Bus& bus, Max7219Board board) : bus_(bus), board_(board) {}

  static const char* name() { return "MAX7219"; }

  void begin() {
    all(kTest, 0);
    all(kDecode, 0);  // plain lights, no digits
    all(kLimit, 7);   // all eight rows
    show(Picture<kWidth, kHeight>(), 0);
  }

  void show(const Picture<kWidth, kHeight>& picture, uint8_t brightness) {
    for (uint8_t row = 0; row < 8; ++row) {
      bus_.chosen(true);
      for (uint8_t chip = kChips; chip-- > 0;) word(kDigit0 + row, data(picture, chip, row));
      bus_.chosen(false);
    }
    // 16 steps from 1/32 to 31/32; the darkest is not dark, so 0 switches the lights off.
    all(kIntensity, brightness >> 4);
    all(kShutdown, brightness > 0 ? 1 : 0);
  }

 private:
  static constexpr uint8_t kChips = Across * Down;
  enum : uint8_t {
    kDigit0 = 0x1,
    kDecode = 0x9,
    kIntensity = 0xa,
    kLimit = 0xb,
    kShutdown = 0xc,
    kTest = 0xf,
  };

  // The lights of one row of a block; `chip` counts from the chain's beginning.
  uint8_t data(const Picture<kWidth, kHeight>& picture, uint8_t chip, uint8_t row) const {
    const uint8_t block_row = chip / Across;
    uint8_t block = chip % Across;
    const bool turned = board_.winding && block_row % 2 == 1;
    if (board_.from_right != turned) block = Across - 1 - block;
    uint8_t lights = 0;
    for (uint8_t i = 0; i < 8; ++i) {
      const bool lit = picture.lit(8 * block + i, 8 * block_row + row);
      lights |= static_cast<uint8_t>(lit) << (board_.mirrored ? i : 7 - i);
    }
    return lights;
  }

  void all(uint8_t address, uint8_t data) {
    bus_.chosen(true);
    for (uint8_t chip = 0; chip < kChips; ++chip) word(address, data);
    bus_.chosen(false);
  }

  void word(uint8_t address, uint8_t data) {
    const uint16_t value = static_cast<uint16_t>(address) << 8 | data;
    for (uint8_t bit = 16; bit-- > 0;) bus_.clock(value >> bit & 1);
  }

  Bus& bus_;
  Max7219Board board_;
};

}  // namespace led_face
