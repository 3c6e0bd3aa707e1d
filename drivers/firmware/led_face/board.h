// How this face is built. Change it to fit yours; nothing else has to be changed.
#pragma once

#include "ht1632.h"
#include "max7219.h"

// One of the two:
#define FACE_HT1632 1
#define FACE_MAX7219 0

// Bits a second; a board with a USB port of its own (Micro, Leonardo) ignores it.
constexpr unsigned long kBaud = 115200;

// Pins: chip select (CS, LOAD), clock (WR, CLK), data (DATA, DIN).
constexpr uint8_t kSelectPin = 4;
constexpr uint8_t kClockPin = 3;
constexpr uint8_t kDataPin = 2;

// HT1632: how the lights are joined to the chip.
constexpr led_face::Ht1632Board kHt1632Board = led_face::Ht1632Board::kBlocks;

// MAX7219: blocks across and down, and how they are joined.
constexpr uint8_t kBlocksAcross = 3;
constexpr uint8_t kBlocksDown = 2;
constexpr led_face::Max7219Board kMax7219Board = led_face::kFc16;
