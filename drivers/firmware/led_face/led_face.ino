// A face of lights for woz-tui: shows the frames that come over the serial port. See README.md.

#include "board.h"
#include "face.h"

namespace {

// Clocks bits out by hand: any pins will do, and both chips read data when the clock rises.
struct PinBus {
  void begin() {
    digitalWrite(kSelectPin, HIGH);
    digitalWrite(kClockPin, LOW);
    pinMode(kSelectPin, OUTPUT);
    pinMode(kClockPin, OUTPUT);
    pinMode(kDataPin, OUTPUT);
  }

  void chosen(bool on) { digitalWrite(kSelectPin, on ? LOW : HIGH); }

  void clock(bool bit) {
    digitalWrite(kClockPin, LOW);
    digitalWrite(kDataPin, bit ? HIGH : LOW);
    digitalWrite(kClockPin, HIGH);
  }
};

struct SerialOut {
  void put(uint8_t byte) { Serial.write(byte); }
};

PinBus bus;
SerialOut out;

#if FACE_HT1632
led_face::Ht1632<PinBus, kHt1632Board> display(bus);
#elif FACE_MAX7219
led_face::Max7219<PinBus, kBlocksAcross, kBlocksDown> display(bus, kMax7219Board);
#else
#error "board.h chooses no chip"
#endif

led_face::Face<decltype(display), SerialOut> face(display, out);

}  // namespace

void setup() {
  bus.begin();
  display.begin();
  Serial.begin(kBaud);
  face.introduce(0);
}

void loop() {
  while (Serial.available() > 0) face.take(static_cast<uint8_t>(Serial.read()));
}
