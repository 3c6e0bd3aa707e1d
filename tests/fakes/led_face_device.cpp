// The firmware of the face of lights with a memory in the place of its lights, for tests.

#include <stdint.h>
#include <string.h>

#include <vector>

#include "face.h"
#include "ht1632.h"
#include "max7219.h"

namespace {

struct Answers {
  std::vector<uint8_t> bytes;
  void put(uint8_t byte) { bytes.push_back(byte); }
};

struct Device {
  virtual ~Device() {}
  virtual void take(uint8_t byte) = 0;
  virtual void introduce() = 0;

  Answers answers;
  std::vector<uint8_t> picture;
  uint8_t brightness = 0;
  int frames = 0;
};

template <uint8_t Width, uint8_t Height>
struct Memory {
  static constexpr uint8_t kWidth = Width;
  static constexpr uint8_t kHeight = Height;
  static const char* name() { return "memory"; }

  void show(const led_face::Picture<Width, Height>& picture, uint8_t brightness) {
    device.picture.assign(picture.bytes, picture.bytes + sizeof picture.bytes);
    device.brightness = brightness;
    ++device.frames;
  }

  Device& device;
};

template <uint8_t Width, uint8_t Height>
struct Sized : Device {
  Memory<Width, Height> memory{*this};
  led_face::Face<Memory<Width, Height>, Answers> face{memory, answers};
  void take(uint8_t byte) override { face.take(byte); }
  void introduce() override { face.introduce(0); }
};

// What happens on a chip's pins.
struct Tape {
  enum : uint8_t { kChosen = 2, kReleased = 3 };
  std::vector<uint8_t> events;
  void chosen(bool on) { events.push_back(on ? kChosen : kReleased); }
  void clock(bool bit) { events.push_back(bit); }

  int copy(uint8_t* out, int room) const {
    const int size = static_cast<int>(events.size());
    if (size <= room) memcpy(out, events.data(), events.size());
    return size;
  }
};

template <class Chip>
void play(Chip chip, const uint8_t* bytes, uint8_t brightness) {
  led_face::Picture<Chip::kWidth, Chip::kHeight> picture;
  memcpy(picture.bytes, bytes, sizeof picture.bytes);
  chip.begin();
  chip.show(picture, brightness);
}

}  // namespace

extern "C" {

uint16_t device_crc16(const uint8_t* data, uint16_t size) { return led_face::crc16(data, size); }

int device_unstuff(uint8_t* data, uint16_t size) { return led_face::unstuff(data, size); }

void* device_new(int width, int height) {
  if (width == 24 && height == 16) return static_cast<Device*>(new Sized<24, 16>);
  if (width == 16 && height == 24) return static_cast<Device*>(new Sized<16, 24>);
  if (width == 10 && height == 9) return static_cast<Device*>(new Sized<10, 9>);
  return nullptr;
}

void device_free(void* device) { delete static_cast<Device*>(device); }

void device_introduce(void* device) { static_cast<Device*>(device)->introduce(); }

void device_take(void* device, const uint8_t* data, int size) {
  for (int i = 0; i < size; ++i) static_cast<Device*>(device)->take(data[i]);
}

int device_answers(void* device, uint8_t* out, int room) {
  std::vector<uint8_t>& bytes = static_cast<Device*>(device)->answers.bytes;
  const int size = static_cast<int>(bytes.size());
  if (size > room) return -1;
  if (size > 0) memcpy(out, bytes.data(), bytes.size());
  bytes.clear();
  return size;
}

int device_picture(void* device, uint8_t* out, int room) {
  const Device* it = static_cast<Device*>(device);
  const int size = static_cast<int>(it->picture.size());
  if (size > room) return -1;
  if (size > 0) memcpy(out, it->picture.data(), it->picture.size());
  return size;
}

int device_brightness(void* device) { return static_cast<Device*>(device)->brightness; }

int device_frames(void* device) { return static_cast<Device*>(device)->frames; }

int ht1632_tape(bool blocks, const uint8_t* bytes, uint8_t brightness, uint8_t* out, int room) {
  using led_face::Ht1632;
  using led_face::Ht1632Board;
  Tape tape;
  if (blocks) {
    play(Ht1632<Tape, Ht1632Board::kBlocks>(tape), bytes, brightness);
  } else {
    play(Ht1632<Tape, Ht1632Board::kPlain>(tape), bytes, brightness);
  }
  return tape.copy(out, room);
}

int max7219_tape(bool from_right, bool winding, bool mirrored, const uint8_t* bytes,
                 uint8_t brightness, uint8_t* out, int room) {
  Tape tape;
  const led_face::Max7219Board board = {from_right, winding, mirrored};
  play(led_face::Max7219<Tape, 3, 2>(tape, board), bytes, brightness);
  return tape.copy(out, room);
}

}  // extern "C"
